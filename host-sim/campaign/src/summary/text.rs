//! A summary as a person reads it.

use std::fmt;

use super::{LawSummary, Summary};

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} of {} runs, seed {}", self.runs_flown, self.runs, self.seed)?;
        match self.within_m {
            Some(within) => writeln!(f, "success: flown to its end with at most {within} m of position error")?,
            None => writeln!(f, "success: flown to its end")?,
        }
        writeln!(f, "percentiles count a lost flight as worse than any other\n")?;
        let width = self.laws.iter().map(|law| law.law.len()).max().unwrap_or(0).max(4);
        writeln!(
            f,
            "{:<width$}{:>9}{:>10}{:>17}  {:>30}  {:>30}",
            "law", "flights", "success", "95 % interval", "IAE at 50, 95, 99 %, m s", "most at 50, 95, 99 %, m"
        )?;
        for law in &self.laws {
            let rate = law.success_rate.map_or_else(|| "-".to_owned(), |rate| format!("{:.2} %", 100.0 * rate));
            let interval = law
                .success_interval_95
                .map_or_else(|| "-".to_owned(), |[least, most]| format!("{:.2} to {:.2}", 100.0 * least, 100.0 * most));
            let (iae, most) = (three(&law.iae_m_s, law.flights), three(&law.max_error_m, law.flights));
            writeln!(f, "{:<width$}{:>9}{rate:>10}{interval:>17}  {iae:>30}  {most:>30}", law.law, law.flights)?;
        }
        for law in &self.laws {
            write_law(f, law)?;
        }
        Ok(())
    }
}

fn three(values: &[Option<f64>; 3], flights: u64) -> String {
    let absent = if flights > 0 { "lost" } else { "-" };
    values.map(|value| value.map_or_else(|| absent.to_owned(), |value| format!("{value:.4}"))).join("  ")
}

fn write_law(f: &mut fmt::Formatter<'_>, law: &LawSummary) -> fmt::Result {
    write!(f, "\n{}: {} lost", law.law, law.lost)?;
    if law.refused > 0 {
        write!(f, ", {} never flown (see the column reason)", law.refused)?;
    }
    if !law.matters.is_empty() {
        write!(f, "; share of the largest errors' ranks that a figure explains, and its rank correlation with them:")?;
        for matter in law.matters.iter().take(6) {
            let faint = if matter.beyond_chance { "" } else { " (chance)" };
            let (share, correlation) = (matter.explained, matter.rank_correlation);
            write!(f, "\n  {share:>6.3}  {correlation:>+6.3}  {}{faint}", matter.figure)?;
        }
    }
    for worst in &law.worst {
        let end = match (worst.lost_s, worst.max_error_m) {
            (Some(lost_s), _) => format!("lost at {lost_s:.2} s"),
            (None, Some(error_m)) => format!("{error_m:.4} m"),
            (None, None) => String::new(),
        };
        write!(f, "\n  worst: run {}, {end}\n    {}", worst.run, worst.replay)?;
    }
    writeln!(f)
}
