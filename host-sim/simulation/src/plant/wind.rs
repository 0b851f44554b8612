//! Wind: its mean, gusts and turbulence in, the velocity of the air at a time out.

use nalgebra::Vector3;

use super::dryden::{Dryden, Turbulence};
use super::random::{Source, Stream};

/// Period of the turbulence's grid, s; between its points the wind is a straight line.
const PERIOD_S: f64 = 0.002;

/// A gust that rises as one minus a cosine, stays, and falls likewise. With no stay it is that of CS-25.341; with an
/// endless one that of MIL-F-8785C, 3.7.3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gust {
    /// Velocity at its height, world frame, m/s.
    pub peak_m_s: Vector3<f64>,
    /// Its beginning, s.
    pub from_s: f64,
    /// How long it rises, and how long it falls, s.
    pub rise_s: f64,
    /// Time at its full strength, s.
    pub stay_s: f64,
}

impl Gust {
    /// Velocity of the air that it adds, m/s.
    pub fn at(&self, time_s: f64) -> Vector3<f64> {
        let since_s = time_s - self.from_s;
        let until_s = 2.0 * self.rise_s + self.stay_s - since_s;
        let share = (since_s.min(until_s) / self.rise_s).clamp(0.0, 1.0);
        self.peak_m_s * (0.5 - 0.5 * (std::f64::consts::PI * share).cos())
    }
}

/// Motion of the air.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wind {
    /// Mean velocity of the air, world frame, m/s.
    pub mean_m_s: Vector3<f64>,
    /// One gust.
    pub gust: Option<Gust>,
    /// Turbulence; its first axis points along the mean wind, or along x in still air.
    pub turbulence: Option<Dryden>,
}

impl Wind {
    /// The same wind at all times.
    pub fn constant(mean_m_s: Vector3<f64>) -> Self {
        Self { mean_m_s, ..Self::default() }
    }
}

/// A wind as it blows in one flight.
#[derive(Clone, Debug)]
pub(super) struct Blowing {
    mean_m_s: Vector3<f64>,
    gust: Option<Gust>,
    turbulence: Option<Grid>,
}

/// Turbulence on its grid.
#[derive(Clone, Debug)]
struct Grid {
    filters: Turbulence,
    /// Horizontal direction of the mean wind, x and y.
    along: [f64; 2],
    /// The last two points, world frame, m/s.
    before_m_s: Vector3<f64>,
    after_m_s: Vector3<f64>,
    /// Number of the latter.
    point: u64,
    squares: Vector3<f64>,
}

impl Blowing {
    pub(super) fn new(wind: &Wind, seed: u64) -> Self {
        let grid = |dryden: &Dryden| {
            let (x, y) = (wind.mean_m_s.x, wind.mean_m_s.y);
            let speed = x.hypot(y);
            let along = if speed > 0.0 { [x / speed, y / speed] } else { [1.0, 0.0] };
            let filters = Turbulence::new(dryden, PERIOD_S, Stream::new(seed, Source::Turbulence));
            let zero = Vector3::zeros();
            let mut grid = Grid { filters, along, before_m_s: zero, after_m_s: zero, point: 0, squares: zero };
            grid.advance();
            grid.point = 0;
            grid
        };
        Self { mean_m_s: wind.mean_m_s, gust: wind.gust, turbulence: wind.turbulence.as_ref().map(grid) }
    }

    /// Velocity of the air, m/s, at a time that never goes back.
    #[inline]
    pub(super) fn at(&mut self, time_s: f64) -> Vector3<f64> {
        let mut velocity = self.mean_m_s;
        if let Some(gust) = &self.gust {
            velocity += gust.at(time_s);
        }
        if let Some(grid) = &mut self.turbulence {
            velocity += grid.at(time_s);
        }
        velocity
    }

    /// Whether it stays the same.
    pub(super) fn is_steady(&self) -> bool {
        self.gust.is_none() && self.turbulence.is_none()
    }

