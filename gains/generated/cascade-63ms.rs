// cascade-63ms for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design 40dd9dac305e32ff3c562917dbe9f87a161c92a08875b0980db7f911b732b01e
// Certificate dd39e2f7f0838230fe28e982bcf344bfe94465aeebdecadbcf170c08aea7b6ef

/// For a Crazyflie 2.1 whose motors are known to lag about 63.5 ms.
#[rustfmt::skip]
pub static CASCADE_63MS: quatrack::gains::table::CascadeTable = quatrack::gains::table::CascadeTable {
    gains: quatrack::cascade::CascadeGains::table([0.31185976, 0.14368457, 0.87710154, -0.21240167, -0.10202441, 0.18828349, 0.016565284, 3.182113, 0.21242741, 0.102059804, 0.18841484, 0.016587503, 3.1748047, 0.011127165, 0.005726086, 0.30201247]),
    motor_lag_s: 0.0635,
    air: quatrack::cascade::Air {
        drag_per_s: 0.316,
        drag_along_share: 1.0,
        moment_n_s: [0.0003, 0.00034],
        gust: 0.55,
        learn: true,
    },
    certified: quatrack::gains::table::CascadeRange {
        motor_lag_s: [0.032, 0.095],
        mass_share: 0.2,
        inertia_share: 0.3,
        force_share: [0.7, 1.05],
        delay_s: 0.01,
        drag_per_s: 0.6,
        moment_n_s: [0.00045, 0.00051],
    },
};
