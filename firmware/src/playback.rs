//! The reference of the flight: orders from the link in, the flat output of a tick out.

mod motors;

#[cfg(feature = "motors")]
use quatrack::Progress;
use quatrack::link::{TRAJECTORY_PIECES, TrajectoryStore};
use quatrack::nalgebra::Vector3;
use quatrack::trajectory::Bookmark;
use quatrack::{FlatSample, Player, Reference, ReferenceError, Tick};

use crate::rates::TICK_RATE;

/// Uploaded trajectories: the one in use and the one that is being checked.
pub type Store = TrajectoryStore<TRAJECTORY_PIECES>;

/// The source of references.
pub struct Playback {
    source: Source,
    /// Ticks since the start of the trajectory, up to the last step.
    elapsed: Tick,
    /// The tick of the clock at which the trajectory would have begun, had it never been paused.
    base: Option<Tick>,
    moving: bool,
    /// Checksum of the trajectory, for gains along it.
    #[cfg(feature = "motors")]
    checksum: u32,
    /// Too large for the stack on which everything begins.
    store: &'static mut Store,
}

/// Source of the flat output.
enum Source {
    Nothing,
    Link(FlatSample),
    Flash(Player<'static>),
    /// The uploaded trajectory in use, and where it is: the store keeps the pieces, so that nothing can borrow them for
    /// longer than a step.
    Uploaded(Bookmark),
}

impl Playback {
    /// Nothing to follow, nothing uploaded.
    pub const fn new(store: &'static mut Store) -> Self {
        Self {
            source: Source::Nothing,
            elapsed: 0,
            base: None,
            moving: false,
            #[cfg(feature = "motors")]
            checksum: 0,
            store,
        }
    }

    /// Follows the sample that came with a state.
    pub fn follow(&mut self, sample: FlatSample) {
        self.source = Source::Link(sample);
    }

    /// Plays a trajectory in flash from its start, which is the next step.
    pub fn start(&mut self, player: Player<'static>) {
        self.begin(Source::Flash(player));
        #[cfg(feature = "motors")]
        {
            self.checksum = player.trajectory().checksum();
        }
    }

    /// Plays the uploaded trajectory from its start, which is the next step; whether there is one.
    pub fn start_uploaded(&mut self) -> bool {
        let Some(trajectory) = self.store.active().trajectory() else { return false };
        let bookmark = Player::new(trajectory, TICK_RATE).bookmark();
        #[cfg(feature = "motors")]
        {
            self.checksum = trajectory.checksum();
        }
        self.begin(Source::Uploaded(bookmark));
        true
    }

    fn begin(&mut self, source: Source) {
        (self.source, self.elapsed, self.base, self.moving) = (source, 0, None, true);
    }

    /// Rests where the last step was; whether a trajectory is there to be paused.
    pub fn pause(&mut self) -> bool {
        (self.base, self.moving) = (None, false);
        self.is_trajectory()
    }

    /// Goes on from there; whether there is something to go on with.
    pub fn resume(&mut self) -> bool {
        self.moving = true;
        self.is_trajectory()
    }

    /// Follows nothing.
    pub fn stop(&mut self) {
        self.begin(Source::Nothing);
    }

    /// The uploaded trajectories. They are checked and swapped only while nothing flies.
    pub fn store(&mut self) -> &mut Store {
        self.store
    }

    fn is_trajectory(&self) -> bool {
        matches!(self.source, Source::Flash(_) | Source::Uploaded(_))
    }

    /// Ticks of the trajectory at a tick of the clock.
    #[inline]
    fn trajectory_tick(&mut self, now: Tick) -> Tick {
        if self.moving {
            let base = *self.base.get_or_insert(now.wrapping_sub(self.elapsed));
            self.elapsed = now.wrapping_sub(base);
        }
        self.elapsed
    }

    /// Whether there is anything to follow.
    #[inline]
    pub fn is_there(&self) -> bool {
        !matches!(self.source, Source::Nothing)
    }

    /// Position of the reference at the next step, m, if there is one.
    #[cold]
    pub fn begins_at_m(&mut self) -> Option<Vector3<f32>> {
        let elapsed = self.elapsed;
        Some(match &mut self.source {
            Source::Nothing => return None,
            Source::Link(sample) => sample.position_m,
            Source::Flash(player) => player.at(elapsed).position_m,
            Source::Uploaded(bookmark) => {
                Player::resume(self.store.active().trajectory()?, *bookmark)?.at(elapsed).position_m
            }
        })
    }

