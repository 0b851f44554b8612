// cascade-100ms for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design d538e6303804398b4b2f2e0ae8e7e23bb1990934ad0414c070e336b289bf9995
// Certificate 26e12e1defc10ad065d928f50e1f4f9d2e08c687f67b40ab09fa8bfda9d483b2

/// The default for a Crazyflie 2.1: for any published lag of its motors.
#[rustfmt::skip]
pub static CASCADE_100MS: quatrack::gains::table::CascadeTable = quatrack::gains::table::CascadeTable {
    gains: quatrack::cascade::CascadeGains::table([0.31222016, 0.14983225, 1.2673048, -0.2136065, -0.104649305, 0.1990894, 0.018505087, 4.4724517, 0.21362759, 0.10468733, 0.19924217, 0.018532433, 4.4630184, 0.011127906, 0.0060562287, 0.4689848]),
    motor_lag_s: 0.1,
    air: quatrack::cascade::Air {
        drag_per_s: 0.316,
        drag_along_share: 1.0,
        moment_n_s: [0.0003, 0.00034],
        gust: 0.55,
        learn: true,
    },
    certified: quatrack::gains::table::CascadeRange {
        motor_lag_s: [0.05, 0.126],
        mass_share: 0.2,
        inertia_share: 0.3,
        force_share: [0.7, 1.05],
        delay_s: 0.01,
        drag_per_s: 0.6,
        moment_n_s: [0.00045, 0.00051],
    },
};
