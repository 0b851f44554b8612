//! How disturbances are followed and fade: from the flights that were learned from.

use super::craft::{BETWEEN, HORIZON, Habits};
use super::starts::errors;
use crate::fit::Fit;
use crate::flight::Flight;

/// The habits that predict the learned flights best, one after the other from a grid, twice.
pub(super) fn habits(learned: &[Flight], fit: &Fit) -> Habits {
    let start = Habits { gain: 10.0, torque_s: 0.5, force_s: 1.0, share: 0.7, rest_per_s: 0.5 };
    let cost = |habits: &Habits| {
        let last = errors(learned, fit, habits, 4 * BETWEEN, true).0[HORIZON - 1];
        // Each over its usual size on small craft, so that none goes unseen.
        last.position_m / 0.06 + last.velocity_m_s / 0.35 + last.rotation_rad / 0.18 + last.body_rate_rad_s / 0.5
    };
    let mut best = (cost(&start), start);
    for _ in 0..2 {
        let tries = |best: Habits| {
            let gains = [2.0, 5.0, 10.0, 20.0, 40.0].map(|gain| Habits { gain, ..best });
            let torques = [0.1, 0.2, 0.4, 0.8, 2.0].map(|torque_s| Habits { torque_s, ..best });
            let forces = [0.2, 0.5, 1.5, 10.0].map(|force_s| Habits { force_s, ..best });
            let shares = [0.2, 0.35, 0.5, 0.65, 0.8, 1.0].map(|share| Habits { share, ..best });
            let rests = [0.0, 0.5, 1.0, 2.0, 3.0, 5.0, 8.0].map(|rest_per_s| Habits { rest_per_s, ..best });
            [gains.to_vec(), torques.to_vec(), forces.to_vec(), shares.to_vec(), rests.to_vec()]
        };
        for kind in 0..5 {
            for habits in &tries(best.1)[kind] {
                let cost = cost(habits);
                if cost < best.0 {
                    best = (cost, *habits);
                }
            }
        }
    }
    best.1
}
