// cascade-kit-100ms for crazyflie-2.1-upgrade-kit at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design 5f79948e917b282a49bf8ca0c55a68040252fc6720beb4942971988759644f84
// Certificate 8aaca6231c1026491a948e9e89a150e4cebed0d5bbdf43e6b3edb4693b0ed3b0

/// The default for a Crazyflie 2.1 with the upgrade kit: for any published lag of its motors.
#[rustfmt::skip]
pub static CASCADE_KIT_100MS: quatrack::gains::table::CascadeTable = quatrack::gains::table::CascadeTable {
    gains: quatrack::cascade::CascadeGains::table([0.3118974, 0.18699412, 1.3693634, -0.21440971, -0.106210046, 0.20547901, 0.019663885, 4.1132193, 0.21442536, 0.106242985, 0.20561644, 0.019689139, 4.1062207, 0.011140291, 0.007496189, 0.35820717]),
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
