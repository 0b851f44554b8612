// cascade-20ms for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design 5892dbcd7f3a92a314406049ca2ac506d7f2cf7190179249e82084606646a2c0
// Certificate 72e34b76f27a8bb6817a792390ca963831e72db257dd0cab7dfdfe59ea871f56

/// For a Crazyflie 2.1 whose motors are known to lag about 20 ms.
#[rustfmt::skip]
pub static CASCADE_20MS: quatrack::gains::table::CascadeTable = quatrack::gains::table::CascadeTable {
    gains: quatrack::cascade::CascadeGains::table([0.3111534, 0.13439348, 0.32090324, -0.2091389, -0.097105786, 0.16986248, 0.013477834, 1.293807, 0.20917985, 0.097140476, 0.16996716, 0.013493086, 1.2901471, 0.011126379, 0.005291701, 0.09652871]),
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
