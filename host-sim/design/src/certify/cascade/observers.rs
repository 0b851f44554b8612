//! The constants of the cascade's observers as the core has them; a test of both holds them together.

/// Poles of the velocity held to the position, rad/s.
pub(super) const HELD_RAD_S: f64 = 10.0;

/// Gains a step of 2 ms of the force observer across: velocity, disturbance, slope.
pub(super) const ACROSS: [f64; 3] = [0.090_68, 2.154_2, 25.587];

/// The period that these are for, s.
pub(super) const ACROSS_PERIOD_S: f64 = 0.002;

/// Natural frequency (rad/s) and damping of the force observer along the thrust.
pub(super) const ALONG: [f64; 2] = [5.0, 0.8];

/// Natural frequencies of the torque observer, across and in yaw (rad/s), and its damping.
pub(super) const TORQUE_RAD_S: [f64; 2] = [3.0, 1.0];
pub(super) const TORQUE_DAMPING: f64 = 0.8;

/// Time between two looks at the accelerometer (s), and the share that its low-pass takes of each.
pub(super) const AIR_TICK_S: f64 = 0.01;
pub(super) const AIR_LOW_PASS: f64 = 8.0 * AIR_TICK_S / (1.0 + 4.0 * AIR_TICK_S);

/// Least drag by which a felt force is taken for a wind, 1/s.
pub(super) const DRAG_LEAST_PER_S: f64 = 0.2;

/// Share of the moment on the way to a reference that is answered.
pub(super) const APPROACH_SHARE: f64 = 0.4;
