//! The figures of a fit: as they are printed, and as they are written.

use std::fmt::Write as _;

use quatrack_plan::trajectory::poly4d::MEMORY_BYTES;
use quatrack_simulation::flight::deviation::Deviation;
use serde::Serialize;

use super::RATE_HZ;

/// The figures that are printed, and written as JSON.
#[derive(Serialize)]
pub(super) struct RefitReport {
    pub(super) original_pieces: usize,
    pub(super) pieces: usize,
    pub(super) memory_bytes: usize,
    pub(super) duration_s: f64,
    /// Of the pieces as they are stored and as the firmware evaluates them.
    pub(super) largest_difference: Deviation,
    pub(super) lqr_e: Comparison,
    pub(super) lqr_e_feed_forward: Comparison,
}

/// IAE (23) times the sampling period of one controller, m s; nothing where the flight was lost.
#[derive(Serialize)]
pub(super) struct Comparison {
    pub(super) original_iae_m_s: Option<f64>,
    pub(super) refit_iae_m_s: Option<f64>,
    /// The refit flown, its distance taken from the original.
    pub(super) refit_from_original_iae_m_s: Option<f64>,
}

impl RefitReport {
    pub(super) fn lost(&self) -> bool {
        [&self.lqr_e, &self.lqr_e_feed_forward]
            .iter()
            .any(|law| law.original_iae_m_s.is_none() || law.refit_iae_m_s.is_none())
    }
}

/// What is printed of a fit.
pub(super) fn text(name: &str, report: &RefitReport) -> String {
    let RefitReport { original_pieces, pieces, memory_bytes, duration_s, .. } = report;
    let how = if original_pieces == pieces { "kept" } else { "of degree 7, meeting up to jerk" };
    let off = &report.largest_difference;
    let mut text = format!(
        "{name}: {original_pieces} pieces, {duration_s:.2} s\n\
         stored: {pieces} pieces, {how}, {memory_bytes} of {MEMORY_BYTES} bytes\n\n\
         largest difference, as stored in f32 and evaluated on board\n\
         \x20 position       {:.2e} m\n\
         \x20 velocity       {:.2e} m/s\n\
         \x20 acceleration   {:.2e} m/s^2\n\
         \x20 jerk           {:.2e} m/s^3\n\
         \x20 heading        {:.2e} rad\n\
         \x20 heading rate   {:.2e} rad/s\n\
         \x20 attitude       {:.2e} rad\n\
         \x20 thrust         {:.2e} m/s^2\n\
         \x20 body rates     {:.2e} rad/s\n\n\
         flown by the f32 core at {RATE_HZ} Hz, IAE in m s\n\
         \x20                           original      refit   refit from the original\n",
        off.position_m,
        off.velocity_m_s,
        off.acceleration_m_s2,
        off.jerk_m_s3,
        off.heading_rad,
        off.heading_rate_rad_s,
        off.attitude_rad,
        off.thrust_m_s2,
        off.body_rates_rad_s,
    );
    let cell = |iae: Option<f64>| iae.map_or_else(|| "lost".to_owned(), |iae| format!("{iae:.6}"));
    for (law, iae) in [("LQR-E", &report.lqr_e), ("LQR-E, feed-forward", &report.lqr_e_feed_forward)] {
        let [original, refit, across] =
            [iae.original_iae_m_s, iae.refit_iae_m_s, iae.refit_from_original_iae_m_s].map(cell);
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {law:<24} {original:>10} {refit:>10} {across:>25}");
    }
    text
}
