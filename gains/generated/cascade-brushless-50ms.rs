// cascade-brushless-50ms for crazyflie-2.1-brushless at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design fc5f135255f992bb0b6f6e2b91a175f0abc9d7cc5a9b9f68ba9001482529bac7
// Certificate 3c9ea5097efae66d94127d92df33a369b7263ab417e4447b7fbb83ad39ce5971

/// The default for a Crazyflie 2.1 Brushless.
#[rustfmt::skip]
pub static CASCADE_BRUSHLESS_50MS: quatrack::gains::table::CascadeTable = quatrack::gains::table::CascadeTable {
    gains: quatrack::cascade::CascadeGains::table([0.3125298, 0.14812583, 0.58468807, -0.2146692, -0.105255775, 0.20049259, 0.018660415, 1.998529, 0.21501802, 0.10595838, 0.20338172, 0.019181836, 1.9205307, 0.011147015, 0.008298051, 0.14903374]),
    motor_lag_s: 0.05,
    air: quatrack::cascade::Air {
        drag_per_s: 0.353,
        drag_along_share: 1.0,
        moment_n_s: [0.00056, 0.00073],
        gust: 0.55,
        learn: true,
    },
    certified: quatrack::gains::table::CascadeRange {
        motor_lag_s: [0.025, 0.075],
        mass_share: 0.2,
        inertia_share: 0.3,
        force_share: [0.7, 1.05],
        delay_s: 0.01,
        drag_per_s: 0.6,
        moment_n_s: [0.00084, 0.001095],
    },
};
