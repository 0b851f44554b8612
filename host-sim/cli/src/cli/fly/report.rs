//! A flight of the paper's model in; its figures on the screen and in a file, its log, and how the command ends out.

use quatrack_simulation::flight::closed_loop::Flight;
use quatrack_simulation::flight::log;
use quatrack_simulation::flight::metrics::Metrics;
use serde::Serialize;

use super::Args;
use crate::cli::{Failure, output};

/// The flight as it is written to a file: figures, and when and why it was lost.
#[derive(Serialize)]
struct FlightReport {
    /// None where it was lost before anything was measured.
    #[serde(flatten)]
    metrics: Option<Metrics>,
    lost: Option<String>,
    /// The parts of the reference that no law can follow.
    reference: Option<String>,
}

/// A flight, with the words that describe how it was flown.
pub(super) struct DescribedFlight {
    /// The law and its gains.
    pub(super) law: String,
    /// The arithmetic and the rate.
    pub(super) clock: String,
    /// The limits, in words.
    pub(super) limits: String,
    pub(super) duration_s: f64,
    pub(super) flight: Flight,
    /// The parts of the reference that no law can follow.
    pub(super) reference: Option<String>,
}

pub(super) fn report(args: &Args, flown: &DescribedFlight) -> Result<(), Failure> {
    let DescribedFlight { law, clock, limits, duration_s, flight, reference } = flown;
    // One sample is the start, before anything was flown.
    let metrics = (flight.samples.len() > 1 || flight.lost.is_none()).then(|| Metrics::of(flight));
    let feed = if args.feed_forward { ", feed-forward" } else { "" };
    let trajectory = &args.trajectory;
    output::print(&format!("{law} on {trajectory}, {duration_s:.2} s, {clock}{feed}, limits {limits}\n"))?;
    if let Some(metrics) = &metrics {
        output::print(&figures(metrics))?;
    }
    if let Some(reference) = reference {
        output::print(&format!("  note: {reference}\n"))?;
    }
    if let Some(dir) = &args.out {
        let path = dir.join("flight.csv");
        output::write(&path, log::to_csv(flight).as_bytes())?;
        output::print(&format!("wrote {}\n", path.display()))?;
    }
    let lost = flight.lost.as_ref().map(|lost| format!("{:.2} s: {}", lost.time_s, lost.reason));
    if let Some(path) = &args.json {
        let report = FlightReport { metrics, lost: lost.clone(), reference: reference.clone() };
        output::write_json(path, &output::Named::new("fly-trajectory", &report))?;
        output::print(&format!("wrote {}\n", path.display()))?;
    }
    lost.map_or(Ok(()), |lost| Err(Failure::lost(format!("{law} was lost at {lost}"))))
}

fn figures(metrics: &Metrics) -> String {
    let iae = |v: Option<f64>| v.map_or_else(|| "none: the flight was lost".to_owned(), |v| format!("{v:.6} m s"));
    format!(
        "\x20 IAE, sum (23) times T_s   {}\n\
         \x20 IAE, integral (22)        {}\n\
         \x20 largest position error    {:.6} m\n\
         \x20 RMS position error        {:.6} m\n\
         \x20 lowest z                  {:.4} m at {:.2} s\n\
         \x20 largest tilt              {:.2} deg\n\
         \x20 peak thrust               {:.3} m/s^2\n\
         \x20 peak body rate            {:.3} rad/s\n\
         \x20 saturated steps           {}\n",
        iae(metrics.iae_m_s),
        iae(metrics.iae_integral_m_s),
        metrics.max_error_m,
        metrics.rms_error_m,
        metrics.min_z_m,
        metrics.min_z_time_s,
        metrics.max_tilt_deg,
        metrics.max_thrust_m_s2,
        metrics.max_body_rate_rad_s,
        metrics.saturated_steps,
    )
}
