//! The mass, inertia and motors of a craft in; how four motor forces mix to thrust and torque, and back, out.
//!
//! Four motors in an X, seen from above with the nose (body x) up and body y to the left:
//!
//! | motor | place | at (x, y) | propeller turns | its drag turns the craft by |
//! |---|---|---|---|---|
//! | M1 | front right | (a, -a) | anticlockwise | -c f |
//! | M2 | rear right | (-a, -a) | clockwise | +c f |
//! | M3 | rear left | (-a, a) | anticlockwise | -c f |
//! | M4 | front left | (a, a) | clockwise | +c f |
//!
//! Each pushes along body z with its force f. So thrust and torques are `F = f1 + f2 + f3 + f4`,
//! `tx = a (-f1 - f2 + f3 + f4)`, `ty = a (-f1 + f2 + f3 - f4)`, `tz = c (-f1 + f2 - f3 + f4)`, and the four sign patterns
//! are orthogonal: the inverse is the transposed one over four. Order and signs are those of the Crazyflie's firmware.

mod error;

use nalgebra::Vector3;

pub use self::error::{AirframeError, AirframeFigure};
use crate::clock::Rate;
use crate::command::Limits;
use crate::flatness::GRAVITY_M_S2;
use crate::motor_lag::MotorLag;

/// The measured figures of a craft; checked by [`Airframe::new`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct AirframeFigures {
    /// Mass ready to fly, kg.
    pub mass_kg: f32,
    /// Principal moments of inertia about body x, y, z, kg m^2.
    pub inertia_kg_m2: [f32; 3],
    /// The lever a: distance of each motor from body x and from body y, m; the arm over the root of two.
    pub lever_arm_m: f32,
    /// The ratio c: torque about body z over the force of a motor, m.
    pub torque_per_thrust_m: f32,
    /// Least force of a turning motor, N.
    pub force_min_n: f32,
    /// Most force of a motor, N.
    pub force_max_n: f32,
    /// Time constant of the first-order lag from commanded to actual force, s: that which control reckons with.
    pub motor_lag_s: f32,
}

/// A craft whose figures have been checked, with the factors that the mixing takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Airframe {
    figures: AirframeFigures,
    pub(crate) mixing: Mixing,
    /// How far a command is to be ahead of the force, s.
    pub(crate) lead_s: f32,
}

/// Motor forces per unit of thrust and torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mixing {
    /// `m / 4`: force per motor over thrust in m/s^2, kg.
    pub(crate) quarter_mass_kg: f32,
    /// `1 / (4 a)`, `1 / (4 a)`, `1 / (4 c)`: force per motor over torque, 1/m.
    pub(crate) per_torque: [f32; 3],
    /// Inertia over four levers: force per motor over angular acceleration, N s^2.
    pub(crate) inertia: [f32; 3],
    /// `(Iz - Iy, Ix - Iz, Iy - Ix)` over four levers: force per motor over `(q r, p r, p q)`, N s^2.
    pub(crate) gyroscopic: [f32; 3],
}

impl Airframe {
    /// Crazyflie 2.1. Its vehicle file, `gains/vehicles/crazyflie-2.1.toml`, names the sources of these figures; those
    /// of the others do so, too.
    pub const CRAZYFLIE_2_1: Self = Self::constant(AirframeFigures {
        mass_kg: 0.029,
        inertia_kg_m2: [16.571_71e-6, 16.655_602e-6, 29.261_652e-6],
        lever_arm_m: 0.032_526_91,
        torque_per_thrust_m: 0.006_992_894_7,
        force_min_n: 0.012_817_578,
        force_max_n: 0.12,
        motor_lag_s: 0.126,
    });

    /// Crazyflie 2.1 with the thrust upgrade kit.
    pub const CRAZYFLIE_2_1_UPGRADE_KIT: Self = Self::constant(AirframeFigures {
        mass_kg: 0.0325,
        inertia_kg_m2: [20.275e-6, 20.359e-6, 36.668e-6],
        lever_arm_m: 0.032_526_91,
        torque_per_thrust_m: 0.005_164_862_6,
        force_min_n: 0.019_226_369,
        force_max_n: 0.18,
        motor_lag_s: 0.09,
    });

    /// Crazyflie 2.1 Brushless.
    pub const CRAZYFLIE_2_1_BRUSHLESS: Self = Self::constant(AirframeFigures {
        mass_kg: 0.0393,
        inertia_kg_m2: [33.0e-6, 36.0e-6, 59.0e-6],
        lever_arm_m: 0.035_355_34,
        torque_per_thrust_m: 0.005_692_788_4,
        force_min_n: 0.021_362_63,
        force_max_n: 0.2,
        motor_lag_s: 0.05,
    });

