//! The crafts of the flights: as they are, and as they are told.

use quatrack::airframe::AirframeFigures;
use quatrack::cascade::{Air, Cascade, CascadeGains, CascadeLimits};
use quatrack::{Airframe, Rate};

use crate::cascade::plant::Craft;

/// Brushless at 50 ms.
pub(crate) const BRUSHLESS_50: CascadeGains = CascadeGains::table([
    0.3125298,
    0.1481258,
    0.5846881,
    -0.2146692,
    -0.1052558,
    0.2004926,
    0.01866042,
    1.998529,
    0.215018,
    0.1059584,
    0.2033817,
    0.01918184,
    1.920531,
    0.01114701,
    0.008298051,
    0.1490337,
]);

/// 2.1 at 63.5 ms.
pub(crate) const BRUSHED_63: CascadeGains = CascadeGains::table([
    0.3118597,
    0.1436846,
    0.8771016,
    -0.2124017,
    -0.1020244,
    0.1882835,
    0.01656528,
    3.182113,
    0.2124274,
    0.1020598,
    0.1884148,
    0.0165875,
    3.174805,
    0.01112717,
    0.005726086,
    0.3020125,
]);

/// Identified from flights (arXiv 2512.14450): with decks and guards.
pub(crate) const BRUSHLESS: Craft = Craft {
    mass_kg: 0.045,
    inertia: [3.36e-5, 3.87e-5, 5.9e-5],
    lever_m: 0.035_355_34,
    torque_per_thrust_m: 0.005_692_788_4,
    force_max_n: 0.2,
    lag_s: [0.030, 0.047],
    delay_s: 0.005,
    drag: [0.447, 0.435, 0.45],
    moment: [7.0e-4, 9.1e-4],
    motors: [1.0; 4],
    torque_bias: [0.0; 3],
};

/// Identified from flights (arXiv 2603.09908).
pub(crate) const BRUSHED: Craft = Craft {
    mass_kg: 0.027,
    inertia: [1.6e-5, 1.75e-5, 2.93e-5],
    lever_m: 0.032_526_91,
    torque_per_thrust_m: 0.006_992_894_7,
    force_max_n: 0.12,
    lag_s: [0.067, 0.067],
    delay_s: 0.004,
    drag: [0.39, 0.40, 0.39],
    moment: [3.8e-4, 4.3e-4],
    motors: [1.0; 4],
    torque_bias: [0.0; 3],
};

pub(crate) fn airframe(base: &Airframe, mass_kg: f32, lag_s: f32) -> Airframe {
    let figures = AirframeFigures { mass_kg, motor_lag_s: lag_s, ..*base.figures() };
    Airframe::new(figures).unwrap()
}

pub(crate) fn brushless(air: &Air) -> Cascade {
    told(&BRUSHLESS_50, &airframe(&Airframe::CRAZYFLIE_2_1_BRUSHLESS, 0.045, 0.05), air)
}

pub(crate) fn brushed(air: &Air) -> Cascade {
    told(&BRUSHED_63, &airframe(&Airframe::CRAZYFLIE_2_1, 0.027, 0.0635), air)
}

pub(crate) fn told(gains: &CascadeGains, airframe: &Airframe, air: &Air) -> Cascade {
    Cascade::new(gains, airframe, Rate::from_hz(500).unwrap(), &CascadeLimits::STANDARD, air).unwrap()
}
