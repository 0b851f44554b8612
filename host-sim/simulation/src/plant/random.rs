//! Random numbers that are the same on every run: a seed and a source of noise in, a stream of its own out.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use rand_distr::{Distribution as _, StandardNormal};

/// The parts of a flight that draw numbers. Each has a stream of its own, so that a flight keeps its wind when a sensor
/// is switched off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub enum Source {
    /// The wind's turbulence.
    Turbulence = 0,
    /// The gyroscope.
    Gyroscope = 1,
    /// The accelerometer.
    Accelerometer = 2,
    /// Measured positions.
    Position = 3,
    /// Measured velocities.
    Velocity = 4,
    /// Measured attitudes.
    Attitude = 5,
    /// Measurements that are lost on their way.
    Dropout = 6,
    /// Arrival times of measurements.
    Timing = 7,
}

/// Normally distributed numbers of one source: ChaCha with eight rounds, whose key is the seed and whose nonce is the
/// source.
#[derive(Clone, Debug)]
pub struct Stream(ChaCha8Rng);

impl Stream {
    /// From its beginning.
    ///
    /// ```
    /// use quatrack_simulation::plant::{Source, Stream};
    ///
    /// let mut twice = [Stream::new(7, Source::Position), Stream::new(7, Source::Position)];
    /// let [first, second] = twice.each_mut().map(Stream::normal);
    /// assert_eq!(first, second);
    /// assert_ne!(first, Stream::new(7, Source::Velocity).normal());
    /// ```
    pub fn new(seed: u64, source: Source) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(source as u64);
        Self(generator)
    }

    /// Mean 0, deviation 1.
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }
}
