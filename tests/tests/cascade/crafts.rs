//! The crafts of the flights: as they are, and as they are told.

use quatrack::airframe::AirframeFigures;
use quatrack::cascade::{Air, Cascade, CascadeGains, CascadeLimits};
use quatrack::{Airframe, Rate};

use crate::plant::Craft;

/// Brushless at 50 ms.
pub const BRUSHLESS_50: CascadeGains = CascadeGains::table([
    0.3125, 0.1481, 0.585, -0.2147, -0.1053, 0.2005, 0.01866, 1.999, 0.2150, 0.1060, 0.2034, 0.01918, 1.921, 0.01115,
    0.00830, 0.1490,
]);

/// 2.1 at 63.5 ms.
pub const BRUSHED_63: CascadeGains = CascadeGains::table([
    0.3119, 0.1437, 0.877, -0.2124, -0.1020, 0.1883, 0.01657, 3.182, 0.2124, 0.1020, 0.1883, 0.01663, 3.172, 0.01113,
    0.00573, 0.3020,
]);

/// Identified from flights (arXiv 2512.14450): with decks and guards.
pub const BRUSHLESS: Craft = Craft {
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
pub const BRUSHED: Craft = Craft {
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

pub fn airframe(base: &Airframe, mass_kg: f32, lag_s: f32) -> Airframe {
    let figures = AirframeFigures { mass_kg, motor_lag_s: lag_s, ..*base.figures() };
    Airframe::new(figures).unwrap()
}

pub fn brushless(air: &Air) -> Cascade {
    told(&BRUSHLESS_50, &airframe(&Airframe::CRAZYFLIE_2_1_BRUSHLESS, 0.045, 0.05), air)
}

pub fn brushed(air: &Air) -> Cascade {
    told(&BRUSHED_63, &airframe(&Airframe::CRAZYFLIE_2_1, 0.027, 0.0635), air)
}

pub fn told(gains: &CascadeGains, airframe: &Airframe, air: &Air) -> Cascade {
    Cascade::new(gains, airframe, Rate::from_hz(500).unwrap(), &CascadeLimits::STANDARD, air).unwrap()
}
