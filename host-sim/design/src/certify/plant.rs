//! The certified loop: a plant, a controller for it, its instants and the path of its commands.

use nalgebra::DMatrix;

use super::CertifyError;
use crate::analysis::{MatrixError, require_finite, require_square};
use crate::design::actuator_aware::{FORCES, hover_pair};
use crate::design::sampled::{SampledDesign, equilibrium_pair};
use crate::model::INPUT_NAMES;
use crate::model::linear::flat_chain;
use crate::vehicle::Vehicle;

/// A linear plant `x' = A x + B u`, and which of its states the controller sums up.
#[derive(Debug, Clone, PartialEq)]
pub struct Plant {
    pub(super) a: DMatrix<f64>,
    pub(super) b: DMatrix<f64>,
    pub(super) input_names: Vec<String>,
    /// Whether a channel is a body rate, behind a rate loop on a real craft.
    pub(super) body_rates: Vec<bool>,
    /// States whose sum over the samples is a further column of the gain, in this order.
    pub(super) integrated: Vec<usize>,
}

/// A feedback `u = -K [x; i] - K_1 u(-1) - ... - K_d u(-d)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    /// K, m x (n + integrated states).
    pub gain: DMatrix<f64>,
    /// `K_1 ... K_d`, m x m; empty for a feedback without memory.
    pub past_command_gains: Vec<DMatrix<f64>>,
    /// Feedback of actuators that are predicted instead of measured.
    pub predictor: Option<Predictor>,
}

/// Actuators that the controller predicts from its own commands, `y+ = d y + (1 - d) u`, and feeds back: `-K y` more.
#[derive(Debug, Clone, PartialEq)]
pub struct Predictor {
    /// K, m x m.
    pub gain: DMatrix<f64>,
    /// d, the share of a deviation that is left after a period.
    pub decay: f64,
}

/// When the controller runs and when its commands act.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// Period of the control loop, s.
    pub period_s: f64,
    /// Whole samples by which commands are known to act late.
    pub delay_samples: usize,
}

/// How an actuator with the time constant tau follows its command.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum LagModel {
    /// Every channel: `tau y' = u - y`.
    #[default]
    FirstOrder,
    /// Thrust as above; a body rate by a proportional rate loop whose angular acceleration comes from motors with that
    /// lag: `y' = f`, `tau f' = k (u - y) - f`.
    MotorsInRateLoop {
        /// k, 1/s.
        rate_gain_1_s: f64,
    },
}

impl Timing {
    /// Commands at a rate in Hz that act at once.
    pub fn at_rate(rate_hz: u32) -> Self {
        Self { period_s: 1.0 / f64::from(rate_hz), delay_samples: 0 }
    }
}

impl Controller {
    /// A feedback without memory.
    pub fn memoryless(gain: DMatrix<f64>) -> Self {
        Self { gain, past_command_gains: Vec::new(), predictor: None }
    }

    /// An actuator-aware gain in parts, 4 x 19, which feeds back the forces that a lag of `lag_s` makes of its commands.
    pub fn actuator_aware(gain_in_parts: &DMatrix<f64>, lag_s: f64, period_s: f64) -> Self {
        let mut gain = gain_in_parts.clone();
        let of_forces = gain.columns(FORCES, 4).into_owned();
        // The plant's own forces are not measured.
        gain.columns_mut(FORCES, 4).fill(0.0);
        let predictor = Predictor { gain: of_forces, decay: (-period_s / lag_s).exp() };
        Self { gain, past_command_gains: Vec::new(), predictor: Some(predictor) }
    }
}

impl From<&SampledDesign> for Controller {
    fn from(design: &SampledDesign) -> Self {
        Self { gain: design.gain.clone(), past_command_gains: design.past_command_gains.clone(), predictor: None }
    }
}

