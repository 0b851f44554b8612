//! From commands to thrusts: limits, the map by powers of command and voltage, and the strength of each motor in; the
//! thrusts that the motors go to out.

use nalgebra::Vector4;

use crate::plant::supply::ForceMap;

/// From commands to the thrusts that the motors go to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Converter {
    /// Limits of the commands, N.
    pub(super) limits_n: [f64; 2],
    pub(super) map: Option<ForceMap>,
    pub(super) strength: [f64; 4],
    pub(super) factor: f64,
    pub(super) factor_per_s: f64,
}

/// Commands that act, N; as the map has them, of a sound motor at full voltage, 1 or N.
#[derive(Clone, Copy, Debug)]
pub(super) struct Acting {
    pub(super) commands_n: Vector4<f64>,
    pub(super) mapped: Vector4<f64>,
}

impl Converter {
    /// Commands within their limits, with their powers taken.
    #[inline]
    pub(super) fn acting(&self, commands_n: &Vector4<f64>) -> Acting {
        Acting { commands_n: *commands_n, mapped: self.mapped(commands_n) }
    }

    #[inline(always)]
    pub(super) fn mapped(&self, commands_n: &Vector4<f64>) -> Vector4<f64> {
        let [least_n, most_n] = self.limits_n;
        commands_n.map(|command_n| {
            // By comparison: a NaN becomes the least, and f64::max costs five times as much.
            let command_n = if command_n > least_n { command_n } else { least_n };
            let command_n = if command_n < most_n { command_n } else { most_n };
            self.map.map_or(command_n, |map| map.share(command_n / most_n))
        })
    }

    /// Thrusts that the motors go to at a time and a voltage, N.
    #[inline(always)]
    pub(super) fn goals_n(&self, mapped: &Vector4<f64>, time_s: f64, voltage_v: f64) -> Vector4<f64> {
        let factor = (self.factor + self.factor_per_s * time_s).max(0.0);
        let all = factor * self.map.map_or(1.0, |map| map.most_n(voltage_v));
        Vector4::from_fn(|i, _| all * self.strength[i] * mapped[i])
    }
}
