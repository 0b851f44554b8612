// cascade-100ms for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design f8d2e30799d18781cf5636ef48bb167003e77558131b176a07728e43cdcee7fd
// Certificate e57b35bc4f4e4c1eb601b7ed082a6a1a8bb9a5779dd59540ae81af9463ca84ef

/// The default for a Crazyflie 2.1: for any published lag of its motors.
#[rustfmt::skip]
pub static CASCADE_100MS: quatrack::gains::table::CascadeTable = quatrack::gains::table::CascadeTable {
    gains: quatrack::cascade::CascadeGains::table([0.3115765, 0.1845908, 1.4708399, -0.2136065, -0.104649305, 0.1990894, 0.018505087, 4.4724517, 0.21362759, 0.10468733, 0.19924217, 0.018532433, 4.4630184, 0.011127906, 0.0060562287, 0.4689848]),
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
