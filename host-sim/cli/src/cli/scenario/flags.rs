//! Flags over the keys of a scenario's file: a file in; the same with the value of every flag that is given out.

use quatrack_simulation::scenario::CourseChoice;
use quatrack_simulation::scenario::file::{Air, OwnAir, ScenarioFile};

use super::ScenarioArgs;
use super::values::{from_here, over, over_list};

impl ScenarioArgs {
    pub(super) fn put_over(&self, file: &mut ScenarioFile) {
        if let Some(vehicle) = &self.vehicle {
            file.vehicle = if vehicle.ends_with(".toml") { from_here(vehicle) } else { vehicle.clone() };
        }
        if let Some(course) = &self.course {
            let named = CourseChoice::NAMES.contains(&course.as_str());
            if file.course.as_deref().unwrap_or("eight") != course {
                // They belong to the file's course.
                (file.speed_m_s, file.step_m) = (None, None);
            }
            file.course = Some(if named { course.clone() } else { from_here(course) });
        }
        over(&mut file.speed_m_s, &self.speed_m_s);
        over(&mut file.step_m, &self.step_m);
        over(&mut file.duration_s, &self.duration_s);
        over(&mut file.law, &self.law);
        over(&mut file.setpoints, &self.setpoints);
        over(&mut file.estimator, &self.estimator);
        over(&mut file.seed, &self.seed);
        self.put_over_air(&mut file.air);
        self.put_over_errors(file);
        over(&mut file.told.mass_kg, &self.told_mass_kg);
        over(&mut file.told.lag_ms, &self.told_lag_ms);
        over(&mut file.told.drag_per_s, &self.told_drag_per_s);
        over_list(&mut file.told.moment_n_m_per_m_s, self.told_moment_n_m_per_m_s);
        over(&mut file.noise.gyro_rad_s, &self.noise_gyro_rad_s);
        over(&mut file.noise.accelerometer_m_s2, &self.noise_accelerometer_m_s2);
        over(&mut file.noise.position_m, &self.noise_position_m);
        over(&mut file.noise.velocity_m_s, &self.noise_velocity_m_s);
        over(&mut file.noise.attitude_rad, &self.noise_attitude_rad);
        over(&mut file.filter.prediction_hz, &self.filter_prediction_hz);
        over(&mut file.filter.position_hz, &self.filter_position_hz);
        over(&mut file.filter.drag_per_s, &self.filter_drag_per_s);
        over(&mut file.filter.latency_ms, &self.filter_latency_ms);
        over(&mut file.filter.phase_ms, &self.filter_phase_ms);
    }

    pub(super) fn put_over_air(&self, air: &mut Option<Air>) {
        match self.air.as_deref() {
            Some("vehicle") => *air = Some(Air::Vehicle(OwnAir::default())),
            Some(_) => *air = None,
            None => {}
        }
        let figures = self.drag_per_s.is_some() || self.moment_n_m_per_m_s.is_some();
        if figures || self.wind_m_s.is_some() || self.gust_rms_m_s.is_some() {
            let (Air::Own(own) | Air::Vehicle(own)) = air.get_or_insert_with(|| Air::Own(OwnAir::default()));
            over_list(&mut own.drag_per_s, self.drag_per_s);
            over_list(&mut own.moment_n_m_per_m_s, self.moment_n_m_per_m_s);
            over_list(&mut own.wind_m_s, self.wind_m_s);
            over(&mut own.gust_rms_m_s, &self.gust_rms_m_s);
        }
    }

    fn put_over_errors(&self, file: &mut ScenarioFile) {
        let errors = &mut file.errors;
        if self.lag_ms.is_some() {
            (errors.lag_rise_ms, errors.lag_fall_ms) = (None, None);
        }
        if self.lag_rise_ms.is_some() || self.lag_fall_ms.is_some() {
            errors.lag_ms = None;
        }
        over(&mut errors.mass_factor, &self.mass_factor);
        over(&mut errors.inertia_factor, &self.inertia_factor);
        over(&mut errors.lag_ms, &self.lag_ms);
        over(&mut errors.lag_rise_ms, &self.lag_rise_ms);
        over(&mut errors.lag_fall_ms, &self.lag_fall_ms);
        over(&mut errors.delay_ms, &self.delay_ms);
        over(&mut errors.thrust_factor, &self.thrust_factor);
        over(&mut errors.thrust_factor_end, &self.thrust_factor_end);
        over_list(&mut errors.torque_bias_n_m, self.torque_bias_n_m);
        over_list(&mut errors.centre_of_mass_m, self.centre_of_mass_m);
        over_list(&mut errors.gyro_bias_rad_s, self.gyro_bias_rad_s);
        over_list(&mut errors.accelerometer_bias_m_s2, self.accelerometer_bias_m_s2);
    }
}
