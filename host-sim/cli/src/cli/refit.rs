//! `quatrack refit`: a trajectory in; one that the Crazyflie's trajectory memory holds, and how far off it is, out.

mod report;

use std::num::NonZeroUsize;

use clap::builder::RangedU64ValueParser;
use quatrack::law::EquilibriumGain;
use quatrack::{Equilibrium, ErrorForm, FeedForward, Limits, Rate};
use quatrack_design::design::codegen::rounded;
use quatrack_design::design::synthesis::{self, EquilibriumWeights};
use quatrack_plan::trajectory::Trajectory;
use quatrack_plan::trajectory::compressed::{self, CompressedError};
use quatrack_plan::trajectory::on_board;
use quatrack_plan::trajectory::poly4d::{MEMORY_BYTES, PIECES_MAX, StoredTrajectory};
use quatrack_plan::trajectory::polynomial::{PiecewisePolynomial, csv};
use quatrack_plan::trajectory::refit::refit;
use quatrack_simulation::flight::closed_loop::{LOST_M, fly_sampled};
use quatrack_simulation::flight::core_loop::CoreLoop;
use quatrack_simulation::flight::deviation::Deviation;
use quatrack_simulation::flight::metrics::Metrics;
use quatrack_simulation::flight::reference::Exact;
use quatrack_simulation::flight::reference_check::ReferenceCheck;

use self::report::{Comparison, RefitReport, text};
use super::limits::LimitsChoice;
use super::transform::TransformArgs;
use super::{Failure, output};

/// A fit that is further off is told of where no tolerance is given, m: as far as a Crazyflie's position is known.
const FAR_M: f64 = 0.01;

/// Control steps a second of the flights that compare the two trajectories.
const RATE_HZ: u32 = 500;

/// Fits a trajectory into the Crazyflie's trajectory memory and says how far off the fit is.
///
/// The pieces have degree 7 and meet up to jerk. A trajectory that already has few enough pieces keeps them.
///
/// Exit code 1, and nothing is written, where the fit or its compressed form is further off than --tolerance-m, or LQR-E
/// is lost on either trajectory. 2: an input that cannot be used.
///
/// Examples:
///   quatrack refit aggressive --csv w.csv
///   quatrack refit my.csv --pieces 15 --tolerance-m 0.001 --csv short.csv --json fit.json
///   quatrack refit my.csv --time-scale 1.5 --compressed my.ctraj
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct Args {
    /// mild, aggressive, or a file: polynomial pieces (uav_trajectories CSV), control points (JSON or TOML), a plan (TOML,
    /// planned first), or the Crazyflie's compressed form.
    #[arg(value_name = "mild|aggressive|FILE")]
    trajectory: String,
    /// Most pieces, 1 to 31, the most that the memory holds.
    #[arg(long, value_name = "N", default_value_t = PIECES_MAX, value_parser = pieces_parser())]
    pieces: usize,
    /// Write nothing and exit with 1 if the position is further off than this; with --compressed, of that form, too.
    #[arg(long, value_name = "X", value_parser = tolerance)]
    tolerance_m: Option<f64>,
    /// Write the pieces as they are stored, in the uav_trajectories form that Bitcraze's tools read.
    #[arg(long, value_name = "FILE")]
    csv: Option<output::File>,
    /// Write it in Bitcraze's compressed form, control points of 1 mm and 0.1 degrees in 2 bytes each: its own pieces, where
    /// the memory holds as many so, else the fitted ones.
    #[arg(long, value_name = "FILE")]
    compressed: Option<output::File>,
    /// Limits that the reference is compared with: those of a vehicle, none, or THRUST_MIN,THRUST_MAX,RATE_MAX in m/s^2
    /// and rad/s.
    #[arg(long, value_name = "V", allow_hyphen_values = true, default_value = "crazyflie-2.1")]
    limits: LimitsChoice,
    #[command(flatten)]
    transform: TransformArgs,
    /// Write the figures as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<output::File>,
}

