//! The source of the Crazyflie controller's own tables: the designs of its craft in; gains for motor forces, with the
//! lags that they may be told and the factor by which their feedback may be off, out.
//!
//! Each craft has two designs for motors whose lag its owner states, and one for any lag that is published. A gain flies
//! with the lag that is stated, in its prediction of the forces and in what it feeds forward: [`Stated`] is where that is
//! certified. With none stated the last of them flies with the lag of its design over [`Region::of_any_crazyflie`].

use std::fmt::Write as _;
use std::path::Path;

use nalgebra::DMatrix;
use quatrack_design::certify::{Region, RegionBounds, certify_region};
use quatrack_design::design::actuator_aware::actuator_aware;
use quatrack_design::vehicle::Vehicle;
use thiserror::Error;

use crate::flight::motor_laws::FlightError;
use crate::gains::{self, GainsError, Problem};
use crate::vehicles;

/// Control period, s.
pub(super) const PERIOD_S: f64 = 0.002;

/// Factors on the feedback that are tried, the largest first.
const FACTORS: [f64; 5] = [2.0, 1.75, 1.5, 1.25, 1.1];

/// Lags that may be stated, s, of each design: from the shortest that a prediction at the control rate has.
const STATED_S: [[f64; 2]; 3] = [[0.004, 0.040], [0.040, 0.080], [0.080, 0.126]];

macro_rules! text {
    ($name:literal) => {
        ($name, include_str!(concat!("../../../../gains/", $name, ".toml")))
    };
}
pub(super) use text;

/// What the gains of a craft are called in the source, and the designs that they come from, by name and text: for the
/// shortest lags first, the last one for any published lag, too.
const CRAFTS: [(&str, [(&str, &str); 3]); 3] = [
    ("CRAZYFLIE_2_1", [text!("actuator-aware-20ms"), text!("actuator-aware-63ms"), text!("actuator-aware")]),
    (
        "CRAZYFLIE_2_1_UPGRADE_KIT",
        [text!("actuator-aware-kit-20ms"), text!("actuator-aware-kit-63ms"), text!("actuator-aware-kit")],
    ),
    (
        "CRAZYFLIE_2_1_BRUSHLESS",
        [text!("actuator-brushless-20ms"), text!("actuator-brushless-63ms"), text!("actuator-aware-brushless")],
    ),
];

/// Why there is no source.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CodegenError {
    /// A design is not what it has to be.
    #[error("gains/{name}.toml: {error}")]
    Design {
        /// Its name.
        name: &'static str,
        /// What is wrong with it.
        #[source]
        error: GainsError,
    },
    /// A design for another law.
    #[error("gains/{name}.toml: method must be actuator-aware")]
    Method {
        /// Its name.
        name: &'static str,
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

/// Where a gain is certified that flies with the lag that its owner states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stated {
    /// Shortest and longest that may be stated, s.
    pub lag_s: [f64; 2],
    /// The true lag over the stated one, shortest and longest.
    pub lag_factor: [f64; 2],
    /// How much of its mass and its inertia the vehicle may have more or less.
    pub shares: [f64; 2],
    /// How late commands may act, s.
    pub delay_s: f64,
}

impl Stated {
    /// The stated lag off by a quarter, the mass by 20 %, the inertia by 30 % and 10 ms of delay, all at once.
    pub const fn all_at_once(lag_s: [f64; 2]) -> Self {
        Self { lag_s, lag_factor: [0.75, 1.25], shares: [0.2, 0.3], delay_s: 0.010 }
    }

    /// The stated lag off by half of it, on the vehicle as it is.
    pub const fn lag_alone(lag_s: [f64; 2]) -> Self {
        Self { lag_s, lag_factor: [0.5, 1.5], shares: [0.0, 0.0], delay_s: 0.0 }
    }

    /// Largest spectral radius of a gain in parts (4 x 19): four stated lags, with seven true ones each and the ends and the
    /// middle of what else varies.
    ///
    /// # Errors
    /// [`FlightError::Certify`] where a certificate cannot be computed.
    pub fn spectral_radius(&self, vehicle: &Vehicle, in_parts: &DMatrix<f64>) -> Result<f64, FlightError> {
        self.over(vehicle, in_parts, [2, 1])
    }

    /// On a grid of which only every so many of the seven stated and of the seven true lags are left, and of the delays the
    /// ends where the latter are few.
    fn over(&self, vehicle: &Vehicle, in_parts: &DMatrix<f64>, every: [usize; 2]) -> Result<f64, FlightError> {
        let [shortest_s, longest_s] = self.lag_s;
        let mut largest = 0.0_f64;
        for stated_s in Region::of_lags(shortest_s, longest_s).lags_s.into_iter().step_by(every[0]) {
            let lag_s = self.lag_factor.map(|factor| factor * stated_s);
            let [mass_share, inertia_share] = self.shares;
            // The mass is felt by the chain of the height alone, the inertia by the others: neither needs the other's corners.
            for (mass_share, inertia_share) in [(mass_share, 0.0), (0.0, inertia_share)] {
                let grid = RegionBounds { lag_s, mass_share, inertia_share, delay_s: self.delay_s }.grid();
                let left = |values: &[f64], every| values.iter().copied().step_by(every).collect();
                let lags_s = left(&grid.lags_s, every[1]);
                let delays_s = left(&grid.delays_s, if every[1] > 1 { 2 } else { 1 });
                let region = Region { lags_s, delays_s, ..grid };
                let found = certify_region(vehicle, in_parts, stated_s, PERIOD_S, &region)?.spectral_radius;
                // A NaN is as bad as it gets, and stays.
                largest = if found.is_nan() { f64::INFINITY } else { largest.max(found) };
            }
        }
        Ok(largest)
    }
}

