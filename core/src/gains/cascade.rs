//! The core's own tables of the cascade: made by `cargo gains generate` of the designs in `gains/` and not edited by hand.
//!
//! Each is named by craft and by the motor lag that it is designed for. Of a craft, [`CascadeRange::holds_lag`] tells which is
//! certified for a lag that is stated; the default is for a craft of which none is.
//!
//! [`CascadeRange::holds_lag`]: crate::gains::table::CascadeRange::holds_lag

use crate::cascade::{Air, CascadeGains};
use crate::gains::table::{BuiltInCascade, CascadeRange, CascadeTable, Margins, Name, Vehicle};

/// For a Crazyflie 2.1 Brushless whose motors are known to lag about 20 ms.
/// From `gains/cascade-brushless-20ms.toml`.
pub const BRUSHLESS_20_MS: BuiltInCascade = BuiltInCascade {
    vehicle: Vehicle { name: Name::literal("crazyflie-2.1-brushless"), id: 0xef3a0847 },
    table: CascadeTable {
        gains: CascadeGains::table([0.31218943, 0.14101066, 0.2553912, -0.21327254, -0.101396486, 0.18415067, 0.015704136, 0.9242351, 0.21375038, 0.10205452, 0.18657702, 0.016106745, 0.8815099, 0.011146897, 0.007981466, 0.05982313]),
        motor_lag_s: 0.02,
        air: Air {
            drag_per_s: 0.353,
            drag_along_share: 1.0,
            moment_n_s: [0.00056, 0.00073],
            gust: 0.55,
            learn: true,
        },
        certified: CascadeRange {
            motor_lag_s: [0.01, 0.032],
            mass_share: 0.2,
            inertia_share: 0.3,
            force_share: [0.7, 1.05],
            delay_s: 0.01,
            drag_per_s: 0.6,
            moment_n_s: [0.00084, 0.001095],
        },
    },
    margins: Margins { gain_factor: 2.598, phase_rad: 0.8359 },
    delay_max_s: 0.02399,
    motor_lag_max_s: 0.08995,
};

/// The default for a Crazyflie 2.1 Brushless.
/// From `gains/cascade-brushless-50ms.toml`.
pub const BRUSHLESS_50_MS: BuiltInCascade = BuiltInCascade {
    vehicle: Vehicle { name: Name::literal("crazyflie-2.1-brushless"), id: 0xef3a0847 },
    table: CascadeTable {
        gains: CascadeGains::table([0.3125298, 0.14812583, 0.58468807, -0.2146692, -0.105255775, 0.20049259, 0.018660415, 1.998529, 0.21501802, 0.10595838, 0.20338172, 0.019181836, 1.9205307, 0.011147015, 0.008298051, 0.14903374]),
        motor_lag_s: 0.05,
        air: Air {
            drag_per_s: 0.353,
            drag_along_share: 1.0,
            moment_n_s: [0.00056, 0.00073],
            gust: 0.55,
            learn: true,
        },
        certified: CascadeRange {
            motor_lag_s: [0.025, 0.075],
            mass_share: 0.2,
            inertia_share: 0.3,
            force_share: [0.7, 1.05],
            delay_s: 0.01,
            drag_per_s: 0.6,
            moment_n_s: [0.00084, 0.001095],
        },
    },
    margins: Margins { gain_factor: 2.099, phase_rad: 0.6817 },
    delay_max_s: 0.02799,
    motor_lag_max_s: 0.1344,
};

/// For a Crazyflie 2.1 Brushless whose motors lag by up to 126 ms.
/// From `gains/cascade-brushless-110ms.toml`.
pub const BRUSHLESS_110_MS: BuiltInCascade = BuiltInCascade {
    vehicle: Vehicle { name: Name::literal("crazyflie-2.1-brushless"), id: 0xef3a0847 },
    table: CascadeTable {
        gains: CascadeGains::table([0.38199797, 0.23513117, 1.5053833, -0.21527366, -0.11194423, 0.24329314, 0.026600828, 4.0994744, 0.21557237, 0.11269411, 0.24667174, 0.02730376, 3.9525213, 0.011147342, 0.008888471, 0.3246608]),
        motor_lag_s: 0.11,
        air: Air {
            drag_per_s: 0.353,
            drag_along_share: 1.0,
            moment_n_s: [0.00056, 0.00073],
            gust: 0.55,
            learn: true,
        },
        certified: CascadeRange {
            motor_lag_s: [0.05, 0.126],
            mass_share: 0.2,
            inertia_share: 0.3,
            force_share: [0.7, 1.05],
            delay_s: 0.01,
            drag_per_s: 0.6,
            moment_n_s: [0.00084, 0.001095],
        },
    },
    margins: Margins { gain_factor: 1.968, phase_rad: 0.6308 },
    delay_max_s: 0.02999,
    motor_lag_max_s: 0.2439,
};

