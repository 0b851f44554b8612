//! A table of gains for motor forces as a law: the core's controller of the table, at 500 Hz, told the setpoints.

use nalgebra::Vector4;

use super::core_law::BeyondJerk;
use crate::control_law::{ControlLaw, Input};
use crate::flight::motor_laws::CraftLaw;
use crate::flight::motor_loop::{MotorLoop, RATE};
use crate::plant::RigidState;

/// The law of a table on its craft. It believes the vehicle that the table was made for, not the figures that a scenario
/// tells.
pub struct TableLaw<'a> {
    flying: MotorLoop<'a>,
    beyond_jerk: BeyondJerk,
}

impl<'a> TableLaw<'a> {
    /// At a hover; nothing where the core makes no controller of it.
    pub fn hovering(law: &'a CraftLaw<'_>, hover_thrust_n: f64) -> Option<Self> {
        let flying = law.started(&Vector4::repeat(hover_thrust_n))?;
        Some(Self { flying, beyond_jerk: BeyondJerk::default() })
    }
}

impl ControlLaw for TableLaw<'_> {
    fn rate_hz(&self) -> u32 {
        RATE.hz()
    }

    fn step(&mut self, input: &Input) -> Result<Vector4<f64>, String> {
        let estimate = &input.estimate;
        let measured = RigidState {
            position_m: estimate.position_m,
            velocity_m_s: estimate.velocity_m_s,
            attitude: estimate.attitude,
            body_rates_rad_s: estimate.body_rates_rad_s,
            thrusts_n: Vector4::zeros(),
        };
        let point = self.beyond_jerk.filled(&input.setpoint).carried_to(input.time_s);
        Ok(self.flying.step(&measured, &point)?.forces_n)
    }
}
