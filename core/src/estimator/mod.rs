//! Where the craft is: gyroscope, accelerometer and position measurements in; state, covariance and innovations
//! out.
//!
//! The error-state Kalman filter of M. W. Mueller, M. Hamer and R. D'Andrea, "Fusing ultra-wideband range measurements
//! with accelerometers and rate gyroscopes for quadrocopter state estimation" (ICRA 2015), with the covariance
//! correction of M. W. Mueller, M. Hehn and R. D'Andrea, "Covariance correction step for Kalman filtering with an
//! attitude" (Journal of Guidance, Control, and Dynamics 40(9), 2017). The Crazyflie flies by this filter;
//! [`EstimatorConfig::CRAZYFLIE`] is set as it is there.
//!
//! # Model
//!
//! | symbol | is | unit |
//! |---|---|---|
//! | `r`, `v` | position and velocity, world frame | m, m/s |
//! | `q`, `R` | attitude, body to world | 1 |
//! | `a` | error of the attitude: the true one is `q exp(a / 2)`, body frame | rad |
//! | `w` | body rates of the gyroscope | rad/s |
//! | `f` | specific force along the body axes | m/s^2 |
//! | `D` | linear drag over mass, diagonal `(d_x, d_y, 0)` | 1/s |
//! | `h` | time between two predictions | s |
//!
//! `dr/dt = v`, `dv/dt = R f - g e3`, `dq/dt = 1/2 q (0, w)`. The force is the accelerometer's reading along the
//! thrust and linear drag across it, `f = (0, 0, f_z) - D R' v` ([`Force::ThrustAxis`]), or all that it measures
//! ([`Force::AllAxes`]). Body rates and force are held over a period; the attitude turns under them, so that
//! `v+ = v + h (R (f + w h x f / 2 + ...) - g e3)`, and likewise the position ([`Integration::SecondOrder`]).
//!
//! The errors go with it by `r+ = r + h (v + G a / 2)`, `v+ = (I - h R D R') v + G a`, `a+ = exp(-[w h]) a` with
//! `G = -h R ([f] + D [R' v])`. The paper has the velocity in the body frame; the errors of the two choices are linear
//! in each other, so that the filter is the same to the first order, and here position and velocity stay free of the
//! gyroscope's noise.
//!
//! A measurement is taken number by number, which needs no inverse. Its correction of `a` is moved into `q`, and the
//! covariance turned by half of it, `exp(-[a / 2])`.
//!
//! # Numbers
//!
//! `f32`, additions, products, quotients and square roots alone: the same bits on every target. Nothing that is not
//! finite gets in: it is refused by an [`EstimatorError`] that names it, and the estimate stays. Variances are bounded
//! below and above.
//!
//! # Example
//!
//! ```
//! use quatrack::estimator::{Estimator, EstimatorConfig, Imu, ImuAverager};
//! use quatrack::{State, nalgebra::Vector3};
//!
//! let config = EstimatorConfig { drag_per_s: [0.45, 0.43], ..EstimatorConfig::CRAZYFLIE };
//! let estimator = Estimator::new(config)?;
//! let mut estimate = estimator.start(&State::at_rest(Vector3::new(0.0, 0.0, 1.0)))?;
//! let mut averager = ImuAverager::new();
//! let hovering = Imu {
//!     body_rates_rad_s: Vector3::new(0.0, 0.0, 0.0),
//!     specific_force_m_s2: Vector3::new(0.0, 0.0, 9.81),
//! };
//! // Samples at 1 kHz, predictions and positions at 100 Hz: it hovers 2 cm away from where it was thought to be.
//! for _ in 0..100 {
//!     for _ in 0..10 {
//!         averager.add(&hovering)?;
//!     }
//!     if let Some(mean) = averager.take() {
//!         estimator.predict(&mut estimate, &mean, 0.01)?;
//!     }
//!     let innovation = estimator.update_position(&mut estimate, &Vector3::new(0.02, 0.0, 1.0), 1e-3)?;
//!     assert!(innovation.is_taken);
//! }
//! assert!((estimate.state().position_m.x - 0.02).abs() < 1e-3);
//! let [position, velocity, _] = estimate.covariance().deviations();
//! assert!(position.x < 1.5e-3 && velocity.x < 0.05);
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
//!
//! ```text
//! measurement                   position, velocity, attitude, pose, height, distance
//!   filter                      prediction, correction; averager
//!     motion, estimate          a state carried on, and its errors
//!       covariance, rotation    nine errors as blocks; small rotations
//!         column, config, error
//! ```

mod averager;
mod column;
mod config;
mod covariance;
mod error;
mod estimate;
mod filter;
mod measurement;
mod motion;
mod rotation;

pub use averager::ImuAverager;
pub use config::{DeviationsAtStart, EstimatorConfig, Force, Gate, Integration, noise_density};
pub use covariance::Covariance;
pub use error::{EstimatorError, EstimatorFigure};
pub use estimate::Estimate;
pub use filter::{
    BODY_RATE_MAX_RAD_S, Estimator, Innovation, PERIOD_MAX_S, POSITION_MAX_M, SPECIFIC_FORCE_MAX_M_S2, TURN_MAX_RAD,
    VELOCITY_MAX_M_S,
};
pub use motion::Imu;
