//! Trajectories of the flat output: control points, polynomial pieces or samples in; position and derivatives at a time
//! out.

pub mod bspline;
pub mod compressed;
pub mod fifth_order;
pub mod file;
pub mod on_board;
pub mod poly4d;
pub mod polynomial;
pub mod refit;
mod table;
pub mod transform;
pub mod waypoints;

use quatrack_design::model::flat::FlatSample;

/// Something to fly: a flat output over `0 <= t <= duration_s`; outside, it rests at the nearer end.
pub trait Trajectory {
    /// Length in time, s; positive and finite.
    fn duration_s(&self) -> f64;
    /// The flat output at time `t_s`.
    fn at(&self, t_s: f64) -> FlatSample;
}