/// Of the Crazyflie 2.1 Brushless, for the shortest lags first.
pub const BRUSHLESS: [BuiltInCascade; 3] = [BRUSHLESS_20_MS, BRUSHLESS_50_MS, BRUSHLESS_110_MS];

/// Of the Crazyflie 2.1 Brushless where no lag is stated.
pub const BRUSHLESS_DEFAULT: BuiltInCascade = BRUSHLESS_50_MS;

/// For a Crazyflie 2.1 whose motors are known to lag about 20 ms.
/// From `gains/cascade-20ms.toml`.
pub const CRAZYFLIE_2_1_20_MS: BuiltInCascade = BuiltInCascade {
    vehicle: Vehicle { name: Name::literal("crazyflie-2.1"), id: 0x89833c06 },
    table: CascadeTable {
        gains: CascadeGains::table([0.3111534, 0.13439348, 0.32090324, -0.2091389, -0.097105786, 0.16986248, 0.013477834, 1.293807, 0.20917985, 0.097140476, 0.16996716, 0.013493086, 1.2901471, 0.011126379, 0.005291701, 0.09652871]),
        motor_lag_s: 0.02,
        air: Air {
            drag_per_s: 0.316,
            drag_along_share: 1.0,
            moment_n_s: [0.0003, 0.00034],
            gust: 0.55,
            learn: true,
        },
        certified: CascadeRange {
            motor_lag_s: [0.01, 0.032],
            mass_share: 0.2,
            inertia_share: 0.3,
            force_share: [0.7, 1.05],
            delay_s: 0.01,
            drag_per_s: 0.6,
            moment_n_s: [0.00045, 0.00051],
        },
    },
    margins: Margins { gain_factor: 2.802, phase_rad: 0.8854 },
    delay_max_s: 0.01999,
    motor_lag_max_s: 0.1021,
};

/// For a Crazyflie 2.1 whose motors are known to lag about 63.5 ms.
/// From `gains/cascade-63ms.toml`.
pub const CRAZYFLIE_2_1_63_MS: BuiltInCascade = BuiltInCascade {
    vehicle: Vehicle { name: Name::literal("crazyflie-2.1"), id: 0x89833c06 },
    table: CascadeTable {
        gains: CascadeGains::table([0.31185976, 0.14368457, 0.87710154, -0.21240167, -0.10202441, 0.18828349, 0.016565284, 3.182113, 0.21242741, 0.102059804, 0.18841484, 0.016587503, 3.1748047, 0.011127165, 0.005726086, 0.30201247]),
        motor_lag_s: 0.0635,
        air: Air {
            drag_per_s: 0.316,
            drag_along_share: 1.0,
            moment_n_s: [0.0003, 0.00034],
            gust: 0.55,
            learn: true,
        },
        certified: CascadeRange {
            motor_lag_s: [0.032, 0.095],
            mass_share: 0.2,
            inertia_share: 0.3,
            force_share: [0.7, 1.05],
            delay_s: 0.01,
            drag_per_s: 0.6,
            moment_n_s: [0.00045, 0.00051],
        },
    },
    margins: Margins { gain_factor: 2.229, phase_rad: 0.7273 },
    delay_max_s: 0.02399,
    motor_lag_max_s: 0.1839,
};

/// The default for a Crazyflie 2.1: for any published lag of its motors.
/// From `gains/cascade-100ms.toml`.
pub const CRAZYFLIE_2_1_100_MS: BuiltInCascade = BuiltInCascade {
    vehicle: Vehicle { name: Name::literal("crazyflie-2.1"), id: 0x89833c06 },
    table: CascadeTable {
        gains: CascadeGains::table([0.3115765, 0.1845908, 1.4708399, -0.2136065, -0.104649305, 0.1990894, 0.018505087, 4.4724517, 0.21362759, 0.10468733, 0.19924217, 0.018532433, 4.4630184, 0.011127906, 0.0060562287, 0.4689848]),
        motor_lag_s: 0.1,
        air: Air {
            drag_per_s: 0.316,
            drag_along_share: 1.0,
            moment_n_s: [0.0003, 0.00034],
            gust: 0.55,
            learn: true,
        },
        certified: CascadeRange {
            motor_lag_s: [0.05, 0.126],
            mass_share: 0.2,
            inertia_share: 0.3,
            force_share: [0.7, 1.05],
            delay_s: 0.01,
            drag_per_s: 0.6,
            moment_n_s: [0.00045, 0.00051],
        },
    },
    margins: Margins { gain_factor: 2.047, phase_rad: 0.6619 },
    delay_max_s: 0.02599,
    motor_lag_max_s: 0.2452,
};

/// Of the Crazyflie 2.1, for the shortest lags first.
pub const CRAZYFLIE_2_1: [BuiltInCascade; 3] = [CRAZYFLIE_2_1_20_MS, CRAZYFLIE_2_1_63_MS, CRAZYFLIE_2_1_100_MS];

