//! A controller's memory from one step to the next: predicted motor forces, integral, states of observers.

use nalgebra::Vector3;

use crate::airframe::Airframe;
#[cfg(feature = "cascade")]
use crate::cascade::{Cascade, CascadeMemory};
#[cfg(feature = "cascade")]
use crate::mixer::MotorLimited;
use crate::motor_lag::MotorForces;
#[cfg(feature = "cascade")]
use crate::supervisor::Levelled;

/// The memory of a flight: one record for every law, so that another law can take over.
///
/// The forces that the motors should have by now are kept up whenever motor forces come of a step; they are not measured. The
/// integral of the position error is moved on by the laws that have one, and is cleared where a law without one hands over
/// ([`super::Handover`]).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Memory {
    /// Forces that the motors should have, N.
    pub(crate) forces_n: MotorForces,
    /// Integral of the position error in the world frame, m s.
    pub(crate) integral_m_s: Vector3<f32>,
    /// Of the cascade.
    #[cfg(feature = "cascade")]
    pub(crate) cascade: CascadeMemory,
}

impl Memory {
    /// Motors at some forces (N), and nothing integrated. Nothing where a force is not finite.
    pub fn new(forces_n: MotorForces) -> Option<Self> {
        let finite = forces_n.iter().all(|force| force.is_finite());
        finite.then_some(Self { forces_n, ..Self::at_rest() })
    }

    /// Motors that do not turn: before a take-off, and where there are no motors.
    pub const fn at_rest() -> Self {
        Self {
            forces_n: [0.0; 4],
            integral_m_s: Vector3::new(0.0, 0.0, 0.0),
            #[cfg(feature = "cascade")]
            cascade: CascadeMemory::STANDING,
        }
    }

    /// A craft that hovers: for taking over in flight from somebody of whose motors nothing is known.
    pub const fn hovering(airframe: &Airframe) -> Self {
        let forces_n = [airframe.hover_force_n(); 4];
        Self {
            forces_n,
            #[cfg(feature = "cascade")]
            cascade: CascadeMemory::IN_FLIGHT,
            ..Self::at_rest()
        }
    }

    /// Takes the motors to be at the forces of hover, where nobody has kept their commands in flight.
    #[inline(never)]
    pub fn assume_hovering(&mut self, airframe: &Airframe) {
        self.forces_n = [airframe.hover_force_n(); 4];
        #[cfg(feature = "cascade")]
        self.cascade.begin_in_flight();
    }

    /// Motors that are switched off run down: this share of their forces is left.
    pub fn run_down(&mut self, share: f32) {
        let [a, b, c, d] = self.forces_n;
        self.forces_n = [a * share, b * share, c * share, d * share];
        #[cfg(feature = "cascade")]
        self.cascade.motors_off();
    }

    /// Forces that the motors should have, N.
    pub const fn forces_n(&self) -> MotorForces {
        self.forces_n
    }

    /// Integral of the position error in the world frame, m s.
    pub const fn integral_m_s(&self) -> Vector3<f32> {
        self.integral_m_s
    }

    #[cfg(feature = "cascade")]
    /// The cascade's memory.
    pub const fn cascade(&self) -> &CascadeMemory {
        &self.cascade
    }

    #[cfg(feature = "cascade")]
    /// The cascade takes over in flight from a law that does not keep its memory; the motors' forces stay.
    pub fn begin_cascade_in_flight(&mut self) {
        self.cascade.begin_in_flight();
    }

    #[cfg(feature = "cascade")]
    /// Flies an attitude alone: forces, N, and the limits that cut them; nothing where an input is not finite.
    pub fn level(&mut self, cascade: &Cascade, levelled: &Levelled) -> Option<(MotorForces, MotorLimited)> {
        let Levelled { attitude, body_rates_rad_s, acceleration_m_s2 } = levelled;
        cascade.level(&mut self.cascade, &mut self.forces_n, (*attitude, body_rates_rad_s), acceleration_m_s2)
    }

    /// Forgets the integral: before another trajectory that begins elsewhere.
    pub const fn clear_integral(&mut self) {
        self.integral_m_s = Vector3::new(0.0, 0.0, 0.0);
    }
}

impl Default for Memory {
    fn default() -> Self {
        Self::at_rest()
    }
}
