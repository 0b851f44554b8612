//! The log of a flight: samples in, CSV rows with named columns and units out.

use std::fmt::Write;

use quatrack_design::model::{INPUT_NAMES, STATE_NAMES};

use super::closed_loop::Flight;

/// The flight as CSV: time, state, reference state (`ref_...`), input, reference input (`ref_...`).
pub fn to_csv(flight: &Flight) -> String {
    let mut names = vec!["t_s".to_owned()];
    names.extend(STATE_NAMES.iter().map(|name| (*name).to_owned()));
    names.extend(STATE_NAMES.iter().map(|name| format!("ref_{name}")));
    names.extend(INPUT_NAMES.iter().map(|name| (*name).to_owned()));
    names.extend(INPUT_NAMES.iter().map(|name| format!("ref_{name}")));
    let mut text = names.join(",");
    text.push('\n');
    for sample in &flight.samples {
        // Writing to a string does not fail.
        let _ = write!(text, "{:.2}", sample.time_s);
        let (state, input) = (sample.state.iter(), sample.input.iter());
        let (target_state, target_input) = (sample.target.state.iter(), sample.target.input.iter());
        for value in state.chain(target_state).chain(input).chain(target_input) {
            let _ = write!(text, ",{value:.9}");
        }
        text.push('\n');
    }
    text
}