fn pieces_parser() -> RangedU64ValueParser<usize> {
    RangedU64ValueParser::new().range(1..=PIECES_MAX as u64)
}

fn tolerance(text: &str) -> Result<f64, String> {
    let value = text.parse().map_err(|_| "not a number of metres".to_owned())?;
    if value > 0.0 { Ok(value) } else { Err("must be a positive number of metres".to_owned()) }
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let name = &args.trajectory;
    let original = super::fly::transformed(name, &args.transform)?;
    let failed = |error: &dyn std::fmt::Display| Failure::input(format!("{name}: {error}"));
    let pieces = NonZeroUsize::new(args.pieces).unwrap_or(NonZeroUsize::MIN);
    let fitted = refit(&original, pieces).map_err(|error| failed(&error))?;
    for trajectory in [&original, &fitted] {
        on_board::checked(trajectory).map_err(|error| super::fly::not_on_board(name, &error))?;
    }
    let stored = StoredTrajectory::new(&fitted).map_err(|error| failed(&error))?;
    let gain = synthesis::lqr_equilibrium(&EquilibriumWeights::paper()).map_err(Failure::input)?.gain;
    let gain = EquilibriumGain::new(rounded(&gain)).map_err(Failure::input)?;
    let compare =
        |feed_forward| compare(&original, stored.polynomials(), &gain, feed_forward).map_err(|error| failed(&error));
    let report = RefitReport {
        original_pieces: original.pieces().len(),
        pieces: stored.pieces().len(),
        memory_bytes: stored.bytes(),
        duration_s: stored.duration_s(),
        largest_difference: Deviation::between(&Exact(&original), &Exact(&stored)),
        lqr_e: compare(FeedForward::Without)?,
        lqr_e_feed_forward: compare(FeedForward::With)?,
    };
    output::print(&text(name, &report))?;
    if let Some(reference) = ReferenceCheck::of(&original, &args.limits.limits).line() {
        output::print(&format!("\nnote: {reference}\n"))?;
    }
    if report.lost() {
        return Err(Failure::verdict(format!(
            "{name}: LQR-E is lost on it; fly it slower (--time-scale 2), or check its accelerations; nothing is written"
        )));
    }
    let off_m = report.largest_difference.position_m;
    // A fit that nobody asks for may be as far off as it likes.
    let writes_fit = args.csv.is_some() || args.compressed.is_none();
    if writes_fit && args.tolerance_m.is_none() && (off_m.is_nan() || off_m > FAR_M) {
        output::print(&format!(
            "\nnote: {} pieces are {off_m:.3} m off, which is far; {}, or let --tolerance-m {FAR_M} refuse such a fit\n",
            report.pieces,
            remedy(args.pieces)
        ))?;
    }
    let is_far = |tolerance_m: &f64| writes_fit && (off_m.is_nan() || off_m > *tolerance_m);
    if let Some(tolerance_m) = args.tolerance_m.filter(is_far) {
        return Err(Failure::verdict(format!(
            "{name}: {} pieces are {off_m:.2e} m off, more than --tolerance-m {tolerance_m}; {}",
            report.pieces,
            remedy(args.pieces)
        )));
    }
    let packed = match &args.compressed {
        Some(path) => Some((path, Packed::nearest(&original, &fitted).map_err(|error| failed(&error))?)),
        None => None,
    };
    if let Some((_, packed)) = &packed {
        packed.check(name, args.tolerance_m)?;
    }
    if let Some(path) = &args.csv {
        output::write(path, csv::write(stored.polynomials()).as_bytes())?;
        output::print(&format!("wrote {}\n", path.display()))?;
    }
    if let Some((path, Packed { bytes, off })) = &packed {
        output::write(path, bytes)?;
        output::print(&format!(
            "wrote {}: {} of {MEMORY_BYTES} bytes, at most {:.2e} m, {:.2e} m/s and {:.2e} m/s^2 off\n",
            path.display(),
            bytes.len(),
            off.position_m,
            off.velocity_m_s,
            off.acceleration_m_s2
        ))?;
    }
    if let Some(path) = &args.json {
        output::write_json(path, &output::Named::new("refit", &report))?;
        output::print(&format!("wrote {}\n", path.display()))?;
    }
    Ok(())
}

