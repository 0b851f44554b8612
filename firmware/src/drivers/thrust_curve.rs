//! From force to duty: the force of one propeller and the battery's voltage in, the part of the time that its motor is to
//! be switched on out.
//!
//! A brushed motor switched fast sees the battery's voltage times its duty, `v = d V`. Bitcraze measured its force on a
//! stand as a cubic, `f(v) = c0 + c1 v + c2 v^2 + c3 v^3`, and so `d = f^-1(force) / V` holds the force while the battery
//! drains. Source: crazyflie-firmware, `platform_defaults_cf2.h` (`VMOTOR2THRUST0` to `3`, `THRUST_MIN`, `THRUST_MAX`), and
//! "Keeping Thrust Consistent as the Battery Drains", bitcraze.io, October 2025.

use super::battery::CellVoltage;

/// Force of a propeller over the voltage at its motor, within the range that was measured; rises throughout it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThrustCurve {
    /// `c0` to `c3`, N, N/V, N/V^2, N/V^3.
    coefficients: [f32; 4],
    force_min_n: f32,
    force_max_n: f32,
    /// Voltage at the least force, V.
    voltage_min_v: f32,
    /// From there, voltage over force along the chord to the greatest force, V/N.
    chord_v_n: f32,
}

/// The range of forces of a motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Duty {
    /// Part of the time that the motor is on, 0 to 1.
    pub fraction: f32,
    /// Whether the battery has less than the force takes; the motor is then on all the time.
    pub is_short: bool,
}

impl Duty {
    /// A motor that does not turn.
    pub const OFF: Self = Self { fraction: 0.0, is_short: false };
}

impl ThrustCurve {
    /// Crazyflie 2.1 with the propellers of the 2.1+.
    pub const CRAZYFLIE_2_1: Self = Self {
        coefficients: [-0.024_765_38, 0.065_237_93, -0.026_792_505, 0.006_776_789],
        force_min_n: 0.012_817_578,
        force_max_n: 0.12,
        voltage_min_v: 0.773_923_4,
        chord_v_n: (3.079_913_7 - 0.773_923_4) / (0.12 - 0.012_817_578),
    };

    /// Crazyflie 2.1 with the thrust upgrade kit.
    pub const CRAZYFLIE_2_1_UPGRADE_KIT: Self = Self {
        coefficients: [0.006_728_127_6, 0.010_115_576, 0.010_263_198, 0.002_835_863_8],
        force_min_n: 0.019_226_368,
        force_max_n: 0.18,
        voltage_min_v: 0.679_366_3,
        chord_v_n: (2.816_550_5 - 0.679_366_3) / (0.18 - 0.019_226_368),
    };

    /// Steps of Newton's method: from the chord they end within a microvolt on both curves.
    const NEWTON_STEPS: u32 = 3;

    /// The least force of a motor that turns, N.
    pub const fn force_min_n(&self) -> f32 {
        self.force_min_n
    }

    /// The greatest force that a motor is asked for, N.
    pub const fn force_max_n(&self) -> f32 {
        self.force_max_n
    }

    /// Force at a voltage of the motor, N.
    #[inline]
    pub fn force_n(&self, voltage_v: f32) -> f32 {
        let [c0, c1, c2, c3] = self.coefficients;
        c0 + voltage_v * (c1 + voltage_v * (c2 + voltage_v * c3))
    }

    /// Voltage at the motor for a force within the range, V.
    #[inline]
    fn voltage_v(&self, force_n: f32) -> f32 {
        let [_, c1, c2, c3] = self.coefficients;
        let mut voltage_v = self.voltage_min_v + (force_n - self.force_min_n) * self.chord_v_n;
        for _ in 0..Self::NEWTON_STEPS {
            let slope_n_v = c1 + voltage_v * (2.0 * c2 + voltage_v * (3.0 * c3));
            voltage_v -= (self.force_n(voltage_v) - force_n) / slope_n_v;
        }
        voltage_v
    }

