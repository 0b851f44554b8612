//! Files that hold the same flight as another, by their commands.

use super::{Flight, Notes};

/// Flights without those whose commands are another's from end to end.
pub fn without_copies(flights: Vec<Flight>) -> (Vec<Flight>, Notes) {
    let mut kept: Vec<Flight> = Vec::new();
    let mut notes = Notes::default();
    for flight in flights {
        match kept.iter().find(|other| same(other, &flight)) {
            Some(other) => notes.0.push(format!("{}: a copy of {}; left out", flight.name, other.name)),
            None => kept.push(flight),
        }
    }
    (kept, notes)
}

fn same(a: &Flight, b: &Flight) -> bool {
    let samples = |flight: &Flight| -> Vec<f64> {
        flight.sections.iter().flat_map(|section| section.commands[0].iter().copied()).collect()
    };
    let (a, b) = (samples(a), samples(b));
    let shared = a.len().min(b.len());
    // Another end, or a few cleaned samples, are no other flight.
    shared > 100 && a.len().abs_diff(b.len()) * 10 < shared && {
        let equal = a.iter().zip(&b).filter(|(a, b)| (**a - **b).abs() < 1e-9).count();
        equal * 10 > shared * 9
    }
}
