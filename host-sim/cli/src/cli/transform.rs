//! `--time-scale`, `--reverse`, `--start` and their like: flags in, the transform of a trajectory out.

use nalgebra::Vector3;
use quatrack_plan::trajectory::transform::Transform;

use super::Failure;
use super::scenario::values::List;

/// A trajectory flown slower, backwards, elsewhere, turned or larger.
#[derive(clap::Args, Clone, Copy, Default)]
#[command(next_help_heading = "Trajectory")]
pub(crate) struct TransformArgs {
    /// Take so many times as long: 2 flies half as fast, with a quarter of the acceleration.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    time_scale: Option<f64>,
    /// Fly from the end to the start.
    #[arg(long)]
    reverse: bool,
    /// Move the start here, m.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    start: Option<List<3>>,
    /// Move by this, m.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    shift: Option<List<3>>,
    /// Turn about the vertical through the start, degrees.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    turn_deg: Option<f64>,
    /// Make it so many times as large, seen from its start.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    scale: Option<f64>,
}

impl TransformArgs {
    /// The transform that is asked for.
    ///
    /// # Errors
    /// Exit code 2 for a value out of range.
    pub(crate) fn transform(&self) -> Result<Transform, Failure> {
        let positive = |flag: &str, value: Option<f64>| match value {
            Some(value) if !(1e-3..=1e3).contains(&value) => {
                Err(Failure::input(format!("{flag} {value}: must be from 0.001 to 1000")))
            }
            value => Ok(value.unwrap_or(1.0)),
        };
        let finite = |flag: &str, value: Option<List<3>>| match value {
            Some(List(values)) if values.iter().any(|value| value.is_nan() || value.abs() > 1e6) => {
                Err(Failure::input(format!("{flag}: must be three numbers of metres within 1e6")))
            }
            value => Ok(value.map(|List(values)| Vector3::from(values))),
        };
        let turn_deg = self.turn_deg.unwrap_or(0.0);
        if !(-360.0..=360.0).contains(&turn_deg) {
            return Err(Failure::input(format!("--turn-deg {turn_deg}: must be from -360 to 360")));
        }
        Ok(Transform {
            time_scale: positive("--time-scale", self.time_scale)?,
            scale: positive("--scale", self.scale)?,
            turn_rad: turn_deg.to_radians(),
            start_m: finite("--start", self.start)?,
            shift_m: finite("--shift", self.shift)?.unwrap_or_default(),
            reverse: self.reverse,
        })
    }
}