    /// The duty for a force. Nothing for a force that is not finite; off at and below zero; in between at least that of the
    /// least force, at which a motor idles; at most that of the greatest.
    #[inline]
    pub fn duty(&self, force_n: f32, battery: CellVoltage) -> Option<Duty> {
        if !force_n.is_finite() {
            return None;
        }
        if force_n <= 0.0 {
            return Some(Duty::OFF);
        }
        let in_range = force_n.max(self.force_min_n).min(self.force_max_n);
        let fraction = self.voltage_v(in_range) / battery.volts();
        Some(Duty { fraction: fraction.min(1.0), is_short: fraction > 1.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CURVES: [ThrustCurve; 2] = [ThrustCurve::CRAZYFLIE_2_1, ThrustCurve::CRAZYFLIE_2_1_UPGRADE_KIT];

    fn forces(curve: &ThrustCurve) -> impl Iterator<Item = f32> {
        let (min, range) = (curve.force_min_n, curve.force_max_n - curve.force_min_n);
        (0..=1000_u16).map(move |step| min + range * f32::from(step) / 1000.0)
    }

    #[test]
    fn the_duty_at_the_battery_gives_the_force() {
        for curve in CURVES {
            for volts in [3.2_f32, 3.7, 4.2] {
                let battery = CellVoltage::new(volts).unwrap();
                for force in forces(&curve) {
                    let duty = curve.duty(force, battery).unwrap();
                    // By f64, which shares no rounding: a microvolt by Newton, some roundings of 4 V by f32, at 0.1 N/V.
                    let (v, c) = (f64::from(duty.fraction) * f64::from(volts), curve.coefficients.map(f64::from));
                    let found = c[0] + v * (c[1] + v * (c[2] + v * c[3]));
                    assert!((found - f64::from(force)).abs() < 3e-7, "{force} N at {volts} V: {found} N");
                    assert!(!duty.is_short);
                }
            }
        }
    }

    #[test]
    fn the_curve_rises() {
        for curve in CURVES {
            let duties = || forces(&curve).map(|force| curve.duty(force, CellVoltage::FULL).unwrap().fraction);
            assert!(duties().zip(duties().skip(1)).all(|(less, more)| less < more));
        }
    }

    /// Roots by an independent solver (companion matrix, f64): hover of the bare craft and of the kit's.
    #[test]
    fn hover_takes_the_voltage_of_an_independent_solver() {
        let [bare, kit] = CURVES;
        for (curve, mass_kg, volts) in [(bare, 0.029_f32, 2.399_242_9), (kit, 0.0325, 1.865_242_6)] {
            let duty = curve.duty(mass_kg * 9.81 / 4.0, CellVoltage::NOMINAL).unwrap();
            assert!((duty.fraction * 3.7 - volts).abs() < 2e-6, "{} V", duty.fraction * 3.7);
        }
    }

    #[test]
    fn forces_outside_the_range_are_off_idle_or_the_greatest() {
        let curve = ThrustCurve::CRAZYFLIE_2_1;
        let duty = |force| curve.duty(force, CellVoltage::NOMINAL);
        assert_eq!(duty(0.0), Some(Duty::OFF));
        assert_eq!(duty(-1.0), Some(Duty::OFF));
        assert_eq!(duty(1e-6), duty(curve.force_min_n), "a motor that is to turn idles");
        assert_eq!(duty(1e6), duty(curve.force_max_n));
        assert!([f32::NAN, f32::INFINITY, f32::NEG_INFINITY].into_iter().all(|force| duty(force).is_none()));
    }

    #[test]
    fn an_empty_battery_is_used_whole_and_said_to_be_short() {
        let curve = ThrustCurve::CRAZYFLIE_2_1;
        // The greatest force takes 3.08 V.
        let duty = curve.duty(0.12, CellVoltage::new(3.0).unwrap()).unwrap();
        assert_eq!(duty, Duty { fraction: 1.0, is_short: true });
    }
}