/// A trajectory in the compressed form.
struct Packed {
    bytes: Vec<u8>,
    /// Of the bytes as they are read again, from the trajectory as it was given.
    off: Deviation,
}

impl Packed {
    /// The nearer one of the trajectory's own pieces, if the memory holds them so, and of those fitted to it.
    fn nearest(original: &PiecewisePolynomial, fitted: &PiecewisePolynomial) -> Result<Self, CompressedError> {
        let fitted = Self::of(fitted, original);
        match Self::of(original, original) {
            Ok(own) if own.bytes.len() <= MEMORY_BYTES => match fitted {
                Ok(fitted) if fitted.off.position_m < own.off.position_m => Ok(fitted),
                _ => Ok(own),
            },
            _ => fitted,
        }
    }

    fn of(fitted: &PiecewisePolynomial, original: &PiecewisePolynomial) -> Result<Self, CompressedError> {
        let bytes = compressed::to_bytes(fitted)?;
        let off = Deviation::between(&Exact(original), &Exact(&compressed::from_bytes(&bytes)?));
        Ok(Self { bytes, off })
    }

    /// Numbers of 1 mm and durations of 1 ms put a fit off that is near enough before.
    fn check(&self, name: &str, tolerance_m: Option<f64>) -> Result<(), Failure> {
        let off_m = self.off.position_m;
        match tolerance_m {
            Some(tolerance_m) if off_m.is_nan() || off_m > tolerance_m => Err(Failure::verdict(format!(
                "{name}: the compressed form is {off_m:.2e} m off, more than --tolerance-m {tolerance_m}, since it has \
                 whole millimetres and milliseconds; write the pieces as they are (--csv in place of --compressed), fly it \
                 slower (--time-scale 2) or allow {:.1e}",
                rounded_up(off_m)
            ))),
            _ => Ok(()),
        }
    }
}

/// The next figure of two digits.
fn rounded_up(x: f64) -> f64 {
    let digit = 10.0_f64.powf(x.log10().floor() - 1.0);
    (x / digit).ceil() * digit
}

/// How a fit comes closer for which some pieces were allowed.
fn remedy(allowed: usize) -> String {
    if allowed < PIECES_MAX {
        format!("allow more pieces (--pieces, at most {PIECES_MAX}) or split the trajectory")
    } else {
        "split the trajectory and refit its parts".to_owned()
    }
}

/// The f32 core with the paper's LQR-E on both trajectories.
fn compare(
    original: &PiecewisePolynomial,
    refit: &PiecewisePolynomial,
    gain: &EquilibriumGain,
    feed_forward: FeedForward,
) -> Result<Comparison, String> {
    let rate = Rate::from_hz(RATE_HZ).ok_or_else(|| format!("no clock of {RATE_HZ} Hz"))?;
    let iae = |flown: &PiecewisePolynomial, measured_from: &PiecewisePolynomial| {
        let pieces = on_board::pieces(flown);
        let law = Equilibrium { gain, error_form: ErrorForm::HeadingFrame, feed_forward };
        let mut core = CoreLoop::new(&pieces, rate, law, Limits::NONE).map_err(|error| error.to_string())?;
        let flight = fly_sampled(&Exact(measured_from), rate.hz(), LOST_M, |tick, _, x| core.step(tick, x));
        Ok::<_, String>(Metrics::of(&flight).iae_m_s)
    };
    Ok(Comparison {
        original_iae_m_s: iae(original, original)?,
        refit_iae_m_s: iae(refit, refit)?,
        refit_from_original_iae_m_s: iae(refit, original)?,
    })
}
