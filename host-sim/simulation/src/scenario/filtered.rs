//! The estimate of a Kalman filter: gyroscope, accelerometer and late positions in; the estimate that a law is told out.

use std::collections::VecDeque;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use quatrack::State;
use quatrack::estimator::{self, DeviationsAtStart, Estimator, EstimatorConfig, EstimatorError, Imu, ImuAverager};

use super::sensors::Sensors;
use super::track::SAMPLE_STEPS;
use super::whole::FilterFigures;
use crate::control_law::{Estimate, STEPS_HZ};
use crate::plant::RigidState;

/// Least deviation of a measured position that the filter is told, m: the firmware takes every position from outside as
/// this exact (`extPosStdDev` in `crtp_localization_service.c`), however good it is.
const POSITION_DEVIATION_MIN_M: f64 = 1e-2;
/// How well the start is known: the craft hovers there.
const AT_START: DeviationsAtStart =
    DeviationsAtStart { position_m: 0.01, velocity_m_s: 0.01, tilt_rad: 0.01, heading_rad: 0.01 };

/// Where a law's estimate comes from.
pub enum Estimation {
    /// The truth with noise.
    Exact(Box<Sensors>),
    /// A filter behind noisy sensors.
    Filtered(Box<Filtered>),
}

impl Estimation {
    /// Whether an estimate changes those after it.
    pub(super) fn remembers(&self) -> bool {
        match self {
            Self::Exact(sensors) => sensors.draws(),
            Self::Filtered(_) => true,
        }
    }

    /// Whether it uses the specific force beyond passing it on.
    pub(super) fn feels(&self) -> bool {
        matches!(self, Self::Filtered(_))
    }

    /// Steps of the flight whose estimate nobody looks at: its random numbers are drawn all the same.
    #[inline]
    pub(super) fn pass_over(&mut self, steps: u32) {
        if let Self::Exact(sensors) = self {
            sensors.pass_over(steps);
        }
    }

    /// Takes the sensors' readings after one step of the flight. A specific force that nobody asks for is 0 but for the sensors' errors.
    #[inline]
    pub(super) fn estimate(
        &mut self,
        state: &RigidState,
        specific_force_m_s2: Option<&Vector3<f64>>,
        known: &mut Estimate,
    ) -> Result<(), EstimatorError> {
        match self {
            Self::Exact(sensors) if sensors.are_exact() => {
                // Field by field into its place, which is a quarter of a copy.
                known.position_m = state.position_m;
                known.velocity_m_s = state.velocity_m_s;
                known.attitude = state.attitude;
                known.body_rates_rad_s = state.body_rates_rad_s;
                if let Some(felt_m_s2) = specific_force_m_s2 {
                    known.specific_force_m_s2 = *felt_m_s2;
                }
            }
            Self::Exact(sensors) => *known = sensors.estimate(state, &felt_or_none(specific_force_m_s2)),
            Self::Filtered(filtered) => *known = filtered.estimate(state, &felt_or_none(specific_force_m_s2))?,
        }
        Ok(())
    }
}

/// The core's filter, set as the Crazyflie's firmware has it but for the drag, behind sensors.
pub struct Filtered {
    sensors: Sensors,
    filter: Estimator,
    estimate: estimator::Estimate,
    averager: ImuAverager,
    prediction_steps: u32,
    position_steps: u32,
    latency_steps: u32,
    position_deviation_m: f64,
    /// Positions on their way: when they come in, and where the craft was.
    late: VecDeque<(u32, Vector3<f64>)>,
    step: u32,
    /// Step of the last prediction, or the first one.
    predicted: u32,
}

fn felt_or_none(specific_force_m_s2: Option<&Vector3<f64>>) -> Vector3<f64> {
    specific_force_m_s2.copied().unwrap_or_default()
}

fn steps_of(time_s: f64) -> u32 {
    (time_s * f64::from(STEPS_HZ)).round() as u32
}

fn f32s(v: &Vector3<f64>) -> Vector3<f32> {
    v.map(|value| value as f32)
}

impl Filtered {
    /// At a start that it knows, with sensors.
    ///
    /// # Errors
    /// [`EstimatorError`] for figures that the filter does not take.
    pub fn start(
        figures: &FilterFigures,
        sensors: Sensors,
        position_noise_m: f64,
        start: &RigidState,
    ) -> Result<Self, EstimatorError> {
        let drag = figures.drag_per_s as f32;
        let filter = Estimator::new(EstimatorConfig {
            drag_per_s: [drag; 2],
            at_start: AT_START,
            ..EstimatorConfig::CRAZYFLIE
        })?;
        let q = start.attitude.quaternion();
        let [w, x, y, z] = [q.w, q.i, q.j, q.k].map(|value| value as f32);
        let state = State {
            position_m: f32s(&start.position_m),
            attitude: quatrack::Quaternion::new(w, x, y, z),
            velocity_m_s: f32s(&start.velocity_m_s),
        };
        // So many steps after a sample's time.
        let first = (SAMPLE_STEPS - steps_of(figures.phase_s)) % SAMPLE_STEPS;
        let steps = |hz: f64| (f64::from(STEPS_HZ) / hz).round() as u32;
        Ok(Self {
            estimate: filter.start(&state)?,
            filter,
            sensors,
            averager: ImuAverager::new(),
            prediction_steps: steps(figures.prediction_hz),
            position_steps: steps(figures.position_hz),
            latency_steps: steps_of(figures.latency_s),
            position_deviation_m: position_noise_m.max(POSITION_DEVIATION_MIN_M),
            late: VecDeque::new(),
            step: first,
            predicted: first,
        })
    }

    /// The estimate after one step of the flight; the filter's part of it is as old as its last prediction.
    ///
    /// # Errors
    /// The filter's own words, where it takes no measurement any more.
    fn estimate(&mut self, state: &RigidState, specific_force_m_s2: &Vector3<f64>) -> Result<Estimate, EstimatorError> {
        let measured = self.sensors.estimate(state, specific_force_m_s2);
        // A sample beyond a sensor's range is left out.
        let _ = self.averager.add(&Imu {
            body_rates_rad_s: f32s(&measured.body_rates_rad_s),
            specific_force_m_s2: f32s(&measured.specific_force_m_s2),
        });
        if self.step.is_multiple_of(self.prediction_steps)
            && self.step > self.predicted
            && let Some(mean) = self.averager.take()
        {
            let period_s = (self.step - self.predicted) as f32 / STEPS_HZ as f32;
            self.predicted = self.step;
            self.filter.predict(&mut self.estimate, &mean, period_s)?;
        }
        if self.step.is_multiple_of(self.position_steps) {
            self.late.push_back((self.step + self.latency_steps, measured.position_m));
        }
        while let Some((_, position_m)) = self.late.pop_front_if(|(due, _)| *due <= self.step) {
            let deviation_m = self.position_deviation_m as f32;
            self.filter.update_position(&mut self.estimate, &f32s(&position_m), deviation_m)?;
        }
        self.step += 1;
        let State { position_m, attitude: q, velocity_m_s } = *self.estimate.state();
        let [w, x, y, z] = [q.w, q.x, q.y, q.z].map(f64::from);
        Ok(Estimate {
            position_m: position_m.map(f64::from),
            velocity_m_s: velocity_m_s.map(f64::from),
            attitude: UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)),
            ..measured
        })
    }
}
