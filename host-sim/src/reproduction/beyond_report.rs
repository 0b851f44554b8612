//! The table past the paper as a person reads it.

use std::fmt;

use super::beyond::{Beyond, Figures, RATES_HZ};
use super::report::digits;

impl fmt::Display for Beyond {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "Past the paper: IAE (23) of the position with the f32 core under a hold, m s")?;
        for (course, methods) in self.courses() {
            write!(f, "\n{:<16}", format!("{course:?}"))?;
            for rate_hz in RATES_HZ {
                write!(f, "{:>20}{:10}", format!("{rate_hz} Hz"), "")?;
            }
            write!(f, "\n{:16}", "")?;
            for _ in RATES_HZ {
                write!(f, "{:>10}{:>10}{:>10}", "feedback", "+ input", "+ ahead")?;
            }
            writeln!(f)?;
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
