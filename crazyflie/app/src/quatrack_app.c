/* The app around the quatrack controller: tells it which craft the firmware was built for, passes it tables that come over
 * the app channel, and declares its parameters and log variables. */
#include <string.h>

#include "FreeRTOS.h"
#include "task.h"

#include "app.h"
#include "app_channel.h"
#include "log.h"
#include "param.h"
#include "platform_defaults.h"
#include "stm32f4xx.h"

#define DEBUG_MODULE "QUATRACK"
#include "debug.h"

#include "quatrack.h"
#ifdef QUATRACK_CRAFT
/* Made by `make QUATRACK_CRAFT=FILE.toml`: the constant ownCraft. */
#include "quatrack_craft.h"
#endif

#define PERIOD_MS 20

_Static_assert(sizeof(quatrackParameters_t) == 64, "as in shared.rs");
_Static_assert(sizeof(quatrackLog_t) == 42, "as in shared.rs");
_Static_assert(sizeof(quatrack_t) == 224, "as in shared.rs");
_Static_assert(sizeof(quatrackCraft_t) == 388, "as in own_craft.rs");
_Static_assert(APPCHANNEL_MTU == sizeof(((quatrackPacket_t *)0)->bytes), "as in upload.rs");

/* As in quatrackParameters_t. */
static const char *const floats[] = {
  "posScale", "yawScale", "leash", "speedMax", "accMax", "rpRateMax", "yawRateMax", "motorLag",
  "drag", "momentX", "momentY", "gust", "speed", "climb", "tilt",
};

/* Tells the controller which craft this is; nothing, or why it does not fly. */
static const char *startCraft(const quatrackPlatform_t *platform)
{
#ifdef QUATRACK_CRAFT
  return quatrackCraft(platform, &ownCraft);
#else
  return quatrackPlatform(platform) ? NULL : "there is no table for the figures that the firmware was built with";
#endif
}

/* Why a table is not flown, by quatrackN.refusal. */
static const char *const refusals[] = {
  "",
  "there is no table of that number",
  "none has been sent",
  "the motors' lag is outside its certificate",
  "no sound table with a certificate",
  "it is for another craft or control rate",
  "its law is not flown here",
};

/* Says why a table is not flown. */
static void sayRefusal(void)
{
  static uint16_t said;
  const uint16_t refused = quatrack.log.refusedTables;
  const unsigned why = quatrack.log.refusal;
  if (refused != said && why < sizeof(refusals) / sizeof(refusals[0])) {
    DEBUG_PRINT("A table is not flown: %s\n", refusals[why]);
  }
  said = refused;
}

/* Says which parameter was NaN. */
static void sayPutBack(void)
{
  static uint16_t said;
  const uint16_t putBack = quatrack.log.putBack;
  const unsigned index = quatrack.log.parameter - 1u;
  if (putBack != said && index < sizeof(floats) / sizeof(floats[0])) {
    DEBUG_PRINT("quatrack.%s was NaN: back to its default\n", floats[index]);
  }
  said = putBack;
}

void appMain(void)
{
  const quatrackPlatform_t platform = {
    .massKg = CF_MASS,
    .armM = ARM_LENGTH,
    .thrustMaxN = THRUST_MAX,
    .torquePerThrustM = THRUST2TORQUE,
  };

  /* The cycle counter, for the time that a step takes. */
  CoreDebug->DEMCR |= CoreDebug_DEMCR_TRCENA_Msk;
  DWT->CTRL |= DWT_CTRL_CYCCNTENA_Msk;

  const char *const whyNot = startCraft(&platform);
  if (whyNot) {
    DEBUG_PRINT("The motors stay off: %s\n", whyNot);
  }
  while (1) {
    quatrackPacket_t packet, answer;
    quatrackService();
    sayPutBack();
    sayRefusal();
    packet.length = (uint8_t)appchannelReceiveDataPacket(packet.bytes, sizeof(packet.bytes), PERIOD_MS);
    if (packet.length > 0) {
      memset(&answer, 0, sizeof(answer));
      quatrackPacket(&packet, &answer);
      appchannelSendDataPacket(answer.bytes, answer.length);
    }
  }
}

/* Parameters that belong to a craft can be stored on it. */
#define OWN_FLOAT (PARAM_FLOAT | PARAM_PERSISTENT)
#define OWN_UINT8 (PARAM_UINT8 | PARAM_PERSISTENT)

