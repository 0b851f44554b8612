// cascade-kit-63ms for crazyflie-2.1-upgrade-kit at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design 1f123e4692e1dde155064aac2ea5f8b04b1ae2cdc08621a0f7da7fc56f9ccd1e
// Certificate 9f8888f88ab5b8ab52c29ed96ff0e231711d0b51c3a43f1beea54a2747d1b020

/// For a Crazyflie 2.1 with the upgrade kit whose motors are known to lag about 63.5 ms.
#[rustfmt::skip]
pub static CASCADE_KIT_63MS: quatrack::gains::table::CascadeTable = quatrack::gains::table::CascadeTable {
    gains: quatrack::cascade::CascadeGains::table([0.31217313, 0.14623435, 0.81417584, -0.21338, -0.103469454, 0.19376743, 0.017506704, 2.9042785, 0.21339902, 0.10349981, 0.19388522, 0.017527223, 2.8988764, 0.011139942, 0.0071483636, 0.2294418]),
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
