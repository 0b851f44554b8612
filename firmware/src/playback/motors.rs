//! The same sources, carried on to the motors: a stored trajectory to its fifth derivative; a sample of the link to its
//! jerk, and without higher derivatives.

use quatrack::error::Field;
use quatrack::{FifthOrderSample, FlatSample, Heading, Player, Reference, ReferenceError, Tick};

use super::{Playback, Source};

impl Playback {
    /// The flat output at a tick of the clock and its heading, for a law that makes its own reference of it.
    ///
    /// # Errors
    /// [`ReferenceError`] where it cannot be flown.
    pub fn sample(&mut self, now: Tick) -> Result<(FifthOrderSample, Heading), ReferenceError> {
        let tick = self.trajectory_tick(now);
        let sample = match &mut self.source {
            Source::Flash(player) if self.moving => player.at_fifth_order(tick),
            Source::Link(sample) => {
                // A sample from outside is checked here; a stored trajectory has been.
                Reference::from_flat(sample)?;
                FifthOrderSample::of_jerk(*sample)
            }
            Source::Flash(player) => at_rest(&player.at(tick)),
            Source::Uploaded(bookmark) => {
                let trajectory = self.store.active().trajectory();
                match trajectory.and_then(|trajectory| Player::resume(trajectory, *bookmark)) {
                    Some(mut player) if self.moving => {
                        let sample = player.at_fifth_order(tick);
                        *bookmark = player.bookmark();
                        sample
                    }
                    Some(mut player) => at_rest(&player.at(tick)),
                    // Another trajectory has been put to use since this one was started.
                    None => return Err(nowhere()),
                }
            }
            Source::Nothing => return Err(nowhere()),
        };
        Ok((sample, Heading::from_angle(sample.flat.heading_rad)))
    }
}

fn at_rest(sample: &FlatSample) -> FifthOrderSample {
    FifthOrderSample::at_rest(sample.position_m, sample.heading_rad)
}

const fn nowhere() -> ReferenceError {
    ReferenceError::NonFinite { field: Field::Position, value: f32::NAN }
}
