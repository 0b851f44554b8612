// cascade-kit-20ms for crazyflie-2.1-upgrade-kit at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design ca2d0e5f7a42902917adaeaab92bd16bd9c705fa4f85f283581a4ad18c22ac57
// Certificate a420e8d1150559017ef6c2479a1988d467f6af91ee0bde7b0343f4fed389e273

/// For a Crazyflie 2.1 with the upgrade kit whose motors are known to lag about 20 ms.
#[rustfmt::skip]
pub static CASCADE_KIT_20MS: quatrack::gains::table::CascadeTable = quatrack::gains::table::CascadeTable {
    gains: quatrack::cascade::CascadeGains::table([0.31157106, 0.13670635, 0.29449406, -0.21068482, -0.0984985, 0.1742029, 0.01412461, 1.1556023, 0.21071464, 0.098527275, 0.17429559, 0.014138732, 1.152936, 0.011139608, 0.0067011905, 0.07286395]),
    motor_lag_s: 0.02,
    air: quatrack::cascade::Air {
        drag_per_s: 0.316,
        drag_along_share: 1.0,
        moment_n_s: [0.0003, 0.00034],
        gust: 0.55,
        learn: true,
    },
    certified: quatrack::gains::table::CascadeRange {
        motor_lag_s: [0.01, 0.032],
        mass_share: 0.2,
        inertia_share: 0.3,
        force_share: [0.7, 1.05],
        delay_s: 0.01,
        drag_per_s: 0.6,
        moment_n_s: [0.00045, 0.00051],
    },
};
