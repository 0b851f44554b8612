//! The gains of a design by their kind: in f64 as designed; as rows of f32, the entries of a table, out.

use nalgebra::{DMatrix, SMatrix};
use quatrack::gains::table::{Rows, TableKind};
use quatrack_design::design::along::GainsAlong;
use quatrack_design::design::cascade::GAINS;
use quatrack_design::design::codegen::{rounded, rounded_along};

/// Gains by the law that flies them.
#[derive(Debug, Clone, PartialEq)]
pub enum Gains {
    /// 4 x 9.
    Equilibrium(Box<SMatrix<f64, 4, 9>>),
    /// 7 x 10.
    FlatOutput(Box<SMatrix<f64, 7, 10>>),
    /// 4 x 12, with the sums of the position error.
    Integral(Box<SMatrix<f64, 4, 12>>),
    /// 4 x 19, to the motors' forces.
    ActuatorAware(Box<SMatrix<f64, 4, 19>>),
    /// 16, of the four chains.
    Cascade(Box<[f64; GAINS]>),
    /// 4 x 9 at each knot, on the grid of [`GainsAlong::on_grid`].
    Along(Box<GainsAlong>),
}

/// The entries of a table.
#[derive(Debug, Clone, PartialEq)]
pub enum TableRows {
    /// One gain.
    Fixed(Box<Rows>),
    /// The gains of the cascade.
    Chains([f32; GAINS]),
    /// Of the actuator-aware law, of which no table is made: 4 x 19.
    ActuatorAware(Box<[[f32; 19]; 4]>),
    /// A gain at each knot.
    OverTime(Vec<[[f32; 9]; 4]>),
}

impl Gains {
    /// The kind of its table, or of its rows and columns where no table is made of it.
    pub fn kind(&self) -> TableKind {
        match self {
            Self::Equilibrium(_) => TableKind::Equilibrium,
            Self::FlatOutput(_) => TableKind::FlatOutput,
            Self::Integral(_) => TableKind::Integral,
            Self::ActuatorAware(_) => TableKind::ActuatorAware,
            Self::Cascade(_) => TableKind::Cascade,
            Self::Along(_) => TableKind::AlongTrajectory,
        }
    }

    /// As one matrix; gains over time one below the other.
    pub fn dense(&self) -> DMatrix<f64> {
        match self {
            Self::Equilibrium(gain) => DMatrix::from_column_slice(4, 9, gain.as_slice()),
            Self::FlatOutput(gain) => DMatrix::from_column_slice(7, 10, gain.as_slice()),
            Self::Integral(gain) => DMatrix::from_column_slice(4, 12, gain.as_slice()),
            Self::ActuatorAware(gain) => DMatrix::from_column_slice(4, 19, gain.as_slice()),
            Self::Cascade(gains) => DMatrix::from_row_slice(1, GAINS, &gains[..]),
            Self::Along(along) => DMatrix::from_fn(4 * along.gains.len(), 9, |i, j| along.gains[i / 4][(i % 4, j)]),
        }
    }

    /// As the core flies it, every entry the nearest f32.
    pub fn rows(&self) -> TableRows {
        TableRows::Fixed(Box::new(match self {
            Self::Equilibrium(gain) => Rows::Equilibrium(rounded(gain)),
            Self::FlatOutput(gain) => Rows::FlatOutput(rounded(gain)),
            Self::Integral(gain) => Rows::Integral(rounded(gain)),
            Self::ActuatorAware(gain) => return TableRows::ActuatorAware(Box::new(rounded(gain))),
            Self::Cascade(gains) => return TableRows::Chains(gains.map(|gain| gain as f32)),
            Self::Along(along) => return TableRows::OverTime(rounded_along(along)),
        }))
    }

    /// The same, each row a list; of gains over time the rows of one knot after those of the other.
    pub fn by_rows(&self) -> Vec<Vec<f32>> {
        let rows = self.rows();
        let entries = match &rows {
            TableRows::Fixed(rows) => rows.entries(),
            TableRows::Chains(gains) => gains,
            TableRows::ActuatorAware(rows) => rows.as_flattened(),
            TableRows::OverTime(knots) => knots.as_flattened().as_flattened(),
        };
        entries.chunks(usize::from(self.kind().dimensions().1)).map(<[f32]>::to_vec).collect()
    }
}
