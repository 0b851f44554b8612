//! Four motors' commands from parts, within the motors' range: attitude first, then room for some yaw, then thrust, then yaw.
//!
//! Motors that are cut one by one leave no torque, and the craft tumbles. Roll and pitch are scaled, together, only where they alone
//! exceed the range; the thrust moves to make room for them and for three tenths of the yaw asked; yaw takes the room
//! that is left.

use super::bounds::{between, larger, smaller, within};
use crate::airframe::Airframe;
use crate::mixer::{MotorLimited, Parts};

/// Share of the yaw for which the thrust makes room.
const YAW_SHARE: f32 = 0.3;

/// The range of each motor, N.
#[derive(Clone, Copy, Debug)]
pub(super) struct Allocation {
    least_n: f32,
    most_n: f32,
}

impl Allocation {
    pub(super) const fn of(airframe: &Airframe) -> Self {
        let figures = airframe.figures();
        Self { least_n: figures.force_min_n, most_n: figures.force_max_n }
    }

    /// Parts within the range and the limits that cut them; nothing where one is not finite.
    #[inline(always)]
    pub(super) fn allocate(&self, asked: Parts) -> Option<(Parts, MotorLimited)> {
        let (low, high) = (asked.thrust - self.least_n, self.most_n - asked.thrust);
        let swing = asked.roll.abs() + asked.pitch.abs() + asked.yaw.abs();
        // Fails for NaN. Some motor always has the whole swing above it or below.
        if swing <= smaller(low, high) { Some((asked, MotorLimited::NOTHING)) } else { self.by_priority(asked) }
    }

    #[inline(never)]
    fn by_priority(&self, asked: Parts) -> Option<(Parts, MotorLimited)> {
        let Parts { thrust, mut roll, mut pitch, yaw } = asked;
        let mut swing = roll.abs() + pitch.abs();
        if !(thrust.abs() + swing + yaw.abs()).is_finite() {
            return None;
        }
        let (least, most) = (self.least_n, self.most_n);
        let half_range = 0.5 * (most - least);
        let mut limited = MotorLimited::NOTHING;
        if swing > half_range {
            let scale = half_range / swing;
            (roll, pitch, swing) = (roll * scale, pitch * scale, half_range);
            limited = limited.with_attitude();
        }
        // Motors 1 and 3 lose by yaw as much as 2 and 4 gain.
        let (along, across) = ((roll + pitch).abs(), (pitch - roll).abs());
        // No more than the yaw's share that the range has room for beside both.
        let room = half_range - swing;
        let share = within(YAW_SHARE * yaw, room);
        let (upper, lower) = (larger(along - share, across + share), larger(along + share, across - share));
        let lifted = between(thrust, least + lower, most - upper);
        if lifted != thrust {
            limited = limited.with_thrust();
        }
        let (above, below) = (most - lifted, lifted - least);
        let up = smaller(above - across, below - along);
        let down = smaller(above - along, below - across);
        let kept = between(yaw, -positive(down), positive(up));
        if kept != yaw {
            limited = limited.with_yaw();
        }
        Some((Parts { thrust: lifted, roll, pitch, yaw: kept }, limited))
    }

    /// A motor's force within its range, beside which roundings may leave it.
    #[inline(always)]
    pub(super) fn cut(&self, force: f32) -> f32 {
        between(force, self.least_n, self.most_n)
    }
}

#[inline(always)]
fn positive(value: f32) -> f32 {
    if value > 0.0 { value } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CRAFT: Airframe = Airframe::CRAZYFLIE_2_1;

    fn allocated(thrust: f32, roll: f32, pitch: f32, yaw: f32) -> (Parts, MotorLimited) {
        Allocation::of(&CRAFT).allocate(Parts { thrust, roll, pitch, yaw }).unwrap()
    }

    #[test]
    fn every_motor_is_within_its_range_and_attitude_keeps_its_direction() {
        let (least, most) = (CRAFT.figures().force_min_n, CRAFT.figures().force_max_n);
        for thrust in [-0.1, 0.0, 0.03, 0.07, 0.11, 0.2] {
            for roll in [-0.2, -0.03, 0.0, 0.04] {
                for pitch in [-0.05, 0.0, 0.02, 0.3] {
                    for yaw in [-0.1, -0.02, 0.0, 0.01, 0.2] {
                        let (found, limited) = allocated(thrust, roll, pitch, yaw);
                        for force in found.forces() {
                            // Roundings of sums of four.
                            assert!(force >= least - 1e-7 && force <= most + 1e-7, "{found:?}");
                        }
                        assert!((found.roll * pitch - found.pitch * roll).abs() < 1e-8);
                        assert_eq!(limited.attitude(), roll.abs() + pitch.abs() > 0.5 * (most - least));
                        assert!(found.yaw * yaw >= 0.0 && found.yaw.abs() <= yaw.abs());
                    }
                }
            }
        }
    }

    #[test]
    fn thrust_gives_way_to_attitude_and_to_some_yaw() {
        let (found, limited) = allocated(0.2, 0.02, 0.0, 0.01);
        assert!((found.thrust - (0.12 - 0.02 - 0.003)).abs() < 1e-7, "{found:?}");
        // Room beside the three tenths is there where roll pulls the other way: none here.
        assert!((found.yaw - 0.003).abs() < 1e-7 && limited.thrust() && limited.yaw() && !limited.attitude());
        let (untouched, limited) = allocated(0.07, 0.01, -0.01, 0.01);
        assert_eq!((untouched.yaw, limited), (0.01, MotorLimited::NOTHING));
    }

    #[test]
    fn numbers_that_are_not_finite_are_refused() {
        let allocation = Allocation::of(&CRAFT);
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for place in 0..4 {
                let mut values = [0.07, 0.0, 0.0, 0.0];
                values[place] = bad;
                let [thrust, roll, pitch, yaw] = values;
                assert!(allocation.allocate(Parts { thrust, roll, pitch, yaw }).is_none());
            }
        }
    }
}
