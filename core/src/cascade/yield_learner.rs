//! The motors' force as a share of the commanded one: real ones give 11 to 34 % less (arXiv 2603.09908, 2512.14450),
//! another share with each battery. The thrust shows it: at hover, thrust and the error along it make up gravity. The
//! torques are asked for by as much more.
//!
//! A craft that is heavier than told looks the same. Its inertia is larger by about as much, so that its torques are right, too.

use super::bounds::between;

/// Bounds of the share.
const SHARES: [f32; 2] = [0.6, 1.3];

/// How fast it is followed, 1/s: slower by far than the loops that it is a factor of.
const RATE_PER_S: f32 = 0.5;

/// Least thrust over mass from which a share is told, m/s^2.
const THRUST_LEAST_M_S2: f32 = 5.0;

/// Force of the motors over the force they are told.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct MotorYield {
    pub(super) share: f32,
    pub(super) inverse: f32,
}

impl MotorYield {
    /// As told.
    pub(super) const TOLD: Self = Self { share: 1.0, inverse: 1.0 };

    /// Moves on by a period with a thrust over mass as it was sent and its observed error, m/s^2.
    #[inline(always)]
    pub(super) fn step(&mut self, thrust: f32, error: f32, period_s: f32) {
        // Of a NaN nothing is learned.
        let flies = thrust >= THRUST_LEAST_M_S2;
        if !flies {
            return;
        }
        let seen = (thrust + error) / thrust;
        let share = self.share + RATE_PER_S * period_s * (seen - self.share);
        let [least, most] = SHARES;
        let share = between(share, least, most);
        *self = Self { share, inverse: 1.0 / share };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motors_that_give_less_are_found_within_bounds() {
        for (share, found) in [(0.8_f32, 0.8_f32), (1.0, 1.0), (0.3, 0.6), (1.5, 1.3)] {
            let mut seen = MotorYield::TOLD;
            for _ in 0..5000 {
                seen.step(9.81 / share, 9.81 - 9.81 / share, 0.002);
            }
            // 10 s: five time constants leave 1 % of the difference.
            assert!((seen.share - found).abs() < 0.011 * (1.0 - found).abs() + 1e-5, "{} {found}", seen.share);
            assert!((seen.share * seen.inverse - 1.0).abs() < 1e-6);
        }
        let mut seen = MotorYield::TOLD;
        seen.step(0.0, 1.0, 0.002);
        assert_eq!(seen, MotorYield::TOLD);
    }
}
