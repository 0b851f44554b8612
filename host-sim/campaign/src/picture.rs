//! A campaign as a picture: rows in; the share of flights that succeed over each drawn figure, a line a law, as SVG out.

use std::fmt::Write as _;

use crate::error::CampaignError;
use crate::folder::Folder;
use crate::row::{Outcome, Row};
use crate::summary::View;

const COLOURS: [&str; 10] =
    ["#0b6bcb", "#d1451b", "#2a8a4a", "#8a4fbf", "#b08900", "#00879e", "#c2327c", "#5b6570", "#7a5230", "#3b3fd8"];
/// Parts of a figure's range, with as many flights each.
const PARTS: usize = 8;
/// Panels side by side, and their size.
const ACROSS: usize = 3;
const WIDTH: f64 = 380.0;
const HEIGHT: f64 = 256.0;

/// Width of a law's line: the first are the widest, so that lines that coincide can all be seen.
fn width(number: usize) -> f64 {
    (4.6 - 0.38 * number as f64).max(1.0)
}

/// The picture of a folder's rows.
///
/// # Errors
/// [`CampaignError`].
pub fn svg(folder: &Folder, view: &View) -> Result<String, CampaignError> {
    let card = folder.card();
    let mut rows: Vec<Row> = Vec::new();
    for shard in folder.parts()? {
        for row in folder.rows(shard)? {
            rows.push(row?);
        }
    }
    rows.retain(|row| row.outcome != Outcome::Refused);
    let count = card.drawn.len();
    let high = 30.0 + HEIGHT * count.div_ceil(ACROSS) as f64 + 24.0 * card.laws.len().div_ceil(5) as f64;
    let wide = WIDTH * ACROSS as f64;
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{wide}\" height=\"{high}\" font-family=\"sans-serif\" \
         font-size=\"12\"><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>"
    );
    for (figure, name) in card.drawn.iter().enumerate() {
        let place = [(figure % ACROSS) as f64 * WIDTH, 10.0 + (figure / ACROSS) as f64 * HEIGHT];
        panel(&mut text, place, name, figure, &card.laws, &rows, view);
    }
    for (number, law) in card.laws.iter().enumerate() {
        let row = card.laws.len().div_ceil(5) - 1 - number / 5;
        let (x, y) = (60.0 + 210.0 * (number % 5) as f64, high - 14.0 - 24.0 * row as f64);
        let colour = COLOURS[number % COLOURS.len()];
        let _ = write!(
            text,
            "<line x1=\"{x}\" y1=\"{y}\" x2=\"{}\" y2=\"{y}\" stroke=\"{colour}\" stroke-width=\"{:.1}\"/><text \
             x=\"{}\" y=\"{}\">{law}</text>",
            x + 24.0,
            width(number),
            x + 30.0,
            y + 4.0
        );
    }
    text.push_str("</svg>\n");
    Ok(text)
}

fn panel(text: &mut String, [x0, y0]: [f64; 2], name: &str, figure: usize, laws: &[String], rows: &[Row], view: &View) {
    let (left, right, top, bottom) = (x0 + 48.0, x0 + WIDTH - 16.0, y0 + 8.0, y0 + HEIGHT - 60.0);
    let mut values: Vec<f64> = rows.iter().filter_map(|row| row.drawn.get(figure).copied()).collect();
    values.sort_by(f64::total_cmp);
    let (Some(least), Some(most)) = (values.first().copied(), values.last().copied()) else { return };
    let at = |value: f64| left + (value - least) / (most - least).max(f64::MIN_POSITIVE) * (right - left);
    let height = |share: f64| bottom - share * (bottom - top);
    for percent in [0, 25, 50, 75, 100] {
        let y = height(0.01 * f64::from(percent));
        let _ = write!(
            text,
            "<line x1=\"{left}\" y1=\"{y:.1}\" x2=\"{right}\" y2=\"{y:.1}\" stroke=\"#e6e9ed\"/><text x=\"{}\" y=\"{:.1}\" \
             text-anchor=\"end\" fill=\"#59636e\">{percent}</text>",
            left - 6.0,
            y + 4.0
        );
    }
    for (value, anchor) in [(least, "start"), (most, "end")] {
        let _ = write!(
            text,
            "<text x=\"{:.1}\" y=\"{}\" text-anchor=\"{anchor}\" fill=\"#59636e\">{}</text>",
            at(value),
            bottom + 22.0,
            short(value)
        );
    }
    let _ = write!(
        text,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">success in % over {name}</text>",
        0.5 * (left + right),
        bottom + 40.0
    );
    let ends: Vec<f64> = (0..=PARTS).map(|part| values[(values.len() - 1) * part / PARTS]).collect();
    for (number, law) in laws.iter().enumerate() {
        let mut points = String::new();
        for pair in ends.windows(2) {
            let last = pair[1] == most;
            let within = |row: &&Row| {
                let value = row.drawn.get(figure).copied().unwrap_or(f64::NAN);
                row.law.name() == law && value >= pair[0] && (value < pair[1] || last && value <= pair[1])
            };
            let [mut all, mut successes, mut sum] = [0.0; 3];
            for row in rows.iter().filter(within) {
                all += 1.0;
                sum += row.drawn.get(figure).copied().unwrap_or_default();
                let near = view.within_m.is_none_or(|most| row.max_error_m.is_some_and(|error| error <= most));
                successes += f64::from(u8::from(row.outcome == Outcome::Flown && near));
            }
            if all > 0.0 {
                let _ = write!(points, "{:.1},{:.1} ", at(sum / all), height(successes / all));
            }
        }
        let colour = COLOURS[number % COLOURS.len()];
        let _ = write!(
            text,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{:.1}\"/>",
            points.trim_end(),
            width(number)
        );
    }
}

fn short(value: f64) -> String {
    if value != 0.0 && value.abs() < 0.01 { format!("{value:.1e}") } else { format!("{value:.3}") }
}
