// cascade-kit-100ms for crazyflie-2.1-upgrade-kit at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design 096eb8b548c749e568705cce83fe8627b17ea9409aa16082ddaf33377cb48d51
// Certificate 0d933e7840fbb3dd8177c508692b2a3eb0dca9010314c17ca8cc3527f625bda4

/// The default for a Crazyflie 2.1 with the upgrade kit: for any published lag of its motors.
#[rustfmt::skip]
pub static CASCADE_KIT_100MS: quatrack::gains::table::CascadeTable = quatrack::gains::table::CascadeTable {
    gains: quatrack::cascade::CascadeGains::table([0.31248882, 0.152604, 1.1823446, -0.21440971, -0.106210046, 0.20547901, 0.019663885, 4.1132193, 0.21442536, 0.106242985, 0.20561644, 0.019689139, 4.1062207, 0.011140291, 0.007496189, 0.35820717]),
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