    /// The reference at a tick of the clock.
    ///
    /// # Errors
    /// [`ReferenceError`] where it cannot be flown.
    #[inline]
    pub fn reference(&mut self, now: Tick) -> Result<Reference, ReferenceError> {
        let tick = self.trajectory_tick(now);
        match &mut self.source {
            Source::Flash(player) if self.moving => player.reference(tick),
            _ => self.otherwise(tick),
        }
    }

    /// Where on which trajectory the last reference was, if it was on one.
    #[cfg(feature = "motors")]
    #[inline]
    pub fn progress(&self) -> Option<Progress> {
        self.is_trajectory().then_some(Progress { trajectory: self.checksum, tick: self.elapsed })
    }

    /// The reference of everything but a moving trajectory in flash. It is paused, uploaded, or the link's.
    #[cold]
    fn otherwise(&mut self, tick: Tick) -> Result<Reference, ReferenceError> {
        let sample = match &mut self.source {
            Source::Link(sample) => return Reference::from_flat(sample),
            Source::Flash(player) => player.at(tick),
            Source::Uploaded(bookmark) => {
                let trajectory = self.store.active().trajectory();
                // Another trajectory has been put to use since this one was started: there is nothing to follow.
                let Some(mut player) = trajectory.and_then(|trajectory| Player::resume(trajectory, *bookmark)) else {
                    return Reference::from_flat(&NOWHERE);
                };
                if self.moving {
                    let reference = player.reference(tick);
                    *bookmark = player.bookmark();
                    return reference;
                }
                player.at(tick)
            }
            Source::Nothing => NOWHERE,
        };
        Reference::from_flat(&FlatSample::at_rest(sample.position_m, sample.heading_rad))
    }
}

/// The reference where there is none: it is refused, and no caller asks for it.
const NOWHERE: FlatSample = FlatSample::at_rest(Vector3::new(f32::NAN, f32::NAN, f32::NAN), 0.0);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stored;
    use quatrack::Trajectory;
    use quatrack::link::{TRAJECTORY_BLOB_BYTES, encode_trajectory};

    fn player() -> Player<'static> {
        Player::new(Trajectory::new(&stored::MILD).unwrap(), TICK_RATE)
    }

    #[test]
    fn a_trajectory_begins_with_the_first_step_and_rests_while_paused() {
        let mut direct = player();
        let mut playback = Playback::new(Box::leak(Box::default()));
        assert!(!playback.is_there(), "nothing to follow");
        playback.start(player());
        assert_eq!(playback.reference(1000), direct.reference(0), "the clock's tick does not matter");
        assert_eq!(playback.reference(6000), direct.reference(5000));
        assert!(playback.pause());
        let there = direct.at(5000);
        let rest = Reference::hover(there.position_m, there.heading_rad);
        assert_eq!(playback.reference(6010), rest, "rests where it was");
        assert_eq!(playback.reference(9000), rest, "however long");
        assert!(playback.resume());
        assert_eq!(playback.reference(9002), direct.reference(5000), "goes on from there");
        assert_eq!(playback.reference(9004), direct.reference(5002));
        playback.stop();
        assert!(!playback.is_there());
        assert!(!playback.pause(), "there is nothing left to pause");
    }

    #[test]
    fn the_clock_may_wrap() {
        let mut direct = player();
        let mut playback = Playback::new(Box::leak(Box::default()));
        playback.start(player());
        assert_eq!(playback.reference(u32::MAX - 1), direct.reference(0));
        assert_eq!(playback.reference(4), direct.reference(6));
    }

    #[test]
    fn an_uploaded_trajectory_plays_as_one_in_flash() {
        let mut blob = vec![0; TRAJECTORY_BLOB_BYTES];
        let blob = encode_trajectory(&stored::MILD, &mut blob).unwrap();
        let mut direct = player();
        let mut playback = Playback::new(Box::leak(Box::default()));
        assert!(!playback.start_uploaded(), "there is none");
        playback.store().commit(blob).unwrap();
        assert!(playback.start_uploaded());
        for tick in [0, 2, 4, 2000, 29_998, 40_000] {
            assert_eq!(playback.reference(tick), direct.reference(tick), "tick {tick}");
        }
        let other = encode_trajectory(&stored::AGGRESSIVE, &mut vec![0; TRAJECTORY_BLOB_BYTES]).unwrap().to_vec();
        playback.store().commit(&other).unwrap();
        assert!(playback.reference(40_002).is_err(), "the one that was started is gone");
    }
}
