//! The cascade's gains of the Crazyflies at 500 Hz, each for a motor lag: designed with the standard weights, and held to the design
//! by a test. Named by craft and lag in milliseconds.

use crate::cascade::CascadeGains;

/// Crazyflie 2.1 Brushless, 50 ms: where no lag is stated.
pub const BRUSHLESS_50_MS: CascadeGains = CascadeGains::table([
    0.3125298,
    0.14812583,
    0.58468807,
    -0.2146692,
    -0.105255775,
    0.20049259,
    0.018660415,
    1.998529,
    0.21501802,
    0.10595838,
    0.20338172,
    0.019181836,
    1.9205307,
    0.011147015,
    0.008298051,
    0.14903374,
]);

/// Crazyflie 2.1 Brushless, 20 ms.
pub const BRUSHLESS_20_MS: CascadeGains = CascadeGains::table([
    0.31218943,
    0.14101066,
    0.2553912,
    -0.21327254,
    -0.101396486,
    0.18415067,
    0.015704136,
    0.9242351,
    0.21375038,
    0.10205452,
    0.18657702,
    0.016106745,
    0.8815099,
    0.011146897,
    0.007981466,
    0.05982313,
]);

/// Crazyflie 2.1 Brushless, 100 ms.
pub const BRUSHLESS_100_MS: CascadeGains = CascadeGains::table([
    0.31289828,
    0.15767089,
    1.0528648,
    -0.2157969,
    -0.10963845,
    0.22030026,
    0.022460125,
    3.4927988,
    0.21606135,
    0.110440195,
    0.22390665,
    0.02316119,
    3.3745265,
    0.011147281,
    0.0087938,
    0.2956891,
]);

/// Crazyflie 2.1, 100 ms: where no lag is stated.
pub const CRAZYFLIE_2_1_100_MS: CascadeGains = CascadeGains::table([
    0.31222016,
    0.14983225,
    1.2673048,
    -0.2136065,
    -0.104649305,
    0.1990894,
    0.018505087,
    4.4724517,
    0.21362759,
    0.10468733,
    0.19924217,
    0.018532433,
    4.4630184,
    0.011127906,
    0.0060562287,
    0.4689848,
]);

/// Crazyflie 2.1, 63.5 ms.
pub const CRAZYFLIE_2_1_63_MS: CascadeGains = CascadeGains::table([
    0.31185976,
    0.14368457,
    0.87710154,
    -0.21240167,
    -0.10202441,
    0.18828349,
    0.016565284,
    3.182113,
    0.21242741,
    0.102059804,
    0.18841484,
    0.016587503,
    3.1748047,
    0.011127165,
    0.005726086,
    0.30201247,
]);

/// Crazyflie 2.1, 20 ms.
pub const CRAZYFLIE_2_1_20_MS: CascadeGains = CascadeGains::table([
    0.3111534,
    0.13439348,
    0.32090324,
    -0.2091389,
    -0.097105786,
    0.16986248,
    0.013477834,
    1.293807,
    0.20917985,
    0.097140476,
    0.16996716,
    0.013493086,
    1.2901471,
    0.011126379,
    0.005291701,
    0.09652871,
]);

/// Crazyflie 2.1 with the thrust upgrade kit, 100 ms: where no lag is stated.
pub const UPGRADE_KIT_100_MS: CascadeGains = CascadeGains::table([
    0.31248882,
    0.152604,
    1.1823446,
    -0.21440971,
    -0.106210046,
    0.20547901,
    0.019663885,
    4.1132193,
    0.21442536,
    0.106242985,
    0.20561644,
    0.019689139,
    4.1062207,
    0.011140291,
    0.007496189,
    0.35820717,
]);

/// Crazyflie 2.1 with the thrust upgrade kit, 63.5 ms.
pub const UPGRADE_KIT_63_MS: CascadeGains = CascadeGains::table([
    0.31217313,
    0.14623435,
    0.81417584,
    -0.21338,
    -0.103469454,
    0.19376743,
    0.017506704,
    2.9042785,
    0.21339902,
    0.10349981,
    0.19388522,
    0.017527223,
    2.8988764,
    0.011139942,
    0.0071483636,
    0.2294418,
]);

/// Crazyflie 2.1 with the thrust upgrade kit, 20 ms.
pub const UPGRADE_KIT_20_MS: CascadeGains = CascadeGains::table([
    0.31157106,
    0.13670635,
    0.29449406,
    -0.21068482,
    -0.0984985,
    0.1742029,
    0.01412461,
    1.1556023,
    0.21071464,
    0.098527275,
    0.17429559,
    0.014138732,
    1.152936,
    0.011139608,
    0.0067011905,
    0.07286395,
]);
