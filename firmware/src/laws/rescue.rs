//! Limits of validity of the law in force, and its replacement where the supervisor orders one: the cascade to a
//! standstill and down, or level by attitude alone.

use quatrack::cascade::{Cascade, CascadeLimits};
use quatrack::gains::cascade::CRAZYFLIE_2_1_DEFAULT;
use quatrack::gains::table::CascadeTable;
use quatrack::link::Table;
use quatrack::supervisor::{Certified, Coverage, Levelled, Looked};
use quatrack::{Controller, FifthOrderSample, Heading, Limits, Measured, MotorStep, Output, StepError, Target};

use super::Laws;
use crate::vehicle::{AIRFRAME, STEP_RATE};

/// Its table: flown where no lag is stated.
const TABLE: CascadeTable = CRAZYFLIE_2_1_DEFAULT.table;

/// The cascade of this craft.
pub(crate) static CASCADE: Cascade = match TABLE.flown(&AIRFRAME, STEP_RATE, &CascadeLimits::STANDARD, &TABLE.air) {
    Ok(cascade) => cascade,
    Err(_) => panic!("the motors are too fast for this rate"),
};

/// How much heavier or lighter, as a share, the craft may be under a loaded table that does not say.
const MASS_SHARE: f32 = 0.2;

impl Laws {
    /// The certified figures of the law in force, if it ends in motor forces.
    #[cold]
    pub(crate) fn covers(&self, are_driven: bool) -> Certified {
        if !are_driven {
            return Certified::NoMotors;
        }
        let told_kg = AIRFRAME.figures().mass_kg;
        let covering = |lag_s, share: f32| Coverage {
            lag_s,
            mass_kg: [(1.0 - share) * told_kg, (1.0 + share) * told_kg],
            rate_hz: STEP_RATE.hz(),
        };
        match self.choice.table {
            Table::Cascade => Certified::For(covering(TABLE.certified.motor_lag_s, TABLE.certified.mass_share)),
            Table::Loaded(slot) => self.store.table(slot).map_or(Certified::ForNone, |table| {
                let rate_hz = self.rate().map_or(0, quatrack::Rate::hz);
                let covered = match table.cascade() {
                    Some(of) => covering(of.certified.motor_lag_s, of.certified.mass_share),
                    None => covering([0.0, table.head().certificate.motor_lag_max_s], MASS_SHARE),
                };
                Certified::For(Coverage { rate_hz, ..covered })
            }),
            // Those of the paper know no motors: behind this craft's, none is stable.
            _ => Certified::ForNone,
        }
    }

    /// Thrust over mass that the motors should give, m/s^2.
    #[inline]
    pub(crate) fn thrust_m_s2(&self) -> f32 {
        const PER_MASS: f32 = 1.0 / AIRFRAME.figures().mass_kg;
        let [a, b, c, d] = self.memory.forces_n();
        (a + b + c + d) * PER_MASS
    }

    /// Flies to a standstill.
    #[cold]
    pub(crate) fn brake(
        &mut self,
        looked: &Looked<'_>,
        sample: &FifthOrderSample,
        heading: Heading,
    ) -> Result<Output, StepError> {
        self.take_over();
        let measured = Measured::new(looked.state).with_body_rates(looked.body_rates_rad_s);
        let target = Target::with_sample(sample, heading);
        let controller = Controller::new(&CASCADE, Limits::NONE);
        match controller.step_to_motors(&mut self.memory, measured, target) {
            Ok(step) => Ok(Output::Forces(step)),
            Err(error) => self.levelled(&Levelled::of(looked, 1e-3)).ok_or(error),
        }
    }

    /// Flies an attitude alone.
    #[cold]
    pub(crate) fn level(&mut self, levelled: &Levelled) -> Result<Output, StepError> {
        self.take_over();
        self.levelled(levelled).ok_or(StepError::Singular)
    }

    fn levelled(&mut self, levelled: &Levelled) -> Option<Output> {
        let (forces_n, limited) = self.memory.level(&CASCADE, levelled)?;
        Some(Output::Forces(MotorStep { forces_n, limited }))
    }

    /// The cascade takes over from a law in flight.
    fn take_over(&mut self) {
        if !self.is_rescued {
            self.is_rescued = true;
            let is_cascade = self.controller.law().follows_samples();
            self.settle();
            if !is_cascade {
                self.memory.begin_cascade_in_flight();
            }
        }
    }
}

const _: () = assert!(AIRFRAME.figures().motor_lag_s <= TABLE.certified.motor_lag_s[1]);