/// A gain of the image.
#[derive(Clone, Debug)]
pub struct Design {
    /// Name of its design.
    pub name: &'static str,
    /// The vehicle that it is for.
    pub vehicle: Vehicle,
    /// The lag that it is designed for, s.
    pub lag_s: f64,
    /// Where it is certified.
    pub stated: Stated,
    /// The gain in parts, 4 x 19.
    pub gain_in_parts: DMatrix<f64>,
    /// The gain, 4 x 19.
    pub gain: DMatrix<f64>,
}

impl Design {
    /// The gains of each craft, for the shortest lags first.
    ///
    /// # Errors
    /// [`CodegenError`].
    pub fn of_crafts() -> Result<[[Self; 3]; 3], CodegenError> {
        let [plain, kit, brushless] = CRAFTS.map(|(_, [short, known, any])| {
            let [in_short, in_known, in_any] = STATED_S;
            Ok::<_, CodegenError>([
                Self::read(short, in_short)?,
                Self::read(known, in_known)?,
                Self::read(any, in_any)?,
            ])
        });
        Ok([plain?, kit?, brushless?])
    }

    fn read((name, text): (&'static str, &str), stated_s: [f64; 2]) -> Result<Self, CodegenError> {
        let design = gains::Design::from_toml(name, text, Path::new(""))
            .map_err(|error| CodegenError::Design { name, error })?;
        let Problem::ActuatorAware { motor_lag_s: lag_s, weights, .. } = design.problem else {
            return Err(CodegenError::Method { name });
        };
        let found = actuator_aware(&design.vehicle, lag_s, &weights, PERIOD_S).map_err(FlightError::Design)?;
        let (gain_in_parts, gain) = (found.gain_in_parts, found.gain);
        Ok(Self { name, vehicle: design.vehicle, lag_s, stated: Stated::all_at_once(stated_s), gain_in_parts, gain })
    }

    /// The factor by which thrust, roll and pitch together, and yaw, may each be strengthened or weakened at a stated lag.
    ///
    /// # Errors
    /// [`FlightError::Certify`] where a certificate cannot be computed.
    pub fn stated_margin(&self) -> Result<f64, FlightError> {
        largest_factor(&self.gain_in_parts, |scaled| self.stated.over(&self.vehicle, scaled, [3, 3]))
    }

    /// The same over [`Region::of_any_crazyflie`], with the lag of the design.
    ///
    /// # Errors
    /// As [`Self::stated_margin`].
    pub fn any_lag_margin(&self) -> Result<f64, FlightError> {
        let region = Region::of_any_crazyflie();
        largest_factor(&self.gain_in_parts, |scaled| {
            Ok(certify_region(&self.vehicle, scaled, self.lag_s, PERIOD_S, &region)?.spectral_radius)
        })
    }
}

/// The largest of `FACTORS` that a gain may be multiplied with or divided by, the spectral radius below 1; 1 where there
/// is none. Yaw is a chain of its own: by which of the others' factors it is multiplied makes no difference.
fn largest_factor(
    in_parts: &DMatrix<f64>,
    radius: impl Fn(&DMatrix<f64>) -> Result<f64, FlightError>,
) -> Result<f64, FlightError> {
    for factor in FACTORS {
        if radius(&(in_parts * factor))? < 1.0 && radius(&(in_parts / factor))? < 1.0 {
            return Ok(factor);
        }
    }
    Ok(1.0)
}

/// The source of `crazyflie/src/builtin/motor_gains.rs`.
///
/// # Errors
/// [`CodegenError`] where a craft has no design or no certificate.
pub fn motor_gains() -> Result<String, CodegenError> {
    let mut source = String::from(
        "//! Gains for motor forces of each craft: made by `cargo gains generate` and not edited by hand.\n\
         //!\n\
         //! With the lag that is stated each is certified for a true one off by a quarter, the mass off by 20 %, the inertia by\n\
         //! 30 % and 10 ms of delay, all at once, and with the feedback off by its factor; the last of each craft with none stated\n\
         //! for motor lags of 50 to 126 ms and the same.\n\n\
         use quatrack::law::ActuatorAwareGain;\n\n\
         use super::Design;\n",
    );
    for ((constant, _), designs) in CRAFTS.iter().zip(Design::of_crafts()?) {
        let [.., last] = &designs;
        let (name, id) = (last.vehicle.name(), vehicles::id(&last.vehicle));
        // Writing to a string does not fail.
        let _ = write!(source, "\n/// Vehicle id of {name}.\npub(super) const {constant}_ID: u32 = 0x{id:08x};\n");
        let any = (last.lag_s, last.any_lag_margin()?);
        let _ = write!(
            source,
            "\n/// With none stated: the lag (s) and the factor of the last one.\npub(super) const {constant}_ANY: (f32, f32) = {any:?};\n"
        );
        let _ = write!(source, "\n/// Of {name}.\npub(super) const {constant}: [Design; 3] = [\n");
        for design in designs {
            let (stated_s, margin) = (design.stated.lag_s, design.stated_margin()?);
            let _ = writeln!(
                source,
                "    Design {{ stated_s: {stated_s:?}, margin: {margin:?}, gain: ActuatorAwareGain::table(["
            );
            for row in design.gain.row_iter() {
                let entries: Vec<String> = row.iter().map(|entry| format!("{:?}", *entry as f32)).collect();
                let _ = writeln!(source, "        [{}],", entries.join(", "));
            }
            source.push_str("    ]) },\n");
        }
        source.push_str("];\n");
    }
    Ok(source)
}
