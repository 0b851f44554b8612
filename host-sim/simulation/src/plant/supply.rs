//! From a command to the force that a motor gives for it: a map by powers of command and voltage, and the battery
//! behind it.

use quatrack_design::vehicle::{BatteryFigures, Vehicle};

/// Ten equal shares of the charge lie between the voltages of a battery's curve.
pub const CURVE_POINTS: usize = 11;

/// `F = c u^p (V / V_0)^q`, with the command `u` from 0 to 1 as the share of the most that the law believes in. The
/// most that a motor gives is F at u = 1: it falls with the voltage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceMap {
    /// Force at full command and the voltage `V_0`, N.
    pub full_n: f64,
    /// The power p of the command.
    pub command_power: f64,
    /// The power q of the voltage.
    pub voltage_power: f64,
    /// The voltage `V_0`, V.
    pub reference_v: f64,
}

impl ForceMap {
    /// Force at full command, N.
    pub fn most_n(&self, voltage_v: f64) -> f64 {
        self.full_n * (voltage_v / self.reference_v).max(0.0).powf(self.voltage_power)
    }

    /// Share of that at a command from 0 to 1.
    pub fn share(&self, command: f64) -> f64 {
        command.clamp(0.0, 1.0).powf(self.command_power)
    }
}

/// A battery: a voltage that falls with the charge that is taken and with the current.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Battery {
    /// Its charge, A s.
    pub capacity_a_s: f64,
    /// Open-circuit voltage from empty to full, at equal shares of the charge, V.
    pub open_circuit_v: [f64; CURVE_POINTS],
    /// Its resistance and that of its leads, ohm.
    pub resistance_ohm: f64,
    /// Current over the sum of the thrusts to the power of 3/2, A/N^1.5: the power that a rotor at rest in the air needs,
    /// at one voltage.
    pub current_a_per_n15: f64,
}

impl Battery {
    /// The vehicle's, which takes its charge in the time that it hovers.
    pub fn of(figures: &BatteryFigures, vehicle: &Vehicle) -> Self {
        let (capacity_a_s, hover_n) = (3600.0 * figures.capacity_a_h, vehicle.hover_thrust_n());
        Self {
            capacity_a_s,
            open_circuit_v: figures.open_circuit_v,
            resistance_ohm: figures.resistance_ohm,
            current_a_per_n15: capacity_a_s / figures.hover_s / (4.0 * hover_n * hover_n.sqrt()),
        }
    }

    /// Open-circuit voltage at a charge from 0 to 1, V.
    pub fn open_circuit_v(&self, charge: f64) -> f64 {
        let place = charge.clamp(0.0, 1.0) * (CURVE_POINTS - 1) as f64;
        let below = (place as usize).min(CURVE_POINTS - 2);
        let [low, high] = [self.open_circuit_v[below], self.open_circuit_v[below + 1]];
        low + (high - low) * (place - below as f64)
    }

    /// Current at thrusts, N, A.
    pub fn current_a(&self, thrusts_n: &nalgebra::Vector4<f64>) -> f64 {
        self.current_a_per_n15 * thrusts_n.iter().map(|f| f.max(0.0) * f.max(0.0).sqrt()).sum::<f64>()
    }
}

/// The source of the motors' voltage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Supply {
    /// Always the same, V.
    Constant(f64),
    /// A battery with a charge from 0 to 1 at the start.
    Battery {
        /// The battery.
        battery: Battery,
        /// Its charge at the start.
        charge: f64,
    },
}

impl Supply {
    /// Voltage at the motors while they give thrusts, V.
    #[inline]
    pub fn voltage_v(&self, thrusts_n: &nalgebra::Vector4<f64>) -> f64 {
        match self {
            Self::Constant(voltage_v) => *voltage_v,
            Self::Battery { battery, charge } => {
                (battery.open_circuit_v(*charge) - battery.resistance_ohm * battery.current_a(thrusts_n)).max(0.0)
            }
        }
    }

    /// Takes the charge of a time.
    #[inline]
    pub(super) fn drain(&mut self, thrusts_n: &nalgebra::Vector4<f64>, duration_s: f64) {
        if let Self::Battery { battery, charge } = self {
            *charge = (*charge - battery.current_a(thrusts_n) * duration_s / battery.capacity_a_s).max(0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector4;

    use super::*;

    fn battery() -> Battery {
        Battery {
            capacity_a_s: 900.0,
            open_circuit_v: [3.0, 3.78, 3.83, 3.87, 3.89, 3.92, 3.96, 4.0, 4.04, 4.1, 4.2],
            resistance_ohm: 0.24,
            current_a_per_n15: 28.0,
        }
    }

    #[test]
    fn the_brushed_map_has_the_published_top() {
        // arXiv 2603.09908: 0.124 (u V/4)^2; at 3.3 and 3.5 V the most is 0.084 and 0.095 N.
        let map = ForceMap { full_n: 0.124, command_power: 2.0, voltage_power: 2.0, reference_v: 4.0 };
        for (voltage_v, most_n) in [(3.3, 0.0844), (3.5, 0.0949), (4.0, 0.124)] {
            assert!((map.most_n(voltage_v) - most_n).abs() < 5e-5, "{voltage_v} V: {}", map.most_n(voltage_v));
        }
        assert!((map.share(0.5) - 0.25).abs() < 1e-15 && map.share(2.0) == 1.0 && map.share(-1.0) == 0.0);
    }

    #[test]
    fn the_voltage_falls_with_current_and_with_charge() {
        let hover = Vector4::repeat(0.0711);
        let mut supply = Supply::Battery { battery: battery(), charge: 0.55 };
        // Between 3.92 and 3.96 V, less 0.24 ohm times 28 * 4 * 0.0711^1.5 = 2.1234 A.
        assert!((supply.voltage_v(&hover) - (3.94 - 0.24 * 2.1234)).abs() < 1e-4, "{}", supply.voltage_v(&hover));
        assert_eq!(supply.voltage_v(&Vector4::zeros()), 3.94);
        supply.drain(&hover, 100.0);
        let Supply::Battery { charge, .. } = supply else { panic!("a battery stays one") };
        assert!((charge - (0.55 - 212.34 / 900.0)).abs() < 1e-4, "{charge}");
        supply.drain(&hover, 1e6);
        assert_eq!(supply.voltage_v(&Vector4::zeros()), 3.0);
    }
}
