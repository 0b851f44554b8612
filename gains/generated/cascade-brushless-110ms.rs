// cascade-brushless-110ms for crazyflie-2.1-brushless at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design 573266d49a7524f806f8b369115bd935e8710bbf3190e271784e663895a1cda4
// Certificate 0f7f44c835185937a041b21998ec94afdaf97acb6761f365fc064343376c03e8

/// For a Crazyflie 2.1 Brushless whose motors lag by up to 126 ms.
#[rustfmt::skip]
pub static CASCADE_BRUSHLESS_110MS: quatrack::gains::table::CascadeTable = quatrack::gains::table::CascadeTable {
    gains: quatrack::cascade::CascadeGains::table([0.38199797, 0.23513117, 1.5053833, -0.21527366, -0.11194423, 0.24329314, 0.026600828, 4.0994744, 0.21557237, 0.11269411, 0.24667174, 0.02730376, 3.9525213, 0.011147342, 0.008888471, 0.3246608]),
    motor_lag_s: 0.11,
    air: quatrack::cascade::Air {
        drag_per_s: 0.353,
        drag_along_share: 1.0,
        moment_n_s: [0.00056, 0.00073],
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
        moment_n_s: [0.00084, 0.001095],
    },
};