PARAM_GROUP_START(quatrack)
PARAM_ADD(OWN_UINT8, table, &quatrack.parameters.table)
PARAM_ADD(OWN_FLOAT, posScale, &quatrack.parameters.positionScale)
PARAM_ADD(OWN_FLOAT, yawScale, &quatrack.parameters.yawScale)
PARAM_ADD(OWN_FLOAT, motorLag, &quatrack.parameters.motorLagS)
PARAM_ADD(OWN_FLOAT, drag, &quatrack.parameters.dragPerS)
PARAM_ADD(OWN_FLOAT, momentX, &quatrack.parameters.momentXNS)
PARAM_ADD(OWN_FLOAT, momentY, &quatrack.parameters.momentYNS)
PARAM_ADD(OWN_FLOAT, gust, &quatrack.parameters.gust)
PARAM_ADD(OWN_UINT8, learn, &quatrack.parameters.learn)
PARAM_ADD(OWN_FLOAT, speed, &quatrack.parameters.goalSpeedMS)
PARAM_ADD(OWN_FLOAT, climb, &quatrack.parameters.goalClimbMS)
PARAM_ADD(OWN_FLOAT, tilt, &quatrack.parameters.tiltDeg)
PARAM_ADD(PARAM_UINT8, feedForward, &quatrack.parameters.feedForward)
PARAM_ADD(OWN_FLOAT, leash, &quatrack.parameters.leashM)
PARAM_ADD(OWN_FLOAT, speedMax, &quatrack.parameters.speedMS)
PARAM_ADD(OWN_FLOAT, accMax, &quatrack.parameters.accelerationMS2)
PARAM_ADD(PARAM_FLOAT, rpRateMax, &quatrack.parameters.rollPitchRateRadS)
PARAM_ADD(PARAM_FLOAT, yawRateMax, &quatrack.parameters.yawRateRadS)
PARAM_ADD(PARAM_FLOAT | PARAM_RONLY, scaleMin, &quatrack.gains.scaleMin)
PARAM_ADD(PARAM_FLOAT | PARAM_RONLY, scaleMax, &quatrack.gains.scaleMax)
PARAM_GROUP_STOP(quatrack)

#define GAIN(NAME, INDEX) PARAM_ADD(PARAM_FLOAT | PARAM_RONLY, NAME, &quatrack.gains.gains[INDEX])

PARAM_GROUP_START(quatrackK)
GAIN(thrustZ, 0)
GAIN(thrustVz, 1)
GAIN(thrustF, 2)
GAIN(thrustIz, 3)
GAIN(rollY, 4)
GAIN(rollVy, 5)
GAIN(rollRot, 6)
GAIN(rollRate, 7)
GAIN(rollF, 8)
GAIN(rollIy, 9)
GAIN(pitchX, 10)
GAIN(pitchVx, 11)
GAIN(pitchRot, 12)
GAIN(pitchRate, 13)
GAIN(pitchF, 14)
GAIN(pitchIx, 15)
GAIN(yawRot, 16)
GAIN(yawRate, 17)
GAIN(yawF, 18)
PARAM_GROUP_STOP(quatrackK)

/* One packet of 26 bytes. */
LOG_GROUP_START(quatrack)
LOG_ADD(LOG_INT16, errX, &quatrack.log.errorMm[0])
LOG_ADD(LOG_INT16, errY, &quatrack.log.errorMm[1])
LOG_ADD(LOG_INT16, errZ, &quatrack.log.errorMm[2])
LOG_ADD(LOG_INT16, rotX, &quatrack.log.rotationMrad[0])
LOG_ADD(LOG_INT16, rotY, &quatrack.log.rotationMrad[1])
LOG_ADD(LOG_INT16, rotZ, &quatrack.log.rotationMrad[2])
LOG_ADD(LOG_UINT16, f1, &quatrack.log.forces[0])
LOG_ADD(LOG_UINT16, f2, &quatrack.log.forces[1])
LOG_ADD(LOG_UINT16, f3, &quatrack.log.forces[2])
LOG_ADD(LOG_UINT16, f4, &quatrack.log.forces[3])
LOG_ADD(LOG_UINT16, limited, &quatrack.log.limited)
LOG_ADD(LOG_UINT16, cycles, &quatrack.log.cycles)
LOG_ADD(LOG_UINT8, mode, &quatrack.log.mode)
LOG_ADD(LOG_UINT8, table, &quatrack.log.table)
LOG_GROUP_STOP(quatrack)

LOG_GROUP_START(quatrackN)
LOG_ADD(LOG_UINT16, badStates, &quatrack.log.badStates)
LOG_ADD(LOG_UINT16, badSetpoints, &quatrack.log.badSetpoints)
LOG_ADD(LOG_UINT16, limitedSteps, &quatrack.log.limitedSteps)
LOG_ADD(LOG_UINT16, jumps, &quatrack.log.jumps)
LOG_ADD(LOG_UINT16, refused, &quatrack.log.refusedTables)
LOG_ADD(LOG_UINT16, refusal, &quatrack.log.refusal)
LOG_ADD(LOG_UINT16, putBack, &quatrack.log.putBack)
LOG_ADD(LOG_UINT16, parameter, &quatrack.log.parameter)
LOG_ADD(LOG_UINT16, reason, &quatrack.log.reason)
LOG_GROUP_STOP(quatrackN)

/* The figures learned in flight: of the air, the motors and the disturbance. */
LOG_GROUP_START(quatrackA)
LOG_ADD(LOG_FLOAT, drag, &quatrack.learned.dragPerS)
LOG_ADD(LOG_FLOAT, momentX, &quatrack.learned.momentNS[0])
LOG_ADD(LOG_FLOAT, momentY, &quatrack.learned.momentNS[1])
LOG_ADD(LOG_FLOAT, motors, &quatrack.learned.motorShare)
LOG_ADD(LOG_FLOAT, pushX, &quatrack.learned.disturbanceMS2[0])
LOG_ADD(LOG_FLOAT, pushY, &quatrack.learned.disturbanceMS2[1])
LOG_ADD(LOG_FLOAT, pushT, &quatrack.learned.disturbanceMS2[2])
LOG_ADD(LOG_FLOAT, stands, &quatrack.learned.stands)
LOG_GROUP_STOP(quatrackA)
