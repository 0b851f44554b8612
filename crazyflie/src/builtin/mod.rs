//! The tables in the image with what their certificates say.

mod paper_limits;

use quatrack::CascadeGains;
use quatrack::gains::cascade as gains;

pub(crate) use paper_limits::{LQR_E, LQR_F, LYAP_E, LYAP_F};

/// Of a table of the paper: the factor by which all channels of the command may be off at once, from its certificate, and
/// the longest lag of the motors, s, with which it is flown.
pub(crate) type Certified = (f32, f32);

/// Gains of a cascade with what they are certified for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cascade {
    /// The gains.
    pub(crate) gains: CascadeGains,
    /// The lag of the motors that they were designed for, s.
    pub(crate) lag_s: f32,
    /// Longest lag of the motors, s, with which they fly where the owner states it.
    pub(crate) stated_to_s: f32,
    /// Whether they fly with the stated lag, off by a quarter, or with that of their design, which serves true lags of 50 to
    /// 126 ms.
    pub(crate) as_stated: bool,
}

/// Shortest lag of the motors, s, that an owner may state.
pub(crate) const STATED_FROM_S: f32 = 0.004;

/// For each of [`crate::craft::KNOWN`]: the gains for stated lags, the shortest first, and the place of those that are flown where
/// none is stated.
pub(crate) static CASCADES: [([Cascade; 3], usize); 3] = [
    (
        [
            cascade(gains::CRAZYFLIE_2_1_20_MS, 0.02, 0.036),
            cascade(gains::CRAZYFLIE_2_1_63_MS, 0.0635, 0.08),
            cascade(gains::CRAZYFLIE_2_1_100_MS, 0.1, 0.126),
        ],
        2,
    ),
    (
        [
            cascade(gains::UPGRADE_KIT_20_MS, 0.02, 0.036),
            cascade(gains::UPGRADE_KIT_63_MS, 0.0635, 0.08),
            cascade(gains::UPGRADE_KIT_100_MS, 0.1, 0.126),
        ],
        2,
    ),
    (
        [
            cascade(gains::BRUSHLESS_20_MS, 0.02, 0.032),
            cascade(gains::BRUSHLESS_50_MS, 0.05, 0.07),
            Cascade { as_stated: false, ..cascade(gains::BRUSHLESS_100_MS, 0.1, 0.126) },
        ],
        1,
    ),
];

const fn cascade(gains: CascadeGains, lag_s: f32, stated_to_s: f32) -> Cascade {
    Cascade { gains, lag_s, stated_to_s, as_stated: true }
}
