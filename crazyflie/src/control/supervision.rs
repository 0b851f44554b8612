//! The measurements of a control step in; the supervisor's order, done by the flyer, out.

use quatrack::mixer::MotorLimited;
use quatrack::supervisor::{Circumstances, Config, Guard, MonitorConfig, Order, ReferenceReport, Sample, Soundness};

use super::Controller;
use super::outcome::Why;
use crate::abi;
use crate::units;

/// The supervisor's limits: ticks are the firmware's steps of 1 ms.
const CONFIGS: (&Config, &MonitorConfig) = (&Config::STANDARD, &MonitorConfig::STANDARD);

impl Controller {
    /// Flies as asked where the supervisor says so, else does as it orders.
    #[inline(always)]
    pub(super) fn supervise(&mut self, sensors: &abi::SensorData, state: &abi::State, step: u32) {
        let (limited, measured) = (self.flyer.outcome.limited, (sensors, state));
        let is_well = !self.is_bad && goes_on(&mut self.guard, measured, limited, step);
        if (is_well || self.is_to_fly(measured, step)) && self.flyer.fly(&self.guard.looked(), step).is_err() {
            self.rescue(step);
        }
    }

    /// The supervisor's inputs beside the measurements; link, battery and arming are the firmware's.
    fn circumstances(&self) -> Circumstances {
        let reference = if self.is_bad { ReferenceReport::Bad } else { ReferenceReport::Sound };
        Circumstances { asked: self.flyer.flight.asked(), reference, limited: self.flyer.cut(), ..Circumstances::WELL }
    }

    /// Not all is well: does as the supervisor orders, but for flying as asked, which is left to the caller.
    #[cold]
    #[inline(never)]
    fn is_to_fly(&mut self, (sensors, state): (&abi::SensorData, &abi::State), step: u32) -> bool {
        let (state, rates, felt) =
            (units::state(state), units::body_rates_rad_s(sensors), units::specific_force_m_s2(sensors));
        let sample = Sample {
            now: step,
            state: Some(&state),
            body_rates_rad_s: Some(&rates),
            specific_force_m_s2: felt.as_ref(),
            thrust_m_s2: self.flyer.thrust_m_s2(),
        };
        let around = self.circumstances();
        let order = self.guard.order_closely(CONFIGS, &sample, &around);
        if let Order::Fly(looked) | Order::Brake(looked, ..) = &order
            && looked.soundness != Soundness::Sound
        {
            self.counters.bad_states = self.counters.bad_states.wrapping_add(1);
        }
        match order {
            Order::Fly(_) => return true,
            Order::Brake(looked, sample, heading) => {
                if self.flyer.brake(&looked, sample, heading).is_err() {
                    self.rescue(step);
                }
            }
            Order::Level(levelled) => self.flyer.level(&levelled),
            Order::Off => self.flyer.switch_off(),
        }
        self.note();
        false
    }

    /// The law gives nothing: level, where that can be flown.
    #[cold]
    #[inline(never)]
    fn rescue(&mut self, step: u32) {
        let around = self.circumstances();
        match self.guard.step_failed(step, CONFIGS.1.tick_s, &around) {
            Some(levelled) => self.flyer.level(&levelled),
            None => self.flyer.switch_off(),
        }
        self.note();
    }

    /// Remembers why the craft is not flown as asked.
    #[cold]
    #[inline(never)]
    fn note(&mut self) {
        if let Some(why) = Why::of(self.guard.mode()) {
            self.why = why;
        }
    }
}

/// Whether all measurements of a step are sound.
#[inline(always)]
fn goes_on(
    guard: &mut Guard,
    (sensors, state): (&abi::SensorData, &abi::State),
    limited: MotorLimited,
    step: u32,
) -> bool {
    let (state, rates) = (units::state(state), units::body_rates_rad_s(sensors));
    let sample = Sample {
        now: step,
        state: Some(&state),
        body_rates_rad_s: Some(&rates),
        specific_force_m_s2: None,
        thrust_m_s2: f32::INFINITY,
    };
    guard.goes_on(CONFIGS, &sample, &Circumstances { limited, ..Circumstances::WELL })
}
