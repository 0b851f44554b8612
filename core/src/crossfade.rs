//! From one tracker to another without a jump: both are stepped for a while, and their commands mixed in changing shares.
//!
//! Swapping one static gain for another jumps the command by `(K1 - K2) e`: by nothing at zero error, by anything in a
//! corner. Over `n` steps the same difference comes in `n` parts.

use nalgebra::Vector3;

use crate::command::{Command, Limited};
use crate::controller::{Controller, Memory};
use crate::error::StepError;
use crate::reference::Reference;
use crate::state::State;
use crate::tracker::{Step, Tracker};
use crate::trajectory::Progress;

/// How far the way from one tracker to the other is. Each step of it takes as long as both trackers' steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Crossfade {
    steps: u16,
    done: u16,
}

impl Crossfade {
    /// The way in so many steps, the last of which is the new tracker's alone; 0 and 1 swap at once.
    pub const fn over(steps: u16) -> Self {
        Self { steps, done: 0 }
    }

    /// Whether the way is over: from then on [`Self::step`] steps the new tracker alone.
    pub const fn is_over(&self) -> bool {
        self.done >= self.steps
    }

    /// The next step on the way. Its command is between the two trackers', so it is within the limits of both wherever
    /// those are the same, and it is theirs to the bit where they agree.
    ///
    /// # Errors
    /// [`StepError`] of the new tracker. Where only the old one has no answer, the new one's counts at once.
    pub fn step(
        &mut self,
        old: &Tracker<'_>,
        new: &Tracker<'_>,
        state: &State,
        reference: &Reference,
    ) -> Result<Step, StepError> {
        let to = new.step(state, reference)?;
        Ok(self.towards(to, || old.step(state, reference)))
    }

    /// The same for laws that remember. What is remembered is one: the new law is given it and moves it on, the old one
    /// reads it. Begin the way from a law that remembers nothing with [`Memory::new`].
    ///
    /// # Errors
    /// As [`Self::step`].
    pub fn step_controllers(
        &mut self,
        (old, new): (&Controller<'_>, &Controller<'_>),
        memory: &mut Memory,
        progress: Option<Progress>,
        state: &State,
        reference: &Reference,
    ) -> Result<Step, StepError> {
        let mut before = *memory;
        let to = new.step(memory, progress, state, reference)?;
        Ok(self.towards(to, || old.step(&mut before, progress, state, reference)))
    }

    /// The next step on the way to `to`.
    fn towards(&mut self, to: Step, from: impl FnOnce() -> Result<Step, StepError>) -> Step {
        self.done = self.done.saturating_add(1);
        if self.is_over() {
            self.done = self.steps;
            return to;
        }
        from().map_or(to, |from| between(&from, &to, f32::from(self.done) / f32::from(self.steps)))
    }
}

/// `share` of the way from one step to another; `share` below 1 and a multiple of 1/65535, which no rounding takes beyond
/// either end.
fn between(from: &Step, to: &Step, share: f32) -> Step {
    let mix = |from: f32, to: f32| from + (to - from) * share;
    let (a, b) = (&from.command.body_rates_rad_s, &to.command.body_rates_rad_s);
    Step {
        command: Command {
            thrust_m_s2: mix(from.command.thrust_m_s2, to.command.thrust_m_s2),
            body_rates_rad_s: Vector3::new(mix(a.x, b.x), mix(a.y, b.y), mix(a.z, b.z)),
        },
        limited: Limited::from_bits(from.limited.bits() | to.limited.bits()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gains::paper;
    use crate::{Equilibrium, FlatOutput, Limits};

    fn limits() -> Limits {
        Limits::new(1.8, 16.5, Vector3::new(20.0, 20.0, 5.0)).unwrap()
    }

    #[test]
    fn a_jump_comes_in_equal_parts_and_ends_with_the_new_law() {
        let (old, new) = (
            Tracker::new(Equilibrium::new(&paper::LYAP_E), limits()),
            Tracker::new(Equilibrium::new(&paper::LQR_E), limits()),
        );
        let state = State::at_rest(Vector3::new(0.0, 0.0, 0.99));
        let reference = Reference::hover(Vector3::new(0.0, 0.0, 1.0), 0.0).unwrap();
        let thrust = |step: Step| step.command.thrust_m_s2;
        let (from, to) = (thrust(old.step(&state, &reference).unwrap()), thrust(new.step(&state, &reference).unwrap()));
        let mut fade = Crossfade::over(8);
        for part in 1..=8_u8 {
            assert!(!fade.is_over());
            let found = thrust(fade.step(&old, &new, &state, &reference).unwrap());
            let expected = from + (to - from) * f32::from(part) / 8.0;
            assert!((found - expected).abs() <= 2e-6, "part {part}: {found}, not {expected}");
        }
        assert!(fade.is_over());
        assert_eq!(fade.step(&old, &new, &state, &reference), new.step(&state, &reference));
        for steps in [0, 1] {
            assert_eq!(Crossfade::over(steps).step(&old, &new, &state, &reference), new.step(&state, &reference));
        }
    }

    #[test]
    fn an_old_law_without_an_answer_does_not_hold_the_new_one_up() {
        let (old, new) = (
            Tracker::new(FlatOutput::new(&paper::LQR_F), limits()),
            Tracker::new(Equilibrium::new(&paper::LQR_E), limits()),
        );
        // Half a metre too high: 22 m/s^2 down, which has no upright attitude.
        let state = State::at_rest(Vector3::new(0.0, 0.0, 1.5));
        let reference = Reference::hover(Vector3::new(0.0, 0.0, 1.0), 0.0).unwrap();
        assert_eq!(old.step(&state, &reference), Err(StepError::Singular));
        assert_eq!(Crossfade::over(9).step(&old, &new, &state, &reference), new.step(&state, &reference));
        assert_eq!(Crossfade::over(9).step(&new, &old, &state, &reference), Err(StepError::Singular));
    }

    #[test]
    fn a_mix_of_commands_on_a_limit_stays_on_it() {
        let step = |thrust_m_s2| Step {
            command: Command { thrust_m_s2, body_rates_rad_s: Vector3::new(0.0, 0.0, 0.0) },
            limited: Limited::NOTHING,
        };
        let mut share = 0_u16;
        for (from, to) in [(1.8_f32, 16.5), (16.5, 1.8), (16.5, 16.499_998), (0.1, 16.5), (16.5, 16.5)] {
            for _ in 0..2000 {
                share = share.wrapping_add(4099).max(1);
                let mixed = between(&step(from), &step(to), f32::from(share) / 65536.0).command.thrust_m_s2;
                assert!((from.min(to)..=from.max(to)).contains(&mixed), "{mixed} from {from} to {to}");
            }
        }
    }
}
