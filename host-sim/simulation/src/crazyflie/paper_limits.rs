//! The source of the Crazyflie controller's limits for the paper's tables: their designs in; the factor by which all
//! channels may be off at once, and the longest lag of the motors, out.

use std::fmt::Write as _;
use std::path::Path;

use nalgebra::{DMatrix, dmatrix};
use quatrack_design::design::discretise::zero_order_hold;
use quatrack_design::model::GRAVITY_M_S2;

use thiserror::Error;

use crate::flight::motor_laws::FlightError;
use crate::gains::{self, Gains, GainsError};

/// Control period, s.
const PERIOD_S: f64 = 0.002;

macro_rules! text {
    ($name:literal) => {
        ($name, include_str!(concat!("../../../../gains/", $name, ".toml")))
    };
}

/// Why there is no source.
#[derive(Debug, Error)]
pub enum CodegenError {
    /// A design is refused.
    #[error("gains/{name}.toml: {error}")]
    Design {
        /// Its name.
        name: &'static str,
        /// The reason.
        error: GainsError,
    },
    /// A design without a table.
    #[error("gains/{name}.toml: must give a table, delay_samples = 0")]
    NoTable {
        /// Its name.
        name: &'static str,
    },
    /// No gain or no certificate.
    #[error(transparent)]
    Flight(#[from] FlightError),
}

/// Constants of the source, and the designs that they come from, by name and text.
const TABLES: [(&str, (&str, &str)); 4] =
    [("LYAP_E", text!("lyap-e")), ("LQR_E", text!("lqr-e")), ("LYAP_F", text!("lyap-f")), ("LQR_F", text!("lqr-f"))];

/// The longest lag of a table on flat outputs, s: how far they have flown. Their feedback of the position does not see the
/// attitude, so that their certificate says nothing of motors behind a body-rate loop.
const FLOWN_LAG_S: f64 = 0.02;

/// Lags are stated in steps of this part of a second, rounded down.
const STEPS_1_S: f64 = 1e4;

/// The source of `crazyflie/src/builtin/paper_limits.rs`.
///
/// # Errors
/// [`CodegenError`] where a table has no design or no certificate.
pub fn paper_limits() -> Result<String, CodegenError> {
    let mut source = String::from(
        "//! Scales and motor lags with which the paper's tables are flown: made by `cargo gains generate` and not edited by hand.\n\n\
         use super::Certified;\n",
    );
    for (constant, (name, text)) in TABLES {
        let failed = |error| CodegenError::Design { name, error };
        let design = gains::Design::from_toml(name, text, Path::new("")).map_err(failed)?;
        let certified = design.certify().map_err(failed)?;
        let table = certified.table.as_ref().ok_or(CodegenError::NoTable { name })?;
        let margin = table.head().certificate.all_channels.gain_factor;
        let (lag_max_s, why) = match &certified.designed.gains {
            Gains::Equilibrium(_) => {
                (longest_lag_s(table.by_rows())?, "longest lag (s) with which hover is stable behind the rate loop")
            }
            _ => (FLOWN_LAG_S, "longest lag (s) with which it has flown; none is certified"),
        };
        // Writing to a string does not fail.
        let _ = write!(
            source,
            "\n/// gains/{name}.toml: factor from its certificate; {why}.\n\
             pub(crate) const {constant}: Certified = ({margin:?}, {lag_max_s:?});\n"
        );
    }
    Ok(source)
}

/// The longest lag of the motors, s, with which a gain on the equilibrium's error (by rows) is stable at hover behind the
/// body-rate loop of [`quatrack::BodyRateLoop::behind_lag`]: by bisection, rounded down.
fn longest_lag_s(rows: &[Vec<f32>]) -> Result<f64, CodegenError> {
    let (mut stable_s, mut unstable_s) = (PERIOD_S, 1.0);
    while unstable_s - stable_s > 1e-9 {
        let middle_s = 0.5 * (stable_s + unstable_s);
        *(if lateral_radius(rows, middle_s)? < 1.0 { &mut stable_s } else { &mut unstable_s }) = middle_s;
    }
    Ok((stable_s * STEPS_1_S).floor() / STEPS_1_S)
}

/// Spectral radius of hover along x and turned about y, with position, velocity, angle, body rate and angular acceleration
/// as states. It is the same along y; height and yaw, with one integrator less, bear longer lags.
fn lateral_radius(rows: &[Vec<f32>], lag_s: f64) -> Result<f64, CodegenError> {
    let entry = |column: usize| rows.get(2).and_then(|row| row.get(column)).map_or(f64::NAN, |k| f64::from(*k));
    let [position, attitude, velocity] = [0, 4, 6].map(entry);
    let a = dmatrix![
        0.0, 1.0, 0.0, 0.0, 0.0;
        0.0, 0.0, GRAVITY_M_S2, 0.0, 0.0;
        0.0, 0.0, 0.0, 1.0, 0.0;
        0.0, 0.0, 0.0, 0.0, 1.0;
        0.0, 0.0, 0.0, 0.0, -1.0 / lag_s
    ];
    let b = DMatrix::from_column_slice(5, 1, &[0.0, 0.0, 0.0, 0.0, 1.0 / lag_s]);
    let held = zero_order_hold(&a, &b, PERIOD_S).map_err(FlightError::Design)?;
    // The law's angle is q2, half of it; the loop's bandwidth is 1 / (2 lag).
    let gain = dmatrix![position, velocity, 0.5 * attitude, 1.0, 0.0] * (0.5 / lag_s);
    let poles = (held.a - held.b * gain).complex_eigenvalues();
    Ok(poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max))
}
