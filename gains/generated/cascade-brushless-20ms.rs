// cascade-brushless-20ms for crazyflie-2.1-brushless at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design 17e6a4b01ba64d011f58726a486db0e4601e480240727cf361c005774bb43a68
// Certificate 8570105e929a13688d8614e144a2d84c0a642df0fdcdccb5e20696a12976bdbe

/// For a Crazyflie 2.1 Brushless whose motors are known to lag about 20 ms.
#[rustfmt::skip]
pub static CASCADE_BRUSHLESS_20MS: quatrack::gains::table::CascadeTable = quatrack::gains::table::CascadeTable {
    gains: quatrack::cascade::CascadeGains::table([0.31218943, 0.14101066, 0.2553912, -0.21327254, -0.101396486, 0.18415067, 0.015704136, 0.9242351, 0.21375038, 0.10205452, 0.18657702, 0.016106745, 0.8815099, 0.011146897, 0.007981466, 0.05982313]),
    motor_lag_s: 0.02,
    air: quatrack::cascade::Air {
        drag_per_s: 0.353,
        drag_along_share: 1.0,
        moment_n_s: [0.00056, 0.00073],
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
        moment_n_s: [0.00084, 0.001095],
    },
};
