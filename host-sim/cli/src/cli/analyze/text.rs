//! Section III's numbers in; the text that is printed of them out.

use std::fmt::Write as _;

use nalgebra::DMatrix;
use quatrack_design::analysis::{ModelAnalysis, SectionThree};

/// Everything the command prints.
pub(super) fn text(section: &SectionThree) -> String {
    let mut out = String::from("Section III: the two linear models of the paper\n");
    for model in [&section.flat, &section.equilibrium] {
        out.push('\n');
        describe(&mut out, model);
    }
    out.push_str("\nThe paper's claims\n");
    let claims = section.claims();
    for claim in &claims {
        let verdict = if claim.holds { "holds" } else { "WRONG" };
        line(&mut out, format!("  {verdict}  {:5}  {}", claim.source, claim.statement));
        line(&mut out, format!("                {}", claim.computed));
    }
    let wrong = claims.iter().filter(|claim| !claim.holds).count();
    line(&mut out, format!("{} of {} claims hold, {wrong} does not.", claims.len() - wrong, claims.len()));
    out
}

fn describe(out: &mut String, model: &ModelAnalysis) {
    let n = model.a.nrows();
    line(out, format!("{}: {n} states, {} inputs", model.label, model.b.ncols()));
    matrix(out, "A", &model.states, &model.states, &model.a);
    matrix(out, "B", &model.states, &model.inputs, &model.b);

    let mut lines = vec![
        ["eigenvalue 1/s", "Jordan blocks", "ranks of (A - lambda I)^k", "PBH rank", "reached"].map(str::to_owned),
    ];
    for (structure, test) in model.jordan.iter().zip(&model.pbh) {
        lines.push([
            complex(structure.eigenvalue),
            list(&structure.block_sizes),
            list(&structure.ranks),
            format!("{} of {n}", test.rank),
            if test.controllable { "yes" } else { "no" }.to_owned(),
        ]);
    }
    table(out, &lines);

    let ranks = &model.controllability;
    let smallest = ranks.singular_values.get(ranks.rank.saturating_sub(1)).copied().unwrap_or(0.0);
    line(
        out,
        format!(
            "  controllability matrix (10), columns of length 1: rank {} of {n}, smallest singular value counted {smallest:.2e}, \
             zero below {:.1e}",
            ranks.rank, ranks.tolerance
        ),
    );
    let stairs = &model.staircase;
    line(
        out,
        format!(
            "  staircase (11): {} out of reach, then steps of {}; zero below {:.1e} of the norm",
            stairs.uncontrollable,
            list(&stairs.steps),
            stairs.tolerance
        ),
    );
    if stairs.uncontrollable > 0 {
        let new_states = new_state_names(model);
        let new_states: Vec<&str> = new_states.iter().map(String::as_str).collect();
        matrix(out, "T", &new_states, &model.states, &stairs.transformation);
        matrix(
            out,
            "A_u",
            &new_states[..stairs.uncontrollable],
            &new_states[..stairs.uncontrollable],
            &stairs.uncontrollable_a(),
        );
        let reduced = &new_states[stairs.uncontrollable..];
        matrix(out, "A_cu", reduced, &new_states[..stairs.uncontrollable], &stairs.coupling());
        let (a, b) = stairs.controllable_pair();
        matrix(out, "A_c", reduced, reduced, &a);
        matrix(out, "B_c", reduced, &model.inputs, &b);
    }
    for mode in &model.uncontrollable_modes {
        let terms: Vec<String> = mode.combination.iter().map(|(name, value)| format!("{value:+} {name}")).collect();
        line(out, format!("  uncontrollable mode: {}", terms.join(" ")));
    }
    line(
        out,
        format!(
            "  {}, {}",
            if model.controllable() { "controllable" } else { "not controllable" },
            if model.stabilisable {
                "stabilisable"
            } else {
                "not stabilisable; on the unit quaternions (13) the mode follows from the others, and the reduced pair is controllable"
            }
        ),
    );
}

/// Names of the rows of T: that of the old state where a row is one, otherwise its number.
fn new_state_names(model: &ModelAnalysis) -> Vec<String> {
    let name = |i: usize| {
        let row = model.staircase.transformation.row(i);
        let one = row.iter().position(|value| *value == 1.0);
        one.filter(|_| row.norm() == 1.0).map_or_else(|| format!("row {i}"), |state| model.states[state].to_owned())
    };
    (0..model.a.nrows()).map(name).collect()
}

fn line(out: &mut String, text: impl std::fmt::Display) {
    // Writing to a String cannot fail.
    let _ = writeln!(out, "{text}");
}

/// A named matrix with the names of its rows and columns; zeros as dots.
fn matrix(out: &mut String, name: &str, row_names: &[&str], column_names: &[&str], m: &DMatrix<f64>) {
    let mut lines =
        vec![std::iter::once(name.to_owned()).chain(column_names.iter().map(|s| (*s).to_owned())).collect()];
    for (row_name, row) in row_names.iter().zip(m.row_iter()) {
        lines.push(
            std::iter::once((*row_name).to_owned()).chain(row.iter().map(|value| number(*value))).collect::<Vec<_>>(),
        );
    }
    table(out, &lines);
}

/// Six digits at most, without trailing zeros.
fn number(value: f64) -> String {
    if value == 0.0 {
        return ".".to_owned();
    }
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn complex([re, im]: [f64; 2]) -> String {
    if im == 0.0 { format!("{re}") } else { format!("{re} {} {}i", if im < 0.0 { '-' } else { '+' }, im.abs()) }
}

fn list(values: &[usize]) -> String {
    values.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
}

/// Columns padded to their widest entry.
fn table<R: AsRef<[String]>>(out: &mut String, lines: &[R]) {
    let columns = lines.iter().map(|cells| cells.as_ref().len()).max().unwrap_or(0);
    let width = |column: usize| {
        lines.iter().filter_map(|cells| cells.as_ref().get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    for cells in lines {
        let padded: Vec<String> =
            cells.as_ref().iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}")).collect();
        line(out, format!("  {}", padded.join("  ")).trim_end());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_text_names_the_slip_the_mode_and_the_verdict() {
        let text = text(&SectionThree::new().expect("the paper's models are finite"));
        assert!(text.contains("uncontrollable mode: +1 q0"), "{text}");
        assert!(text.contains("largest block 2 for A_f and 3 for A_e"), "{text}");
        assert!(text.contains("8 of 9 claims hold, 1 does not."), "{text}");
        // Plain text: no tabs, no trailing blanks, ASCII.
        assert!(text.is_ascii() && !text.contains('\t') && !text.contains(" \n"));
    }
}
