//! Two fits of the same flights beside each other: their figures in; those that are refused, since the fits contradict each other, out.
//!
//! Commands that are noisy between the samples of a log excite the craft, and are not in it. Motions below the corner hardly have that
//! excitation; all motions together seem to tell much by it, and tell another craft. So the fit of the slower ones is believed then.

use super::figures::{EVERY_STEP, Figures, STEPS};

/// Figures by which the fits are compared.
const DECISIVE: [&str; 7] = [
    "lag_ms",
    "command_power",
    "hover_command",
    "inertia_x_kg_m2",
    "inertia_y_kg_m2",
    "moment_x_n_m_per_m_s",
    "moment_y_n_m_per_m_s",
];

/// Figures of the motors' answer in time.
const TIMES: [&str; 2] = ["lag_ms", "delay_ms"];

/// Those whose intervals do not overlap, each with a reason; with any of them the motors' times, since the commands of the log are then
/// not those that were flown.
pub(super) fn contradictions(slow: &Figures<'_>, all: &Figures<'_>) -> Vec<(&'static str, String)> {
    let told = |figures: &Figures<'_>, name: &str| figures.all.get(name)?.as_ref().ok().copied();
    let pairs = DECISIVE.iter().filter_map(|name| Some((*name, told(slow, name)?, told(all, name)?)));
    let mut refused: Vec<(&'static str, String)> = pairs
        .filter(|(_, a, b)| a.low > b.high || b.low > a.high)
        .map(|(name, a, b)| {
            let (slow, all) = (a.value, b.value);
            (name, format!("motions below 6 Hz tell {slow:.3e}, all motions {all:.3e}: {EVERY_STEP}, and {STEPS}"))
        })
        .collect();
    if let Some(name) = refused.first().map(|(name, _)| *name) {
        let reason = format!("motions below 6 Hz tell another {name} than all motions do: {EVERY_STEP}, and {STEPS}");
        refused.extend(TIMES.map(|time| (time, reason.clone())));
    }
    refused
}
