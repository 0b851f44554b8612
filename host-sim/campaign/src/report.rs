//! One page of a campaign: a folder in; an HTML document that opens from disk without a network out.
//!
//! Everything is in the one file: figures of the summary, distributions, the worst flights and an ordinary one of each law,
//! flown again, and a script that draws them.

mod flights;

use serde::Serialize;

use crate::definition::Campaign;
use crate::error::CampaignError;
use crate::folder::Folder;
use crate::row::{Outcome, Row};
use crate::statistics::quantile;
use crate::summary::{Summary, View};
use flights::{Replayed, replayed};

const PAGE: &str = include_str!("report/page.html");
const STYLE: &str = include_str!("report/page.css");
/// Scripts in the order in which they need each other.
const SCRIPTS: [&str; 4] = [
    include_str!("report/plot.js"),
    include_str!("report/space.js"),
    include_str!("report/replay.js"),
    include_str!("report/page.js"),
];

/// Points of a distribution, from 0 to 100 %.
const POINTS: usize = 201;
/// Most flights of a law that are shown one by one against the figures drawn.
const DOTS: usize = 1500;

/// The paper's table and figures, made anew.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Paper {
    /// The table as it is printed.
    pub table: String,
    /// Title and SVG document of each.
    pub figures: Vec<(String, String)>,
}

/// The data of the page's script.
#[derive(Serialize)]
struct Data<'a> {
    schema: &'static str,
    title: String,
    conditions: String,
    summary: &'a Summary,
    laws: Vec<LawData>,
    drawn: &'a [String],
    flights: Vec<Replayed>,
    paper: Option<&'a Paper>,
}

#[derive(Serialize)]
struct LawData {
    law: String,
    /// Quantiles from 0 to 100 % of the position error's sum; none for those that were lost.
    iae_m_s: Vec<Option<f64>>,
    /// The same of the largest error.
    max_error_m: Vec<Option<f64>>,
    /// Some flights: the drawn figures and the largest error.
    dots: Vec<(Vec<f64>, Option<f64>)>,
}

/// The page.
///
/// # Errors
/// [`CampaignError`].
pub fn page(folder: &Folder, campaign: &Campaign, view: &View, paper: Option<&Paper>) -> Result<String, CampaignError> {
    let summary = Summary::of(folder, view)?;
    let card = folder.card();
    let mut rows: Vec<Vec<Row>> = card.laws.iter().map(|_| Vec::new()).collect();
    for shard in folder.parts()? {
        for row in folder.rows(shard)? {
            let row = row?;
            if let Some(law) = card.laws.iter().position(|law| *law == row.law.name())
                && row.outcome != Outcome::Refused
            {
                rows[law].push(row);
            }
        }
    }
    let laws = card.laws.iter().zip(&rows).map(|(law, rows)| law_data(law, rows)).collect();
    let flights = replayed(campaign, &rows, view.worst);
    let data = Data {
        schema: "quatrack/report/1",
        title: format!("Campaign of {} runs, seed {}", summary.runs_flown, card.seed),
        conditions: campaign.nominal()?.to_string(),
        summary: &summary,
        laws,
        drawn: &card.drawn,
        flights,
        paper,
    };
    let json = serde_json::to_string(&data)
        .map_err(|error| CampaignError::folder(folder.path(), format!("cannot be put on a page ({error})")))?;
    // Within a script nothing may look like its end.
    let json = json.replace("</", "<\\/").replace("<!--", "<\\u0021--");
    Ok(PAGE.replace("/*STYLE*/", STYLE).replace("/*DATA*/", &json).replace("/*SCRIPT*/", &SCRIPTS.join("\n")))
}

fn law_data(law: &str, rows: &[Row]) -> LawData {
    let quantiles = |of: &dyn Fn(&Row) -> f64| {
        let mut values: Vec<f64> = rows.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        (0..POINTS)
            .map(|k| quantile(&values, k as f64 / (POINTS - 1) as f64).filter(|value| value.is_finite()).map(rounded))
            .collect()
    };
    let error = |row: &Row| if row.outcome == Outcome::Lost { None } else { row.max_error_m };
    let stride = rows.len().div_ceil(DOTS).max(1);
    LawData {
        law: law.to_owned(),
        iae_m_s: quantiles(&|row| row.iae_m_s.unwrap_or(f64::INFINITY)),
        max_error_m: quantiles(&|row| error(row).unwrap_or(f64::INFINITY)),
        dots: rows
            .iter()
            .step_by(stride)
            .map(|row| (row.drawn.iter().copied().map(rounded).collect(), error(row).map(rounded)))
            .collect(),
    }
}

/// To five digits, which no picture shows more of.
fn rounded(value: f64) -> f64 {
    format!("{value:.4e}").parse().unwrap_or(value)
}
