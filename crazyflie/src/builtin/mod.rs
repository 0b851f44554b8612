//! The tables in the image, with the figures of their certificates.

mod paper_limits;

use quatrack::CascadeGains;
use quatrack::gains::cascade as tables;
use quatrack::gains::table::BuiltInCascade;

pub(crate) use paper_limits::{LQR_E, LQR_F, LYAP_E, LYAP_F};

/// Of a table of the paper: the factor by which all channels of the command may be off at once, from its certificate, and
/// the longest lag of the motors, s, with which it is flown.
pub(crate) type Certified = (f32, f32);

/// Gains of a cascade with their certified range.
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

/// For each of [`crate::craft::KNOWN`]: the gains for stated lags, the shortest first, and those that are flown where none is
/// stated.
pub(crate) static CASCADES: [([Cascade; 3], Cascade); 3] = [
    (by_lag(&tables::CRAZYFLIE_2_1, [0.036, 0.08, 0.126]), unstated(&tables::CRAZYFLIE_2_1_DEFAULT)),
    (by_lag(&tables::UPGRADE_KIT, [0.036, 0.08, 0.126]), unstated(&tables::UPGRADE_KIT_DEFAULT)),
    (
        {
            let [short, known, long] = by_lag(&tables::BRUSHLESS, [0.032, 0.07, 0.126]);
            [short, known, Cascade { as_stated: false, ..long }]
        },
        unstated(&tables::BRUSHLESS_DEFAULT),
    ),
];

const fn by_lag([a, b, c]: &[BuiltInCascade; 3], [to_a_s, to_b_s, to_c_s]: [f32; 3]) -> [Cascade; 3] {
    [cascade(a, to_a_s), cascade(b, to_b_s), cascade(c, to_c_s)]
}

const fn unstated(table: &BuiltInCascade) -> Cascade {
    cascade(table, table.table.motor_lag_s)
}

const fn cascade(BuiltInCascade { table, .. }: &BuiltInCascade, stated_to_s: f32) -> Cascade {
    Cascade { gains: table.gains, lag_s: table.motor_lag_s, stated_to_s, as_stated: true }
}