    /// Root mean square of the turbulence so far along the mean wind, across it and upwards, m/s.
    pub(super) fn realised_rms_m_s(&self) -> Option<Vector3<f64>> {
        self.turbulence.as_ref().map(|grid| (grid.squares / (grid.point + 1) as f64).map(f64::sqrt))
    }
}

impl Grid {
    fn advance(&mut self) {
        let own = self.filters.next();
        let [x, y] = self.along;
        self.before_m_s = self.after_m_s;
        self.after_m_s = Vector3::new(x * own.x - y * own.y, y * own.x + x * own.y, own.z);
        self.squares += own.component_mul(&own);
        self.point += 1;
    }

    fn at(&mut self, time_s: f64) -> Vector3<f64> {
        let place = time_s / PERIOD_S;
        // Forgiving the rounding of a sum of steps, so that a step that ends on a point draws no other.
        while place > self.point as f64 + 1e-6 {
            self.advance();
        }
        self.after_m_s + (self.before_m_s - self.after_m_s) * (self.point as f64 - place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gust_rises_stays_and_falls() {
        let gust = Gust { peak_m_s: Vector3::new(2.0, 0.0, -1.0), from_s: 1.0, rise_s: 0.5, stay_s: 0.25 };
        for (time_s, share) in
            [(0.9, 0.0), (1.0, 0.0), (1.25, 0.5), (1.5, 1.0), (1.7, 1.0), (2.0, 0.5), (2.25, 0.0), (9.0, 0.0)]
        {
            assert!((gust.at(time_s) - gust.peak_m_s * share).norm() < 1e-12, "{time_s}");
        }
    }

    #[test]
    fn turbulence_has_the_intensity_that_is_asked_for_and_tells_the_realised_one() {
        let rms_m_s = Vector3::new(0.5, 0.5, 0.5);
        let turbulence = Dryden { rms_m_s, scale_m: Vector3::repeat(1.0), airspeed_m_s: 5.0 };
        let mut wind = Blowing::new(
            &Wind { mean_m_s: Vector3::new(0.0, 2.0, 0.0), turbulence: Some(turbulence), ..Wind::default() },
            3,
        );
        let (mut squares, count) = (Vector3::zeros(), 500_000);
        for k in 0..count {
            let velocity = wind.at(f64::from(k) * PERIOD_S) - Vector3::new(0.0, 2.0, 0.0);
            squares += velocity.component_mul(&velocity);
        }
        let rms = (squares / f64::from(count)).map(f64::sqrt);
        let said = wind.realised_rms_m_s().expect("there is turbulence");
        // Along the wind is world y here.
        assert!((said.x - rms.y).abs() < 1e-9 && (said.y - rms.x).abs() < 1e-9 && (said.z - rms.z).abs() < 1e-9);
        // 1000 s with a memory of 0.2 s hold 2500 independent squares or more: 4 deviations are 6 % of the RMS.
        assert!(said.iter().all(|x| (x - 0.5).abs() < 0.03), "{said}");
    }

    #[test]
    fn it_blows_the_same_for_the_same_seed_at_any_steps() {
        let turbulence = Dryden::at_low_altitude(Vector3::repeat(0.5), 1.0, 0.0);
        let wind = Wind { turbulence: Some(turbulence), ..Wind::default() };
        let (mut coarse, mut fine) = (Blowing::new(&wind, 5), Blowing::new(&wind, 5));
        for k in 0..100_u32 {
            for part in 1..8 {
                fine.at(f64::from(k) * 0.01 - 0.01 * f64::from(8 - part) / 8.0);
            }
            assert_eq!(coarse.at(f64::from(k) * 0.01), fine.at(f64::from(k) * 0.01), "{k}");
        }
        assert_ne!(Blowing::new(&wind, 6).at(1.0), coarse.at(1.0));
    }
}
