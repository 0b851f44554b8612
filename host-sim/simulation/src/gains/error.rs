//! Why a design gives no table, in one line each: which key, its value, the remedy.

use quatrack::gains::table::{NameError, TableError};
use quatrack_design::certify::cascade::{CascadeChain, CascadeVariation};
use quatrack_design::certify::{CertifyError, MarginTooSmall};
use quatrack_design::design::DesignError;
use thiserror::Error;

/// A design that cannot be read, computed, certified or written.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum GainsError {
    /// The file cannot be read.
    #[error("cannot read this design ({reason}); give the path of a design, a TOML file")]
    Unreadable {
        /// The system's message.
        reason: String,
    },
    /// Not TOML, a key that is unknown or missing, or a value of another type.
    #[error("line {line}, `{written}`: {reason}")]
    Syntax {
        /// Line, from 1.
        line: usize,
        /// The text of it.
        written: String,
        /// The reader's message.
        reason: String,
    },
    /// A value out of range.
    #[error("{key} = {value}: must be {must}")]
    Value {
        /// The key.
        key: String,
        /// Its value.
        value: String,
        /// Its required range, in words.
        must: String,
    },
    /// A key that the method or the linearisation needs.
    #[error("{key} is missing; {with} needs it: {example}")]
    Missing {
        /// The key.
        key: String,
        /// The entry that needs it.
        with: String,
        /// An example of the entry.
        example: &'static str,
    },
    /// A key that means nothing here.
    #[error("{key} = {value} does not belong to {with}; leave it out")]
    Misplaced {
        /// The key.
        key: String,
        /// Its value.
        value: String,
        /// The entry that states it.
        with: String,
    },
    /// The file's name is no name for a table.
    #[error("the file's name is the table's name: {0}")]
    Name(NameError),
    /// The vehicle's name is no name for a table.
    #[error("the vehicle's name is the table's name: {0}")]
    VehicleName(NameError),
    /// The vehicle is not known or cannot be used.
    #[error("vehicle = \"{vehicle}\": {reason}")]
    Vehicle {
        /// The vehicle as the design writes it.
        vehicle: String,
        /// The fault.
        reason: String,
    },
    /// The equations have no solution.
    #[error(transparent)]
    Design(#[from] DesignError),
    /// The same, with the states that are to blame.
    #[error("{error}; {blamed}")]
    Unsolved {
        /// The solver's error.
        error: DesignError,
        /// The states to blame, and the remedy.
        blamed: String,
    },
    /// The gains cannot be certified.
    #[error(transparent)]
    Certify(#[from] CertifyError),
    /// The certificate falls short of the design's own minimum.
    #[error("refused: {0}")]
    Minimum(#[from] MarginTooSmall),
    /// The gain is not stable all over the region that the design asks for.
    #[error(
        "refused: in its region the spectral radius reaches {spectral_radius:.6} at {worst}; it must stay below 1: \
         raise motor_lag_ms, lower the weights or narrow [region]"
    )]
    Region {
        /// The largest spectral radius.
        spectral_radius: f64,
        /// The least stable point.
        worst: quatrack_design::certify::Variation,
    },
    /// The loop of the cascade is not stable all over the region that the design asks for.
    #[error(
        "refused: in its region the spectral radius of {chain} reaches {spectral_radius:.6} at {worst}; it must stay below 1: \
         change motor_lag_ms, lower the weights or narrow [region]"
    )]
    CascadeRegion {
        /// The chain.
        chain: CascadeChain,
        /// The largest spectral radius.
        spectral_radius: f64,
        /// The least stable point.
        worst: Box<CascadeVariation>,
    },
    /// The core would refuse the table.
    #[error("the table would be refused on board: {0}")]
    Table(TableError),
}

impl GainsError {
    /// Whether the design was understood and the answer is no, as opposed to a file that cannot be used.
    pub fn is_verdict(&self) -> bool {
        matches!(
            self,
            Self::Certify(CertifyError::Unstable { .. } | CertifyError::UnstableAtKnot { .. })
                | Self::Minimum(_)
                | Self::Region { .. }
                | Self::CascadeRegion { .. }
                | Self::Table(_)
        )
    }
}
