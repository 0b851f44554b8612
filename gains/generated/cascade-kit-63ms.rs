// cascade-kit-63ms for crazyflie-2.1-upgrade-kit at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design d311f12b814b6e75777f8cf3409e8f019175da5e974e9ed664df6cb27d506983
// Certificate 498ab10c7fcbe021654c2d3eed4ab0e630a3f2fd08afb209485bf406b5ad9cb9

/// For a Crazyflie 2.1 with the upgrade kit whose motors are known to lag about 63.5 ms.
#[rustfmt::skip]
pub static CASCADE_KIT_63MS: quatrack::gains::table::CascadeTable = quatrack::gains::table::CascadeTable {
    gains: quatrack::cascade::CascadeGains::table([0.31198832, 0.15487467, 0.8512832, -0.21338, -0.103469454, 0.19376743, 0.017506704, 2.9042785, 0.21339902, 0.10349981, 0.19388522, 0.017527223, 2.8988764, 0.011139942, 0.0071483636, 0.2294418]),
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
