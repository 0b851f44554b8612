//! Margins of a chain at its motors: factors and delays of the command that leave it stable.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use serde::Serialize;

use super::{CascadeChain, CascadeCraft, CascadeVariation};
use crate::analysis::eigenvalues;
use crate::certify::CertifyError;
use crate::certify::margins::{Disk, DiskMargin, sampled_grid};
use crate::certify::sweep::peak;

/// The factors and delays that a chain tolerates at the plant's input.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ChainMargins {
    /// The balanced disk.
    pub disk: DiskMargin,
    /// The disk of the sensitivity.
    pub sensitivity: DiskMargin,
    /// Delay beyond that of the variation up to which the chain is stable, s.
    pub delay_s: f64,
}

/// A chain's loop cut at the command, by frequency: it looks at the accelerometer at every step, with a filter of the same time
/// constant.
#[derive(Debug, Clone)]
pub struct ChainLoop {
    a: DMatrix<Complex64>,
    b: DVector<Complex64>,
    row: DVector<Complex64>,
    poles: Vec<Complex64>,
    period_s: f64,
}

impl ChainLoop {
    /// The sensitivity at a frequency, rad/s: from an addition to the command to the sum of both. Nothing on a pole.
    pub fn sensitivity(&self, frequency_rad_s: f64) -> Option<Complex64> {
        let z = Complex64::from_polar(1.0, frequency_rad_s * self.period_s);
        let mut pencil = -self.a.clone();
        for i in 0..self.a.nrows() {
            pencil[(i, i)] += z;
        }
        let x = pencil.lu().solve(&self.b)?;
        Some(self.row.dot(&x) + 1.0)
    }

    /// The gain of the open loop, `1 / S - 1`.
    pub fn gain(&self, frequency_rad_s: f64) -> Option<Complex64> {
        Some(self.sensitivity(frequency_rad_s)?.inv() - 1.0)
    }

    fn disk(&self, disk: Disk) -> Result<DiskMargin, CertifyError> {
        let middle = if disk == Disk::Balanced { 0.5 } else { 0.0 };
        let points = sampled_grid(&self.poles, self.period_s);
        let found = peak(&points, |frequency| Some((self.sensitivity(frequency)? - middle).norm()));
        let (height, critical) = found.ok_or(CertifyError::EmptyRegion)?;
        Ok(DiskMargin::new(disk, height, critical))
    }
}

impl CascadeChain {
    /// The loop cut at the command.
    ///
    /// # Errors
    /// [`CertifyError`] where eigenvalues are not found.
    pub fn cut(self, craft: &CascadeCraft, at: &CascadeVariation) -> Result<ChainLoop, CertifyError> {
        let (a, b, row) = self.of(craft, at).matrices(true);
        let poles = eigenvalues(&a)?;
        let complex = Complex64::from;
        Ok(ChainLoop { a: a.map(complex), b: b.map(complex), row: row.map(complex), poles, period_s: craft.period_s })
    }

    /// Margins at a point. The disks are those of [`ChainLoop`].
    ///
    /// # Errors
    /// [`CertifyError`] where eigenvalues are not found.
    pub fn margins(self, craft: &CascadeCraft, at: &CascadeVariation) -> Result<ChainMargins, CertifyError> {
        let (cut, h) = (self.cut(craft, at)?, craft.period_s);
        let mut delay_s = 0.0;
        loop {
            let later = CascadeVariation { delay_s: at.delay_s + delay_s + h, ..*at };
            if self.spectral_radius(craft, &later)? >= 1.0 || delay_s >= DELAY_MOST_S {
                break;
            }
            delay_s += h;
        }
        Ok(ChainMargins { disk: cut.disk(Disk::Balanced)?, sensitivity: cut.disk(Disk::Sensitivity)?, delay_s })
    }
}

/// Longest delay that is tried, s.
const DELAY_MOST_S: f64 = 0.2;
