//! The surroundings of a flight and the true figures of its craft: plain figures, checked once.

use nalgebra::Vector3;
use quatrack_design::vehicle::Vehicle;

use super::Wall;
use super::refused::{Checked, positive, within};
use super::wind::Wind;

/// Drag, airflow moment and lift, by the vehicle's own mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Air {
    /// Linear drag along the body's axes over the mass that the vehicle has in its file, 1/s. A heavier craft of the same
    /// shape has the same force.
    pub drag_per_s: [f64; 3],
    /// Moment of the airflow, `tau_x = +c_x v_y`, `tau_y = -c_y v_x`, N m per m/s.
    pub moment_n_m_per_m_s: [f64; 2],
    /// Acceleration along the thrust over the square of the velocity across it, 1/m.
    pub lift_per_m: f64,
    /// Fastest wind for which that is good, m/s: drag that grows with the square is not in it.
    pub wind_max_m_s: f64,
}

impl Air {
    /// Up to 5 m/s: in the flights of arXiv 2512.14450 the quadratic part of the drag is below 10 % of the linear one at
    /// 2 m/s, so that it is at most a quarter of it there.
    pub const WIND_MAX_M_S: f64 = 5.0;
    /// No air at all.
    pub const VACUUM: Self =
        Self { drag_per_s: [0.0; 3], moment_n_m_per_m_s: [0.0; 2], lift_per_m: 0.0, wind_max_m_s: Self::WIND_MAX_M_S };

    /// The figures known of the vehicle: forces as they were identified, not over the mass of that craft. Unknown figures
    /// are 0.
    pub fn of(vehicle: &Vehicle) -> Option<Self> {
        let known = vehicle.flown().air.as_ref()?;
        let mass_ratio = known.mass_kg / vehicle.mass_kg();
        let [x, y] = known.drag_per_s;
        Some(Self {
            drag_per_s: [x, y, known.drag_z_per_s.unwrap_or(0.0)].map(|drag| drag * mass_ratio),
            moment_n_m_per_m_s: known.moment_n_m_per_m_s,
            lift_per_m: known.lift_per_m.unwrap_or(0.0) * mass_ratio,
            wind_max_m_s: Self::WIND_MAX_M_S,
        })
    }
}

/// The surroundings of a craft.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// The air.
    pub air: Air,
    /// Its motion.
    pub wind: Wind,
    /// Whether there is a floor at height 0.
    pub floor: bool,
    /// Radius of the rotors, m, where thrust grows near the floor.
    pub ground_effect_radius_m: Option<f64>,
    /// Walls to lean on.
    pub walls: Vec<Wall>,
    /// How far the craft's guards reach beyond the axes of its rotors, m.
    pub guard_reach_m: f64,
}

impl Environment {
    /// No air, no floor, no walls.
    pub const VACUUM: Self = Self {
        air: Air::VACUUM,
        wind: Wind { mean_m_s: Vector3::new(0.0, 0.0, 0.0), gust: None, turbulence: None },
        floor: false,
        ground_effect_radius_m: None,
        walls: Vec::new(),
        guard_reach_m: 0.0,
    };

    /// Looks at every figure.
    ///
    /// # Errors
    /// [`PlantError`] with the first that is out of range, keys as in a scenario file.
    pub(super) fn check(&self) -> Checked {
        let Air { drag_per_s, moment_n_m_per_m_s, lift_per_m, wind_max_m_s } = self.air;
        for drag in drag_per_s {
            within("air.drag_per_s", drag, 0.0, 10.0, "force over velocity and mass; small craft have 0.2 to 1 1/s")?;
        }
        for moment in moment_n_m_per_m_s {
            within("air.moment_n_m_per_m_s", moment, -0.1, 0.1, "torque over velocity; a Crazyflie has 3e-4 to 1e-3")?;
        }
        within(
            "air.lift_per_m",
            lift_per_m,
            -1.0,
            1.0,
            "acceleration over velocity squared; a Crazyflie has 0.05 to 0.1",
        )?;
        let reach = "beyond it the linear drag is wrong; lower the wind";
        within("air.wind_m_s", self.wind.mean_m_s.norm(), 0.0, wind_max_m_s, reach)?;
        if let Some(gust) = &self.wind.gust {
            within("air.gust.peak_m_s", (gust.peak_m_s + self.wind.mean_m_s).norm(), 0.0, wind_max_m_s, reach)?;
            within("air.gust.from_s", gust.from_s, 0.0, 1e6, "seconds from the start")?;
            within("air.gust.rise_s", gust.rise_s, 1e-3, 1e4, "seconds; a step is no gust")?;
            within("air.gust.stay_s", gust.stay_s, 0.0, 1e6, "seconds")?;
        }
        if let Some(dryden) = &self.wind.turbulence {
            let left_m_s = (wind_max_m_s - self.wind.mean_m_s.norm()) / 2.0;
            for rms in dryden.rms_m_s.iter() {
                within(
                    "air.gust_rms_m_s",
                    *rms,
                    0.0,
                    left_m_s,
                    "two deviations and the mean wind must stay in reach of the linear drag",
                )?;
            }
            dryden.scale_m.iter().try_for_each(|scale| positive("air.gust_scale_m", *scale, 1e6, "metres"))?;
            positive("air.gust_airspeed_m_s", dryden.airspeed_m_s, 100.0, "metres a second")?;
        }
        if let Some(radius_m) = self.ground_effect_radius_m {
            within("air.ground_effect_radius_m", radius_m, 1e-3, 1.0, "the radius of one rotor in metres")?;
        }
        Ok(())
    }
}
