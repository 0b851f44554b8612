//! The loop with the gain of each knot, frozen: the gains as flown in; the worst margins and limits of the knots out.

mod margins;

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use nalgebra::{DMatrix, SMatrix};
use num_complex::Complex64;

use crate::analysis::eigenvalues;
use crate::certify::linear_loop::LinearLoop;
use crate::certify::sampled_loop::SampledLoop;
use crate::certify::structured::quick_upper_bound;
use crate::certify::{CertifyError, Controller, Plant, Timing};
use crate::design::along::{GainsAlong, error_dynamics};
use crate::model::flat::ReferencePoint;
pub(super) use margins::{limits, margins};

/// Body rates and thrust.
const CHANNELS: usize = 4;

/// The loop at a knot.
pub(super) struct Frozen {
    given: LinearLoop,
    timing: Timing,
    names: Vec<String>,
    pub(super) poles: Vec<Complex64>,
    pub(super) spectral_radius: f64,
}

/// Calls a function for each of `count` indices on every processor; the results in their order.
fn each<T: Send>(count: usize, function: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                return done;
            }
            done.push((index, function(index)));
        }
    };
    let threads = thread::available_parallelism().map_or(1, usize::from).min(count);
    let mut all = thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(work)).collect();
        let mut all = work();
        for other in others {
            // A panic of another thread goes on in this one.
            all.extend(other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        }
        all
    });
    all.sort_by_key(|(index, _)| *index);
    all.into_iter().map(|(_, result)| result).collect()
}

/// The loops at all knots, each stable.
pub(super) fn knots(
    reference: &impl Fn(f64) -> ReferencePoint,
    designed: &GainsAlong,
    flown: &[SMatrix<f64, 4, 9>],
) -> Result<Vec<Frozen>, CertifyError> {
    let timing = Timing { period_s: designed.period_s, delay_samples: 0 };
    let at_knot = |(knot, gain): (usize, &SMatrix<f64, 4, 9>)| {
        let time_s = knot as f64 * designed.spacing_s;
        // The last knot's gain is flown behind it, at rest.
        let looked_at_s = if knot + 1 == flown.len() { time_s + designed.spacing_s } else { time_s };
        let (a, b) = error_dynamics(&reference(looked_at_s));
        let plant = Plant { a, b, ..Plant::equilibrium() };
        let controller = Controller::memoryless(DMatrix::from_column_slice(4, 9, gain.as_slice()));
        plant.require_fitting(&controller)?;
        let given = LinearLoop::new(&plant, &controller);
        let poles = eigenvalues(&SampledLoop::in_f64(&given, &timing, 0.0, |_| false)?.closed_loop())?;
        let spectral_radius = poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
        // Written so that NaN is refused.
        if spectral_radius < 1.0 {
            Ok(Frozen { given, timing, names: plant.input_names().to_vec(), poles, spectral_radius })
        } else {
            Err(CertifyError::UnstableAtKnot { knot, time_s, spectral_radius })
        }
    };
    flown.iter().enumerate().map(at_knot).collect()
}

/// The function that is swept over frequency.
#[derive(Clone, Copy)]
enum Measure {
    /// `|S_ii - 1/2|`.
    Balanced(usize),
    /// `|S_ii|`.
    Sensitivity(usize),
    /// A bound of `mu(S - I/2)` from above.
    All,
}

impl Measure {
    fn every() -> impl Iterator<Item = Self> {
        (0..CHANNELS).map(Self::Balanced).chain((0..CHANNELS).map(Self::Sensitivity)).chain([Self::All])
    }

    fn of(self, s: &DMatrix<Complex64>) -> Option<f64> {
        match self {
            Self::Balanced(i) => Some((s[(i, i)] - 0.5).norm()),
            Self::Sensitivity(i) => Some(s[(i, i)].norm()),
            Self::All => quick_upper_bound(&half(s)),
        }
    }
}

/// `S - I/2`.
fn half(s: &DMatrix<Complex64>) -> DMatrix<Complex64> {
    let mut half = s.clone();
    for i in 0..s.nrows() {
        half[(i, i)] -= 0.5;
    }
    half
}
