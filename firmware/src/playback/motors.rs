//! The same sources, to the motors: a stored trajectory to its fifth derivative; what the link sends to its jerk, and
//! without what lies beyond.

use quatrack::{Airframe, FifthOrderSample, MotorReference, Player, ReferenceError, Tick};

use super::{NOWHERE, Playback, Source};

impl Playback {
    /// The reference at a tick of the clock, down to the motor forces of a craft.
    ///
    /// # Errors
    /// [`ReferenceError`] where it cannot be flown.
    pub fn motor_reference(&mut self, now: Tick, airframe: &Airframe) -> Result<MotorReference, ReferenceError> {
        let tick = self.trajectory_tick(now);
        let sample = match &mut self.source {
            Source::Flash(player) if self.moving => return player.motor_reference(tick, airframe),
            Source::Link(sample) => return MotorReference::from_flat(&FifthOrderSample::of_jerk(*sample), airframe),
            Source::Flash(player) => player.at(tick),
            Source::Uploaded(bookmark) => {
                let trajectory = self.store.active().trajectory();
                match trajectory.and_then(|trajectory| Player::resume(trajectory, *bookmark)) {
                    Some(mut player) if self.moving => {
                        let reference = player.motor_reference(tick, airframe);
                        *bookmark = player.bookmark();
                        return reference;
                    }
                    Some(mut player) => player.at(tick),
                    // Another trajectory has been put to use since this one was started.
                    None => NOWHERE,
                }
            }
            Source::Nothing => NOWHERE,
        };
        MotorReference::hover(sample.position_m, sample.heading_rad, airframe)
    }

    /// The flat output at a tick of the clock: of a stored trajectory to its fifth derivative, of the link to its jerk. Not finite
    /// where there is nothing to follow.
    pub fn sample(&mut self, now: Tick) -> FifthOrderSample {
        let tick = self.trajectory_tick(now);
        let sample = match &mut self.source {
            Source::Link(sample) => return FifthOrderSample::of_jerk(*sample),
            Source::Flash(player) if self.moving => return player.at_fifth_order(tick),
            Source::Flash(player) => player.at(tick),
            Source::Uploaded(bookmark) => {
                let trajectory = self.store.active().trajectory();
                match trajectory.and_then(|trajectory| Player::resume(trajectory, *bookmark)) {
                    Some(mut player) if self.moving => {
                        let sample = player.at_fifth_order(tick);
                        *bookmark = player.bookmark();
                        return sample;
                    }
                    Some(mut player) => player.at(tick),
                    // Another trajectory has been put to use since this one was started.
                    None => NOWHERE,
                }
            }
            Source::Nothing => NOWHERE,
        };
        FifthOrderSample::at_rest(sample.position_m, sample.heading_rad)
    }
}
