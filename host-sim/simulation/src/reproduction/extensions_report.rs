//! The table past the paper as a person reads it.

use std::fmt;

use super::extensions::{Extensions, Figures, RATES_HZ};
use super::report::digits;

impl fmt::Display for Extensions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "Past the paper: IAE (23) of the position with the f32 core under a hold, m s")?;
        for (course, methods) in self.courses() {
            let rates: String = RATES_HZ.map(|rate_hz| format!("{:>20}{:10}", format!("{rate_hz} Hz"), "")).concat();
            writeln!(f, "\n{}", format!("{:<16}{rates}", format!("{course:?}")).trim_end())?;
            let columns = format!("{:>10}{:>10}{:>10}", "feedback", "+ input", "+ ahead");
            writeln!(f, "{:16}{}", "", columns.repeat(RATES_HZ.len()))?;
            for (method, rates) in methods {
                write!(f, "  {method:<14}")?;
                for Figures { feedback, feed_forward, half_period_ahead } in rates.values() {
                    let ahead = if method.takes_input() { digits(*half_period_ahead) } else { "-".to_owned() };
                    write!(f, "{:>10}{:>10}{ahead:>10}", digits(*feedback), digits(*feed_forward))?;
                }
                writeln!(f)?;
            }
        }
        Ok(())
    }
}
