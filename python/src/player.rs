//! A trajectory as a board plays it.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use quatrack::nalgebra::Vector3;
use quatrack::{Bookmark, Player as CorePlayer, Progress, Rate, Trajectory as CoreTrajectory};
use quatrack_plan::trajectory::on_board;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;

use crate::arrays::Quantity;
use crate::error::refused;
use crate::reference::Reference;

/// A control rate that the core takes.
fn rate(hz: u32) -> PyResult<Rate> {
    Rate::from_hz(hz).ok_or_else(|| {
        PyValueError::new_err(format!(
            "rate_hz: {hz}; must be from {} to {} control steps a second",
            Rate::MIN_HZ,
            Rate::MAX_HZ
        ))
    })
}

/// A trajectory as a board plays it, in single precision and by ticks.
#[pyclass(module = "quatrack")]
pub(crate) struct Player {
    pieces: Vec<quatrack::Piece>,
    checksum: u32,
    bookmark: Bookmark,
    end_tick: u32,
    rate_hz: u32,
}

impl Player {
    /// At the start of a trajectory.
    pub(crate) fn new(trajectory: &PiecewisePolynomial, rate_hz: u32) -> PyResult<Self> {
        let pieces = on_board::pieces(trajectory);
        let checked = CoreTrajectory::new(&pieces).map_err(refused)?;
        let player = CorePlayer::new(checked, rate(rate_hz)?);
        let (checksum, bookmark, end_tick) = (checked.checksum(), player.bookmark(), player.end_tick());
        Ok(Self { pieces, checksum, bookmark, end_tick, rate_hz })
    }
}

#[pymethods]
impl Player {
    /// The reference at a tick, with where on the trajectory that is.
    fn reference(&mut self, tick: u32) -> PyResult<Reference> {
        let trajectory = CoreTrajectory::new(&self.pieces).map_err(refused)?;
        let mut player =
            CorePlayer::resume(trajectory, self.bookmark).ok_or_else(|| refused("player: not its trajectory"))?;
        let sample = player.at_fifth_order(tick);
        self.bookmark = player.bookmark();
        let flat = &sample.flat;
        let of = |v: &Vector3<f32>| Quantity::of(v.map(f64::from).into());
        let heading =
            [flat.heading_rad, flat.heading_rate_rad_s, sample.heading_acceleration_rad_s2, sample.heading_jerk_rad_s3];
        Ok(Reference {
            crafts: None,
            position: [of(&flat.position_m), of(&flat.velocity_m_s), of(&flat.acceleration_m_s2), of(&flat.jerk_m_s3)],
            beyond: Some([of(&sample.snap_m_s4), of(&sample.crackle_m_s5)]),
            heading: heading.map(|value| Quantity::of([f64::from(value)])),
            progress: Some(Progress { trajectory: self.checksum, tick }),
        })
    }

    /// The first tick at or after the trajectory's end.
    #[getter]
    fn end_tick(&self) -> u32 {
        self.end_tick
    }

    /// Ticks a second.
    #[getter]
    fn rate_hz(&self) -> u32 {
        self.rate_hz
    }
}