impl Plant {
    /// Any pair: A n x n, 1/s; B n x m. No channel is a body rate.
    ///
    /// # Errors
    /// [`CertifyError::Matrix`] for matrices that do not fit, are empty or not finite.
    pub fn new(a: DMatrix<f64>, b: DMatrix<f64>) -> Result<Self, CertifyError> {
        require_square("A", &a)?;
        require_finite("B", &b)?;
        require_shape("B", &b, a.nrows(), b.ncols(), "A")?;
        let names = (0..b.ncols()).map(|i| format!("input_{i}")).collect();
        Ok(Self { input_names: names, body_rates: vec![false; b.ncols()], integrated: Vec::new(), a, b })
    }

    /// Hover, in the order of the E error: `[x y z q1 q2 q3 vx vy vz]`, inputs `[T p q r]`; gains 4 x 9.
    pub fn equilibrium() -> Self {
        let (a, b) = equilibrium_pair();
        Self {
            a,
            b,
            input_names: INPUT_NAMES.map(String::from).to_vec(),
            body_rates: vec![false, true, true, true],
            integrated: Vec::new(),
        }
    }

    /// The same under a controller that sums up the position error, `i+ = i + h r` after the command; gains 4 x 12.
    pub fn equilibrium_with_integral() -> Self {
        Self { integrated: vec![0, 1, 2], ..Self::equilibrium() }
    }

    /// The flat chain (F-LTI), `[r v a q3]`, inputs `[a j q3']`; gains 7 x 10.
    pub fn flat_chain() -> Self {
        let (a, b) = flat_chain();
        let names = ["ax_m_s2", "ay_m_s2", "az_m_s2", "jx_m_s3", "jy_m_s3", "jz_m_s3", "q3_rate_1_s"];
        Self {
            a: DMatrix::from_column_slice(10, 10, a.as_slice()),
            b: DMatrix::from_column_slice(10, 7, b.as_slice()),
            input_names: names.map(String::from).to_vec(),
            body_rates: vec![false; 7],
            integrated: Vec::new(),
        }
    }

    /// Hover of a vehicle down to its motors, forces in parts: `[r v theta omega e]`, inputs thrust, roll, pitch and
    /// yaw part of the commanded forces; under a controller that sums up the position error, gains 4 x 19.
    pub fn hover_with_motors(vehicle: &Vehicle, lag_s: f64, mass_factor: f64, inertia_factor: f64) -> Self {
        let (a, b) = hover_pair(vehicle, lag_s, mass_factor, inertia_factor);
        Self {
            a,
            b,
            input_names: ["thrust_n", "roll_n", "pitch_n", "yaw_n"].map(String::from).to_vec(),
            body_rates: vec![false; 4],
            integrated: vec![0, 1, 2],
        }
    }

    /// Names of the inputs, in order, with their units where they have any.
    pub fn input_names(&self) -> &[String] {
        &self.input_names
    }

    /// Refuses a controller of another shape or with entries that are not finite.
    pub(super) fn require_fitting(&self, controller: &Controller) -> Result<(), CertifyError> {
        let m = self.b.ncols();
        require_finite("K", &controller.gain)?;
        require_shape("K", &controller.gain, m, self.a.nrows() + self.integrated.len(), "the plant")?;
        for past in &controller.past_command_gains {
            require_finite("K of past commands", past)?;
            require_shape("K of past commands", past, m, m, "the plant")?;
        }
        if let Some(Predictor { gain, .. }) = &controller.predictor {
            require_finite("K of predicted actuators", gain)?;
            require_shape("K of predicted actuators", gain, m, m, "the plant")?;
        }
        Ok(())
    }
}

fn require_shape(
    name: &'static str,
    m: &DMatrix<f64>,
    expected_rows: usize,
    expected_columns: usize,
    fits: &'static str,
) -> Result<(), MatrixError> {
    let (rows, columns) = m.shape();
    if (rows, columns) == (expected_rows, expected_columns) {
        return Ok(());
    }
    Err(MatrixError::Dimension { name, rows, columns, expected_rows, expected_columns, fits })
}
