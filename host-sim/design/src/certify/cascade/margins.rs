//! Margins of a chain at its motors: factors and delays of the command that leave it stable.

use num_complex::Complex64;
use serde::Serialize;

use super::{CascadeChain, CascadeCraft, CascadeVariation};
use crate::analysis::eigenvalues;
use crate::certify::CertifyError;
use crate::certify::margins::{Disk, DiskMargin, sampled_grid};
use crate::certify::sweep::peak;

/// The margins of a chain at the plant's input.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ChainMargins {
    /// The balanced disk.
    pub disk: DiskMargin,
    /// Delay beyond that of the variation up to which the chain is stable, s.
    pub delay_s: f64,
}

impl CascadeChain {
    /// Margins at a point. The disk is that of a loop that looks at the accelerometer at every step, with a filter of
    /// the same time constant.
    ///
    /// # Errors
    /// [`CertifyError`] where eigenvalues are not found.
    pub fn margins(self, craft: &CascadeCraft, at: &CascadeVariation) -> Result<ChainMargins, CertifyError> {
        let chain = self.of(craft, at);
        let (a, b, row) = chain.matrices(true);
        let poles = eigenvalues(&a)?;
        let h = craft.period_s;
        let (a, b, row) = (a.map(Complex64::from), b.map(Complex64::from), row.map(Complex64::from));
        let n = a.nrows();
        // From what is added to the command to command and addition: the sensitivity.
        let sensitivity = |frequency_rad_s: f64| {
            let z = Complex64::from_polar(1.0, frequency_rad_s * h);
            let mut pencil = -a.clone();
            for i in 0..n {
                pencil[(i, i)] += z;
            }
            let x = pencil.lu().solve(&b)?;
            Some(row.dot(&x) + 1.0)
        };
        let points = sampled_grid(&poles, h);
        let found = peak(&points, |frequency| Some((sensitivity(frequency)? - 0.5).norm()));
        let (height, critical) = found.ok_or(CertifyError::EmptyRegion)?;
        let mut delay_s = 0.0;
        loop {
            let later = CascadeVariation { delay_s: at.delay_s + delay_s + h, ..*at };
            if self.spectral_radius(craft, &later)? >= 1.0 || delay_s >= DELAY_MOST_S {
                break;
            }
            delay_s += h;
        }
        Ok(ChainMargins { disk: DiskMargin::new(Disk::Balanced, height, critical), delay_s })
    }
}

/// Longest delay that is tried, s.
const DELAY_MOST_S: f64 = 0.2;
