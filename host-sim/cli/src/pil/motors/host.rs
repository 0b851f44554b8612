//! The core on the host down to the motors: a course and a law in; the forces of each step, which the target's have to
//! be, out.

use std::fmt;

use quatrack::cascade::CascadeLimits;
use quatrack::gains::cascade::CRAZYFLIE_2_1_DEFAULT;
use quatrack::gains::paper;
use quatrack::{
    Actuation, Airframe, BodyRateLoop, Cascade, Controller, Equilibrium, Heading, Limits, Measured, Memory,
    MotorForces, Player, Rate, RigidState, Target,
};
use quatrack_design::vehicle::Vehicle;
use quatrack_plan::plan::paper::PaperTrajectory;
use quatrack_plan::plan::stored;
use quatrack_simulation::vehicles;

use super::MotorFlight;
use crate::pil::PilError;
use crate::pil::flights::RATE_HZ;

/// The core on the host with the board's tables.
pub(super) struct HostCore {
    flight: MotorFlight,
    limits: Limits,
    actuation: Actuation,
    cascade: Cascade,
    player: Player<'static>,
    memory: Memory,
}

impl HostCore {
    pub(super) fn new(course: PaperTrajectory, flight: MotorFlight, vehicle: &Vehicle) -> Result<Self, PilError> {
        let refused = |error: &dyn fmt::Display| PilError::Answer(format!("{course:?}, {flight}: {error}"));
        let airframe = Airframe::CRAZYFLIE_2_1;
        let rate = Rate::from_hz(RATE_HZ).ok_or_else(|| refused(&"no such rate"))?;
        let trajectory = quatrack::Trajectory::new(stored::pieces(course)).map_err(|error| refused(&error))?;
        let body_rates =
            BodyRateLoop::new(&airframe, flight.bandwidth_rad_s(vehicle)).map_err(|error| refused(&error))?;
        let actuation = Actuation::new(&airframe, rate).map_err(|error| refused(&error))?;
        let of = &CRAZYFLIE_2_1_DEFAULT.table;
        let cascade = of.flown(&airframe, rate, &CascadeLimits::STANDARD, &of.air).map_err(|error| refused(&error))?;
        Ok(Self {
            flight,
            limits: vehicles::limits(vehicle).map_err(|error| refused(&error))?,
            actuation: actuation.with_body_rates(body_rates),
            cascade,
            player: Player::new(trajectory, rate),
            memory: Memory::at_rest(),
        })
    }

    pub(super) fn step(&mut self, tick: u32, state: &RigidState) -> Result<MotorForces, String> {
        let (memory, measured) = (&mut self.memory, Measured::from(state));
        let step = match self.flight {
            MotorFlight::LqrE => {
                let reference = self.player.reference(tick).map_err(|error| error.to_string())?;
                let controller = Controller::new(Equilibrium::new(&paper::LQR_E), self.limits);
                let controller = controller.with_actuation(&self.actuation);
                controller.step_to_motors(memory, measured, Target::new(&reference))
            }
            MotorFlight::Cascade => {
                let sample = self.player.at_fifth_order(tick);
                let target = Target::with_sample(&sample, Heading::from_angle(sample.flat.heading_rad));
                Controller::new(&self.cascade, self.limits).step_to_motors(memory, measured, target)
            }
        };
        Ok(step.map_err(|error| error.to_string())?.forces_n)
    }
}
