/* The quatrack controller's object, quatrack-crazyflie.o: what it exports beside the out-of-tree controller itself. */
#ifndef QUATRACK_H
#define QUATRACK_H

#include <stdbool.h>
#include <stdint.h>

/* What the firmware was built for, platform_defaults.h. */
typedef struct {
  float massKg;          /* CF_MASS */
  float armM;            /* ARM_LENGTH */
  float thrustMaxN;      /* THRUST_MAX of one motor */
  float torquePerThrustM; /* THRUST2TORQUE */
} quatrackPlatform_t;

/* A packet of the app channel. */
typedef struct {
  uint8_t length;
  uint8_t bytes[30];
} quatrackPacket_t;

/* Set by the owner; a value out of range counts as the nearest one in it. */
typedef struct {
  float positionScale;    /* factor on the feedback of thrust, roll and pitch, within scaleMin..scaleMax */
  float yawScale;         /* factor on the feedback about the vertical, likewise */
  float leashM;           /* farthest error that is acted on, 0.1..10: metres, and metres a second */
  float speedMS;          /* largest speed of a velocity setpoint, 0.1..5 */
  float accelerationMS2;  /* its largest acceleration, 0.5..10 */
  float rollPitchRateRadS; /* largest roll and pitch rate that the body-rate loop is asked for, 0.5..100 */
  float yawRateRadS;      /* largest yaw rate, likewise */
  float motorLagS;        /* time constant of this craft's motors as you know it; 0: only what is published is known */
  uint8_t table;          /* 0 actuator-aware, 1 LYAP-E, 2 LQR-E, 3 LYAP-F, 4 LQR-F, 5 the one sent last */
  uint8_t feedForward;    /* whether the paper's laws are fed forward */
} quatrackParameters_t;

typedef struct {
  int16_t errorMm[3];       /* position, measured less asked, world frame */
  int16_t rotationMrad[3];  /* rotation from the reference to the craft, body frame */
  uint16_t forces[4];       /* commanded, thousandths of a motor's largest; 0 under a law of thrust and torque */
  uint16_t limited;         /* bits 0-3 motors, 4-6 thrust, attitude, yaw, 8-11 thrust and body rates of the command */
  uint16_t cycles;          /* processor cycles of the last control step */
  uint8_t mode;             /* 0 off, 1 flying, 2 descending, 3 blind, 4 no craft */
  uint8_t table;            /* in use */
  uint16_t badStates;       /* steps on estimates that nothing can be flown on: motors off */
  uint16_t badSetpoints;    /* setpoints that make no sense: level and slowly down */
  uint16_t limitedSteps;    /* steps that gave something up */
  uint16_t jumps;           /* setpoints that were not where the ones before led */
  uint16_t refusedTables;   /* tables asked for or sent that are not flown */
  uint16_t refusal;         /* why: 1 no such table, 2 none sent, 3 motor lag, 4 unsound, 5 vehicle or rate, 6 law */
} quatrackLog_t;

/* Read-only. */
typedef struct {
  float scaleMin;   /* what the certificate of the table in use allows */
  float scaleMax;
  float gains[19];  /* thrust from z, vz, force, integral; roll from y, vy, rotation, rate, force, integral; pitch from x
                       likewise; yaw from rotation, rate, force. 0 where the law has none */
} quatrackGains_t;

typedef struct {
  quatrackParameters_t parameters;
  quatrackLog_t log;
  quatrackGains_t gains;
} quatrack_t;

extern quatrack_t quatrack;

/* Says which craft this is and starts anew, motors off. False where there is no table for it. */
bool quatrackPlatform(const quatrackPlatform_t *platform);
/* Looks at the parameters; to be called a few times a second from the task that calls the others. */
void quatrackService(void);
/* Takes a packet of the app channel; the answer is to be sent back. */
void quatrackPacket(const quatrackPacket_t *packet, quatrackPacket_t *answer);

#endif
