//! The range of the motors: commands in; each cut to the range by itself, and whether any was, out.

use crate::airframe::{Airframe, AirframeFigures};
use crate::mixer::MotorLimited;
use crate::motor_lag::MotorForces;

/// The bit of [`MotorLimited::motors`].
const MOTORS: u16 = 8;

/// The forces that a motor can give, not below zero.
///
/// By integers: floats of one sign stand in the order of their bits, and those below zero or not finite come after all
/// others. That takes half the instructions of two comparisons by the FPU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ForceRange {
    /// Bits of the least force, and by how much the bits of the most exceed them.
    least: u32,
    span: u32,
    min_n: f32,
    max_n: f32,
}

impl ForceRange {
    pub(super) const fn of(airframe: &Airframe) -> Self {
        let AirframeFigures { force_min_n: min_n, force_max_n: max_n, .. } = *airframe.figures();
        Self { least: min_n.to_bits(), span: max_n.to_bits() - min_n.to_bits(), min_n, max_n }
    }

    /// Commands cut to the range one by one and whether any was; nothing where one is not finite.
    #[inline(always)]
    pub(super) fn saturate(&self, commands: &MotorForces) -> Option<(MotorForces, MotorLimited)> {
        let is_within = |command: f32| command.to_bits().wrapping_sub(self.least) <= self.span;
        let cut = |command: f32| {
            // Signed: negative forces come first.
            let order = command.to_bits() as i32;
            let at_least = if order < self.min_n.to_bits() as i32 { self.min_n } else { command };
            if order > self.max_n.to_bits() as i32 { self.max_n } else { at_least }
        };
        let [u1, u2, u3, u4] = *commands;
        // NaN and infinities stay visible in a sum.
        let is_finite = || ((u1 + u2) + (u3 + u4)).to_bits() << 1 < f32::INFINITY.to_bits() << 1;
        let limited = MotorLimited::from_bits(MOTORS);
        // Each way out leaves alone the motors that have been looked at: the later a motor is the first to be cut, the
        // fewer are left.
        if !is_within(u1) {
            if is_finite() { Some(([cut(u1), cut(u2), cut(u3), cut(u4)], limited)) } else { None }
        } else if !is_within(u2) {
            if is_finite() { Some(([u1, cut(u2), cut(u3), cut(u4)], limited)) } else { None }
        } else if !is_within(u3) {
            if is_finite() { Some(([u1, u2, cut(u3), cut(u4)], limited)) } else { None }
        } else if !is_within(u4) {
            if is_finite() { Some(([u1, u2, u3, cut(u4)], limited)) } else { None }
        } else {
            Some((*commands, MotorLimited::NOTHING))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_force_is_cut_to_its_range_whichever_others_are() {
        let range = ForceRange::of(&Airframe::CRAZYFLIE_2_1);
        let (min, max) = (range.min_n, range.max_n);
        let values = [-0.3, -0.0, 0.5 * min, min, 0.5 * (min + max), max, 2.0 * max];
        for case in 0..values.len().pow(4) {
            let asked = [1, 7, 49, 343].map(|place| values[case / place % values.len()]);
            let cut = asked.map(|force| force.max(min).min(max));
            assert_eq!(range.saturate(&asked), Some((cut, MotorLimited::from_bits(if cut == asked { 0 } else { 8 }))));
        }
    }

    #[test]
    fn a_force_that_is_no_number_is_refused_wherever_it_is() {
        let range = ForceRange::of(&Airframe::CRAZYFLIE_2_1);
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for motor in 0..4 {
                for others in [0.05, 0.5, -0.5] {
                    let mut asked = [others; 4];
                    asked[motor] = value;
                    assert_eq!(range.saturate(&asked), None, "{asked:?}");
                }
            }
        }
    }

    #[test]
    fn large_forces_are_cut_like_any_others() {
        // Each product of two of them is beyond f32, no sum is.
        let range = ForceRange::of(&Airframe::CRAZYFLIE_2_1);
        let cut = Some(([range.max_n; 4], MotorLimited::from_bits(8)));
        assert_eq!(range.saturate(&[1e30; 4]), cut);
    }
}