    /// Checks the figures of a craft.
    ///
    /// # Errors
    /// [`AirframeError`] names the figure.
    pub const fn new(figures: AirframeFigures) -> Result<Self, AirframeError> {
        let AirframeFigures { mass_kg, inertia_kg_m2, lever_arm_m, torque_per_thrust_m, motor_lag_s, .. } = figures;
        let [ix, iy, iz] = inertia_kg_m2;
        // Scaled so that one range serves all.
        let mut rest: &[(AirframeFigure, f32, f32)] = &[
            (AirframeFigure::Mass, mass_kg, 1.0),
            (AirframeFigure::Inertia, ix, 1e3),
            (AirframeFigure::Inertia, iy, 1e3),
            (AirframeFigure::Inertia, iz, 1e3),
            (AirframeFigure::LeverArm, lever_arm_m, 1.0),
            (AirframeFigure::TorquePerThrust, torque_per_thrust_m, 1.0),
            (AirframeFigure::MotorLag, motor_lag_s, 1.0),
        ];
        while let Some(((figure, value, scale), after)) = rest.split_first() {
            if !(*value * *scale >= 1e-6 && *value <= 1e3) {
                return Err(AirframeError::OutOfRange { figure: *figure, value: *value });
            }
            rest = after;
        }
        let mut rest: &[(f32, f32)] = &[(ix, iy + iz), (iy, iz + ix), (iz, ix + iy)];
        while let Some(((largest_kg_m2, others_kg_m2), after)) = rest.split_first() {
            if *largest_kg_m2 > *others_kg_m2 {
                return Err(AirframeError::Inertia { largest_kg_m2: *largest_kg_m2, others_kg_m2: *others_kg_m2 });
            }
            rest = after;
        }
        let (min_n, max_n, hover_n) = (figures.force_min_n, figures.force_max_n, 0.25 * mass_kg * GRAVITY_M_S2);
        if !(min_n >= 0.0 && min_n < hover_n && hover_n < max_n && max_n <= 1e3) {
            return Err(AirframeError::Force { min_n, max_n, hover_n });
        }
        let (lever, yaw) = (0.25 / lever_arm_m, 0.25 / torque_per_thrust_m);
        let mixing = Mixing {
            quarter_mass_kg: 0.25 * mass_kg,
            per_torque: [lever, lever, yaw],
            inertia: [ix * lever, iy * lever, iz * yaw],
            gyroscopic: [(iz - iy) * lever, (ix - iz) * lever, (iy - ix) * yaw],
        };
        Ok(Self { figures, mixing, lead_s: motor_lag_s })
    }

    /// The same craft with motors that answer faster or slower: for a gain that was designed for another lag.
    ///
    /// # Errors
    /// [`AirframeError::OutOfRange`].
    pub const fn with_motor_lag(&self, motor_lag_s: f32) -> Result<Self, AirframeError> {
        Self::new(AirframeFigures { motor_lag_s, ..self.figures })
    }

    /// The same craft under commands that are held over the period of `rate`: they take effect half a period late, on
    /// average, and references made for it are ahead by as much.
    pub const fn commanded_at(&self, rate: Rate) -> Self {
        Self { lead_s: self.figures.motor_lag_s + 0.5 / rate.hz() as f32, ..*self }
    }

    /// Both, for a lag that is known to be one.
    pub(crate) const fn reckoning_with(&self, lag: &MotorLag) -> Self {
        let figures = AirframeFigures { motor_lag_s: lag.lag_s(), ..self.figures };
        Self { figures, lead_s: lag.lag_s() + 0.5 * lag.period_s(), ..*self }
    }

    const fn constant(figures: AirframeFigures) -> Self {
        match Self::new(figures) {
            Ok(airframe) => airframe,
            Err(_) => panic!("the figures in the source are no craft"),
        }
    }

    /// The figures that it was made from.
    pub const fn figures(&self) -> &AirframeFigures {
        &self.figures
    }

    /// A quarter of the weight: the force of each motor at hover, N.
    pub const fn hover_force_n(&self) -> f32 {
        self.mixing.quarter_mass_kg * GRAVITY_M_S2
    }
}

impl Limits {
    /// The range of the four motors of a craft, within body rates of so many rad/s; a rate that is not positive binds
    /// nothing.
    pub fn of(airframe: &Airframe, body_rates_max_rad_s: Vector3<f32>) -> Self {
        let figures = airframe.figures();
        let per_mass = 4.0 / figures.mass_kg;
        let (min, max) = (figures.force_min_n * per_mass, figures.force_max_n * per_mass);
        let any_rate = Self::NONE.body_rates_max_rad_s();
        Self::new(min, max, body_rates_max_rad_s).or_else(|_| Self::new(min, max, any_rate)).unwrap_or(Self::NONE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIGURES: AirframeFigures = Airframe::CRAZYFLIE_2_1.figures;

    #[test]
    fn a_wrong_figure_is_named() {
        let grams = AirframeFigures { mass_kg: 29e3, ..FIGURES };
        let refused = Err(AirframeError::OutOfRange { figure: AirframeFigure::Mass, value: 29e3 });
        assert_eq!(Airframe::new(grams), refused);
        let no_lag = Airframe::new(AirframeFigures { motor_lag_s: f32::NAN, ..FIGURES });
        assert!(matches!(no_lag, Err(AirframeError::OutOfRange { figure: AirframeFigure::MotorLag, .. })));
        let rod = Airframe::new(AirframeFigures { inertia_kg_m2: [1e-5, 1e-5, 3e-5], ..FIGURES });
        assert_eq!(rod, Err(AirframeError::Inertia { largest_kg_m2: 3e-5, others_kg_m2: 2e-5 }));
    }

    #[test]
    fn motors_that_cannot_hold_the_weight_are_refused() {
        for (min_n, max_n) in [(0.0, 0.07), (0.08, 0.12), (-0.01, 0.12), (0.12, 0.01), (0.0, f32::INFINITY)] {
            let refused = Airframe::new(AirframeFigures { force_min_n: min_n, force_max_n: max_n, ..FIGURES });
            assert!(matches!(refused, Err(AirframeError::Force { .. })), "{min_n} to {max_n}");
        }
    }
}