/// Of the Crazyflie 2.1 where no lag is stated.
pub const CRAZYFLIE_2_1_DEFAULT: BuiltInCascade = CRAZYFLIE_2_1_100_MS;

/// For a Crazyflie 2.1 with the upgrade kit whose motors are known to lag about 20 ms.
/// From `gains/cascade-kit-20ms.toml`.
pub const UPGRADE_KIT_20_MS: BuiltInCascade = BuiltInCascade {
    vehicle: Vehicle { name: Name::literal("crazyflie-2.1-upgrade-kit"), id: 0x456815c7 },
    table: CascadeTable {
        gains: CascadeGains::table([0.31157106, 0.13670635, 0.29449406, -0.21068482, -0.0984985, 0.1742029, 0.01412461, 1.1556023, 0.21071464, 0.098527275, 0.17429559, 0.014138732, 1.152936, 0.011139608, 0.0067011905, 0.07286395]),
        motor_lag_s: 0.02,
        air: Air {
            drag_per_s: 0.316,
            drag_along_share: 1.0,
            moment_n_s: [0.0003, 0.00034],
            gust: 0.55,
            learn: true,
        },
        certified: CascadeRange {
            motor_lag_s: [0.01, 0.032],
            mass_share: 0.2,
            inertia_share: 0.3,
            force_share: [0.7, 1.05],
            delay_s: 0.01,
            drag_per_s: 0.6,
            moment_n_s: [0.00045, 0.00051],
        },
    },
    margins: Margins { gain_factor: 2.763, phase_rad: 0.8762 },
    delay_max_s: 0.02199,
    motor_lag_max_s: 0.09878,
};

/// For a Crazyflie 2.1 with the upgrade kit whose motors are known to lag about 63.5 ms.
/// From `gains/cascade-kit-63ms.toml`.
pub const UPGRADE_KIT_63_MS: BuiltInCascade = BuiltInCascade {
    vehicle: Vehicle { name: Name::literal("crazyflie-2.1-upgrade-kit"), id: 0x456815c7 },
    table: CascadeTable {
        gains: CascadeGains::table([0.31198832, 0.15487467, 0.8512832, -0.21338, -0.103469454, 0.19376743, 0.017506704, 2.9042785, 0.21339902, 0.10349981, 0.19388522, 0.017527223, 2.8988764, 0.011139942, 0.0071483636, 0.2294418]),
        motor_lag_s: 0.0635,
        air: Air {
            drag_per_s: 0.316,
            drag_along_share: 1.0,
            moment_n_s: [0.0003, 0.00034],
            gust: 0.55,
            learn: true,
        },
        certified: CascadeRange {
            motor_lag_s: [0.032, 0.095],
            mass_share: 0.2,
            inertia_share: 0.3,
            force_share: [0.7, 1.05],
            delay_s: 0.01,
            drag_per_s: 0.6,
            moment_n_s: [0.00045, 0.00051],
        },
    },
    margins: Margins { gain_factor: 2.167, phase_rad: 0.7064 },
    delay_max_s: 0.02599,
    motor_lag_max_s: 0.1767,
};

/// The default for a Crazyflie 2.1 with the upgrade kit: for any published lag of its motors.
/// From `gains/cascade-kit-100ms.toml`.
pub const UPGRADE_KIT_100_MS: BuiltInCascade = BuiltInCascade {
    vehicle: Vehicle { name: Name::literal("crazyflie-2.1-upgrade-kit"), id: 0x456815c7 },
    table: CascadeTable {
        gains: CascadeGains::table([0.3118974, 0.18699412, 1.3693634, -0.21440971, -0.106210046, 0.20547901, 0.019663885, 4.1132193, 0.21442536, 0.106242985, 0.20561644, 0.019689139, 4.1062207, 0.011140291, 0.007496189, 0.35820717]),
        motor_lag_s: 0.1,
        air: Air {
            drag_per_s: 0.316,
            drag_along_share: 1.0,
            moment_n_s: [0.0003, 0.00034],
            gust: 0.55,
            learn: true,
        },
        certified: CascadeRange {
            motor_lag_s: [0.05, 0.126],
            mass_share: 0.2,
            inertia_share: 0.3,
            force_share: [0.7, 1.05],
            delay_s: 0.01,
            drag_per_s: 0.6,
            moment_n_s: [0.00045, 0.00051],
        },
    },
    margins: Margins { gain_factor: 1.992, phase_rad: 0.6406 },
    delay_max_s: 0.02799,
    motor_lag_max_s: 0.2362,
};

/// Of the Crazyflie 2.1 with the thrust upgrade kit, for the shortest lags first.
pub const UPGRADE_KIT: [BuiltInCascade; 3] = [UPGRADE_KIT_20_MS, UPGRADE_KIT_63_MS, UPGRADE_KIT_100_MS];

/// Of the Crazyflie 2.1 with the thrust upgrade kit where no lag is stated.
pub const UPGRADE_KIT_DEFAULT: BuiltInCascade = UPGRADE_KIT_100_MS;
