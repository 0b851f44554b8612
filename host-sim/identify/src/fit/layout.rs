//! Where each parameter is among the values, its unit, its start value, and its prior.

use nalgebra::DVector;

use super::prior::{Base, Prior};
use super::problem::Drive;

/// Logarithm, of s.
pub(super) const LAG: usize = 0;
/// Logarithm of rise over fall.
pub(super) const ASYMMETRY: usize = 1;
pub(super) const DELAY: usize = 2;
pub(super) const COMMAND_POWER: usize = 3;
pub(super) const VOLTAGE_POWER: usize = 4;
pub(super) const DRAG_Z: usize = 5;
pub(super) const LIFT: usize = 6;
/// Logarithm of the inertia, moment, damping, about x and about y.
pub(super) const INERTIA: [usize; 2] = [7, 10];
pub(super) const MOMENT: [usize; 2] = [8, 11];
pub(super) const DAMPING: [usize; 2] = [9, 12];
/// Of the balance about x and about y: the drag along the other axis, and the accelerometer's lever, m.
pub(super) const DRAG: [usize; 2] = [13, 15];
pub(super) const LEVER: [usize; 2] = [14, 16];
/// By how much the velocity and the accelerometer come later than the gyroscope, s.
pub(super) const POSE_SHIFT: usize = 17;
pub(super) const FORCE_SHIFT: usize = 18;
/// Logarithms of deviations and memories, see [`Noise`].
pub(super) const NOISE: [usize; 2] = [19, 28];
pub(super) const NOISE_COUNT: usize = 9;
/// Of the thrust: memory, deviation, accelerometer.
pub(super) const NOISE_Z: usize = 37;
/// How much later than in the middle between two samples a command jumps, s: logged with the setpoints it is half a sample.
pub(super) const JUMP: usize = 40;
/// Parameters before those of each flight, which are logarithms of the thrust per mass at full command.
pub(super) const SHARED: usize = 41;

/// Of a balance about x or y: its process noise, and that of its sensors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Noise {
    /// A disturbing angular acceleration: memory, s, and deviation, rad/s^2.
    pub(super) torque: [f64; 2],
    /// Of the air, which acts by drag and moment: s and m/s.
    pub(super) air: [f64; 2],
    /// Of the accelerometer alone: s and m/s^2.
    pub(super) force: [f64; 2],
    /// Of the body rate in a step, rad/s.
    pub(super) rate: f64,
    /// White, of the gyroscope, rad/s, and of the accelerometer, m/s^2.
    pub(super) sensors: [f64; 2],
}

impl Noise {
    pub(super) fn of(values: &DVector<f64>, axis: usize) -> Self {
        let value = |k: usize| values[NOISE[axis] + k].exp();
        Self {
            torque: [value(0), value(1)],
            air: [value(2), value(3)],
            force: [value(4), value(5)],
            rate: value(6),
            sensors: [value(7), value(8)],
        }
    }
}

/// Parameters that are logarithms of deviations, and not of memories.
pub(super) fn deviations() -> impl Iterator<Item = usize> {
    let across = NOISE.into_iter().flat_map(|first| [1, 3, 5, 6, 7, 8].map(|k| first + k));
    across.chain([NOISE_Z + 1, NOISE_Z + 2])
}

/// Steps of a difference, and units of the parameters.
pub(super) fn units(base: &Base) -> Vec<f64> {
    let moment = 3e-3 * base.half_arm_m.max(0.01);
    let damping = 0.05 * base.damping_scale();
    let mut units = vec![0.1, 0.1, 2e-3, 0.05, 0.05, 0.1, 0.02];
    units.extend([0.05, moment, damping, 0.05, moment, damping]);
    units.extend([0.05, 2e-3, 0.05, 2e-3, 2e-3, 2e-3]);
    units.extend(std::iter::repeat_n(0.2, JUMP - NOISE[0]));
    units.push(2e-3);
    units
}

/// The motors' answer to a command.
pub(super) fn drive_of(values: &DVector<f64>) -> Drive {
    let (lag_s, half) = (values[LAG].exp(), 0.5 * values[ASYMMETRY]);
    Drive {
        rise_s: lag_s * half.exp(),
        fall_s: lag_s * (-half).exp(),
        delay_s: values[DELAY],
        jump_s: values[JUMP],
        powers: [values[COMMAND_POWER], values[VOLTAGE_POWER]],
    }
}

/// Results of regressions, to begin from.
pub(super) struct Found {
    pub(super) lag_s: f64,
    pub(super) inertia: [f64; 2],
    pub(super) moment: [f64; 2],
    pub(super) drag: [f64; 2],
    /// White noise of the gyroscope, rad/s, and the accelerometer, m/s^2.
    pub(super) sensors: [f64; 2],
}

/// Values to begin with, and priors.
pub(super) fn start(base: &Base, found: &Found) -> (DVector<f64>, Vec<Prior>) {
    let damping = base.damping_scale();
    let drag = 0.5 * (found.drag[0] + found.drag[1]).clamp(0.0, 2.0);
    let mut all = vec![
        (found.lag_s.ln(), Prior::gauss(base.lag_s.ln(), 0.7)),
        (0.0, Prior::gauss(0.0, 0.4)),
        // The commands' stream may come early or late by tens of milliseconds.
        (base.delay_s, Prior::cauchy(base.delay_s, 0.002)),
        (base.powers[0], Prior::cauchy(base.powers[0], 0.05)),
        (base.powers[1], Prior::gauss(base.powers[1], 0.3)),
        (drag, Prior::gauss(drag, 0.3)),
        (0.0, Prior::gauss(0.0, 0.15)),
    ];
    for axis in 0..2 {
        all.extend([
            (found.inertia[axis].ln(), Prior::gauss(base.inertia_kg_m2[axis].ln(), 0.7)),
            (found.moment[axis], Prior::gauss(0.0, 0.5 * base.half_arm_m * base.mass_kg)),
            (0.05 * damping, Prior::gauss(0.05 * damping, 0.02 * damping)),
        ]);
    }
    for axis in 0..2 {
        let drag = found.drag[1 - axis];
        all.extend([(drag, Prior::gauss(drag, 1.0)), (0.0, Prior::gauss(0.0, 0.02))]);
    }
    all.extend([(0.0, Prior::gauss(0.0, 0.003)), (0.0, Prior::gauss(0.0, 0.006))]);
    let believed = |value: f64, deviation: f64| (f64::ln(value), Prior::gauss(f64::ln(value), deviation));
    for _ in 0..2 {
        all.extend([
            believed(0.1, 1.0),
            believed(2.0, 2.0),
            believed(0.5, 1.0),
            believed(0.1, 2.0),
            believed(0.5, 1.0),
            believed(0.03, 2.0),
            believed(0.01, 2.0),
            believed(found.sensors[0], 1.0),
            believed(found.sensors[1], 1.0),
        ]);
    }
    all.extend([believed(0.2, 1.0), believed(0.1, 2.0), believed(found.sensors[1], 1.0)]);
    all.push((0.0, Prior::gauss(0.0, 0.004)));
    debug_assert!(all.len() == SHARED);
    let (values, priors): (Vec<f64>, Vec<Prior>) = all.into_iter().unzip();
    (DVector::from_vec(values), priors)
}
