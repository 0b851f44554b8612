/* The quatrack controller's object, quatrack-crazyflie.o: its exports beside the out-of-tree controller itself. */
#ifndef QUATRACK_H
#define QUATRACK_H

#include <stdbool.h>
#include <stdint.h>

/* The craft that the firmware was built for, platform_defaults.h. */
typedef struct {
  float massKg;          /* CF_MASS */
  float armM;            /* ARM_LENGTH */
  float thrustMaxN;      /* THRUST_MAX of one motor */
  float torquePerThrustM; /* THRUST2TORQUE */
} quatrackPlatform_t;

/* A craft of your own with its table, as `quatrack gains craft` writes it into quatrack_craft.h. The table is for these figures alone. */
typedef struct {
  float massKg;
  float inertiaKgM2[6];   /* xx, xy, xz, yy, yz, zz */
  float armM;             /* centre to rotor */
  float forceN[2];        /* least and most of one motor */
  float torquePerThrustM;
  float motorLagS;
  float bodyRatesRadS[3]; /* largest */
  uint8_t table[326];
} quatrackCraft_t;

/* A packet of the app channel. */
typedef struct {
  uint8_t length;
  uint8_t bytes[30];
} quatrackPacket_t;

/* Set by the owner; a value out of range counts as the nearest one in it. One that is NaN is put back to its default: as
 * switched on the seven from dragPerS on are none, and get the craft's own figures once the app has said which craft this is. */
typedef struct {
  float positionScale;    /* stiffness of the cascade in position, 0.5..1.3; of the paper's laws a factor on the feedback of
                             thrust, roll and pitch, within scaleMin..scaleMax */
  float yawScale;         /* factor on the paper's laws' feedback about the vertical, likewise */
  float leashM;           /* farthest error that the paper's laws act on, 0.1..10: metres, and metres a second */
  float speedMS;          /* largest speed of a velocity setpoint, 0.1..5 */
  float accelerationMS2;  /* its largest acceleration, 0.5..10 */
  float rollPitchRateRadS; /* largest roll and pitch rate that the body-rate loop is asked for, 0.5..100 */
  float yawRateRadS;      /* largest yaw rate, likewise */
  float motorLagS;        /* time constant of this craft's motors as you know it; 0: the published figures alone */
  float dragPerS;         /* linear drag over mass, 0..1 1/s */
  float momentXNS;        /* airflow moment about body x over the velocity along y, 0..0.002 N s */
  float momentYNS;        /* the same about y, along x */
  float gust;             /* share of the wind's moment that is told from the accelerometer and fed forward, 0..1 */
  float goalSpeedMS;      /* speed over ground at which the cascade makes a position error good, 0.1..10 */
  float goalClimbMS;      /* the same up and down */
  float tiltDeg;          /* its largest tilt on the way, 6..75 degrees; a trajectory that tilts farther may */
  uint8_t table;          /* 0 the cascade, 1 LYAP-E, 2 LQR-E, 3 LYAP-F, 4 LQR-F, 5 the one sent last */
  uint8_t feedForward;    /* whether the paper's laws are fed forward */
  uint8_t learn;          /* whether drag and moment are corrected in flight */
} quatrackParameters_t;

typedef struct {
  int16_t errorMm[3];       /* position, measured less asked, world frame */
  int16_t rotationMrad[3];  /* rotation from the reference to the craft, body frame */
  uint16_t forces[4];       /* commanded, thousandths of a motor's largest; 0 under a law of thrust and torque */
  uint16_t limited;         /* bits 0-3 thrust, roll and pitch, yaw, motors; 8-11 thrust and body rates of the command */
  uint16_t cycles;          /* processor cycles of the last control step */
  uint8_t mode;             /* 0 off, 1 as asked, 2 to rest and down, 3 stopped, 4 no craft */
  uint8_t table;            /* in use */
  uint16_t badStates;       /* steps on estimates that had to be bridged */
  uint16_t badSetpoints;    /* setpoints that make no sense: to rest and slowly down */
  uint16_t limitedSteps;    /* steps that gave something up */
  uint16_t jumps;           /* setpoints that were not where the ones before led */
  uint16_t refusedTables;   /* tables asked for or sent that are not flown */
  uint16_t refusal;         /* why: 1 no such table, 2 none sent, 3 motor lag, 4 unsound, 5 vehicle or rate, 6 law */
  uint16_t putBack;         /* parameters that were NaN and got their defaults back */
  uint16_t parameter;       /* which was the last, counted from 1 as they are above */
  uint16_t reason;          /* why the newest flight was left: 0 it was not, 1 bad setpoint, 2 no position or velocity,
                               3 no attitude, 4 no body rates, 5 no output of the law, 6 motors at their limits, 7 landed,
                               8 no ground found, 9 tilted, 10 upside down, 11 no climb under thrust */
} quatrackLog_t;

/* The figures that the cascade has learned in flight and flies with. */
typedef struct {
  float dragPerS;           /* 1/s */
  float momentNS[2];        /* N s */
  float motorShare;         /* force of the motors as a share of the commanded one */
  float disturbanceMS2[3];  /* x and y, world frame, and along the thrust */
  float stands;             /* 1: taken to stand or to be held */
} quatrackLearned_t;

/* Read-only. */
typedef struct {
  float scaleMin;   /* the factors that are taken with the table in use */
  float scaleMax;
  float gains[19];  /* thrust from z, vz, force, integral; roll from y, vy, rotation, rate, force, integral; pitch from x
                       likewise; yaw from rotation, rate, force. 0 where the law has none */
} quatrackGains_t;

typedef struct {
  quatrackParameters_t parameters;
  quatrackLog_t log;
  quatrackLearned_t learned;
  quatrackGains_t gains;
} quatrack_t;

extern quatrack_t quatrack;

/* Says which craft this is and starts anew, motors off. False where there is no table for it. */
bool quatrackPlatform(const quatrackPlatform_t *platform);
/* The same for a craft of your own. Null where it flies; else why it does not, in words, and the motors stay off. */
const char *quatrackCraft(const quatrackPlatform_t *platform, const quatrackCraft_t *craft);
/* Looks at the parameters; to be called a few times a second from the task that calls the others. */
void quatrackService(void);
/* Takes a packet of the app channel; the answer is to be sent back. */
void quatrackPacket(const quatrackPacket_t *packet, quatrackPacket_t *answer);

#endif
