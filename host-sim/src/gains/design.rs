//! A design: what is written in its file in; a problem whose numbers are in range and belong together out.

use std::path::Path;

use quatrack::gains::table::{KNOTS_MAX, Name};
use quatrack::nalgebra::Vector3;
use quatrack::{Limits, Rate};
use serde::Serialize;

use super::file::{self, DesignFile, LimitsEntry, Linearisation, MethodName, MinimumEntry, Weights};
use super::{Course, GainsError};
use crate::certify::{Minimum, RegionBounds};
use crate::design::actuator_aware::ActuatorAwareWeights;
use crate::design::integral::IntegralWeights;
use crate::design::synthesis::{EquilibriumWeights, FlatWeights};
use crate::trajectory::Trajectory as _;
use crate::vehicle::Vehicle;

/// Most samples of known delay.
const MOST_DELAY_SAMPLES: u32 = 20;
/// Range of weights, of mu and of the rate loop's gain: far beyond any craft, and no product of them overflows.
const LARGEST: f64 = 1e9;
/// Shortest positive figure.
const SMALLEST: f64 = 1e-9;

/// A design that has been read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// Name of the design and of its table: that of the file.
    pub name: Name,
    /// What it is for, in its author's words.
    pub description: String,
    /// Whom it is for.
    pub vehicle: Vehicle,
    /// Model, method and what is asked of them.
    pub problem: Problem,
    /// Rate of the control loop.
    pub rate: Rate,
    /// Gain of the vehicle's body rate loop, 1/s, for lag limits behind it.
    pub rate_loop_gain_1_s: Option<f64>,
    /// What commands are cut to.
    pub limits: Limits,
    /// The least that its certificate must show.
    pub minimum: Minimum,
}

/// A linearisation with a method that is defined for it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Problem {
    /// The hover model (E-LTI), error `[x y z q1 q2 q3 vx vy vz]`, inputs `[T p q r]`.
    Equilibrium(Method<EquilibriumWeights>),
    /// The flat chain (F-LTI), `[r v a q3]`, inputs `[a j q3']`.
    FlatOutput(Method<FlatWeights>),
    /// The hover model with the sums of the position error, under held commands.
    Integral {
        /// Diagonals of Q and R, and of the integrals.
        weights: IntegralWeights,
    },
    /// The hover model of the vehicle down to its motors, under held commands.
    ActuatorAware {
        /// Lag of the motors that it is designed for, s.
        motor_lag_s: f64,
        /// Weights of a sum over the samples.
        weights: ActuatorAwareWeights,
        /// Where the gain must be stable, too.
        region: RegionBounds,
    },
    /// The error of the hover model about each point of a trajectory, under held commands: gains over time.
    Along {
        /// Diagonals of Q and R.
        weights: EquilibriumWeights,
        /// Which trajectory.
        trajectory: Course,
        /// Control steps from one knot to the next.
        steps_per_knot: u16,
    },
}

/// How the gain is computed.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Method<W> {
    /// Every pole in continuous time at real part -mu.
    Lyapunov {
        /// mu, 1/s.
        mu_1_s: f64,
    },
    /// Least `int x' Q x + u' R u dt` in continuous time.
    Lqr {
        /// Diagonals of Q and R.
        weights: W,
    },
    /// The same cost under commands held for a control period.
    SampledLqr {
        /// Diagonals of Q and R.
        weights: W,
        /// Whole samples by which commands act late.
        delay_samples: usize,
    },
}

impl Problem {
    /// Linearisation and method, as they are written in the file.
    pub fn named(&self) -> (&'static str, &'static str) {
        match self {
            Self::Equilibrium(method) => ("equilibrium", method.named()),
            Self::FlatOutput(method) => ("flat-output", method.named()),
            Self::Integral { .. } => ("equilibrium", "lqi"),
            Self::ActuatorAware { .. } => ("equilibrium", "actuator-aware"),
            Self::Along { .. } => ("equilibrium", "along"),
        }
    }

    /// The lag of the motors that a design for their forces reckons with, s.
    pub fn motor_lag_s(&self) -> Option<f64> {
        match self {
            Self::ActuatorAware { motor_lag_s, .. } => Some(*motor_lag_s),
            _ => None,
        }
    }

    /// Of gains over time the trajectory's checksum and the control steps from one knot to the next.
    pub fn schedule(&self) -> Option<(u32, u16)> {
        match self {
            Self::Along { trajectory, steps_per_knot, .. } => Some((trajectory.checksum(), *steps_per_knot)),
            _ => None,
        }
    }

    /// mu of a Lyapunov design, 1/s.
    pub fn mu_1_s(&self) -> Option<f64> {
        match self {
            Self::Equilibrium(Method::Lyapunov { mu_1_s }) | Self::FlatOutput(Method::Lyapunov { mu_1_s }) => {
                Some(*mu_1_s)
            }
            _ => None,
        }
    }
}

impl<W> Method<W> {
    fn named(&self) -> &'static str {
        match self {
            Self::Lyapunov { .. } => "lyapunov",
            Self::Lqr { .. } => "lqr",
            Self::SampledLqr { .. } => "sampled-lqr",
        }
    }
}

impl Design {
    /// Reads a design; paths in it are relative to its folder.
    ///
    /// # Errors
    /// [`GainsError`], with the key, its value and what it must be.
    pub fn from_file(path: &Path) -> Result<Self, GainsError> {
        let text =
            std::fs::read_to_string(path).map_err(|error| GainsError::Unreadable { reason: error.to_string() })?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        Self::from_toml(&name, &text, path.parent().unwrap_or(Path::new("")))
    }

    /// A design from the text of its file; paths in it are relative to `folder`.
    ///
    /// # Errors
    /// As [`Self::from_file`].
    pub fn from_toml(name: &str, text: &str, folder: &Path) -> Result<Self, GainsError> {
        let file = file::read(text)?;
        let name = Name::new(name).map_err(GainsError::Name)?;
        let vehicle = vehicle(&file.vehicle, folder)?;
        let rate = Rate::from_hz(file.control_rate_hz).ok_or_else(|| {
            let must = format!("from {} to {} control steps a second", Rate::MIN_HZ, Rate::MAX_HZ);
            GainsError::Value { key: "control_rate_hz".into(), value: file.control_rate_hz.to_string(), must }
        })?;
        if let Some(gain) = file.rate_loop_gain_1_s {
            positive("rate_loop_gain_1_s", gain)?;
        }
        Ok(Self {
            name,
            description: file.description.trim().to_owned(),
            problem: problem(&file, folder, rate)?,
            limits: limits(&file.limits, &vehicle, &file.vehicle)?,
            vehicle,
            rate,
            rate_loop_gain_1_s: file.rate_loop_gain_1_s,
            minimum: minimum(&file.minimum)?,
        })
    }
}

fn vehicle(written: &str, folder: &Path) -> Result<Vehicle, GainsError> {
    let refused = |reason: String| GainsError::Vehicle { vehicle: written.to_owned(), reason };
    let vehicle =
        if written.ends_with(".toml") { Vehicle::from_file(&folder.join(written)) } else { Vehicle::by_name(written) }
            .map_err(|error| refused(error.to_string()))?;
    Name::new(vehicle.name()).map_err(|error| refused(format!("its {error}")))?;
    Ok(vehicle)
}

fn check(holds: bool, key: &str, value: f64, must: impl Into<String>) -> Result<(), GainsError> {
    // A NaN makes every comparison false and so never passes.
    if holds {
        Ok(())
    } else {
        Err(GainsError::Value { key: key.to_owned(), value: value.to_string(), must: must.into() })
    }
}

fn positive(key: &str, value: f64) -> Result<(), GainsError> {
    check((SMALLEST..=LARGEST).contains(&value), key, value, format!("from {SMALLEST:e} to {LARGEST:e}"))
}

fn problem(file: &DesignFile, folder: &Path, rate: Rate) -> Result<Problem, GainsError> {
    let lyapunov = file.method == MethodName::Lyapunov;
    if let (Some(mu), false) = (file.mu_1_s, lyapunov) {
        return Err(misplaced("mu_1_s", &mu, &file.method));
    }
    if let (Some(delay), false) = (file.delay_samples, file.method == MethodName::SampledLqr) {
        return Err(misplaced("delay_samples", &delay, &file.method));
    }
    if let (Some(trajectory), false) = (&file.trajectory, file.method == MethodName::Along) {
        return Err(misplaced("trajectory", &format!("\"{trajectory}\""), &file.method));
    }
    if lyapunov {
        let mu_1_s = file.mu_1_s.ok_or_else(|| missing("mu_1_s", &file.method, "mu_1_s = 2.0"))?;
        positive("mu_1_s", mu_1_s)?;
        if file.weights.is_some() {
            return Err(misplaced("[weights]", &"...", &file.method));
        }
        return Ok(match file.linearisation {
            Linearisation::Equilibrium => Problem::Equilibrium(Method::Lyapunov { mu_1_s }),
            Linearisation::FlatOutput => Problem::FlatOutput(Method::Lyapunov { mu_1_s }),
        });
    }
    let weights = file.weights.as_ref().ok_or_else(|| missing("[weights]", &file.method, "[weights]"))?;
    let integrates = matches!(file.method, MethodName::Lqi | MethodName::ActuatorAware);
    if let (Some(weight), false) = (weights.position_integral, integrates) {
        return Err(misplaced("weights.position_integral", &format!("{weight:?}"), &file.method));
    }
    if file.method == MethodName::ActuatorAware {
        return actuator_aware(file, weights);
    }
    not_of_motors(file, weights)?;
    let delay_samples = file.delay_samples.unwrap_or(0);
    check(
        delay_samples <= MOST_DELAY_SAMPLES,
        "delay_samples",
        f64::from(delay_samples),
        format!("from 0 to {MOST_DELAY_SAMPLES}"),
    )?;
    let delay_samples = delay_samples as usize;
    if file.method == MethodName::Lqi {
        if file.linearisation == Linearisation::FlatOutput {
            return Err(misplaced("method", &"\"lqi\"", &file.linearisation));
        }
        let integral = weights
            .position_integral
            .ok_or_else(|| missing("weights.position_integral", &file.method, "three numbers, [x, y, z]"))?;
        integral.iter().try_for_each(|entry| positive("weights.position_integral", *entry))?;
        return Ok(Problem::Integral {
            weights: IntegralWeights { equilibrium: equilibrium_weights(weights)?, integral },
        });
    }
    if file.method == MethodName::Along {
        return along(file, weights, folder, rate);
    }
    Ok(match file.linearisation {
        Linearisation::Equilibrium => {
            Problem::Equilibrium(quadratic(file.method, equilibrium_weights(weights)?, delay_samples))
        }
        Linearisation::FlatOutput => Problem::FlatOutput(quadratic(file.method, flat_weights(weights)?, delay_samples)),
    })
}

/// Longest lag of motors, ms.
const LONGEST_LAG_MS: f64 = 1e3;
/// Delays in a region, ms: each period of it is a state a motor.
const LONGEST_DELAY_MS: f64 = 50.0;
/// Most that mass or inertia may be off, percent.
const MOST_PERCENT: f64 = 90.0;

fn actuator_aware(file: &DesignFile, weights: &Weights) -> Result<Problem, GainsError> {
    let here = &file.method;
    if file.linearisation == Linearisation::FlatOutput {
        return Err(misplaced("method", &here.quoted(), &file.linearisation));
    }
    if let Some(gain) = file.rate_loop_gain_1_s {
        return Err(misplaced("rate_loop_gain_1_s", &gain, here));
    }
    let lag = |key: &str, value: f64| {
        // The core wants two control periods at least.
        let least = 2e3 / f64::from(file.control_rate_hz.max(1));
        check((least..=LONGEST_LAG_MS).contains(&value), key, value, format!("from {least} to {LONGEST_LAG_MS} ms"))
    };
    let lag_ms = file.motor_lag_ms.ok_or_else(|| missing("motor_lag_ms", here, "motor_lag_ms = 126.0"))?;
    lag("motor_lag_ms", lag_ms)?;
    let example = "[region] with motor_lag_ms = [50.0, 126.0]";
    let region = file.region.ok_or_else(|| missing("[region]", here, example))?;
    let [shortest, longest] = region.motor_lag_ms;
    lag("region.motor_lag_ms", shortest)?;
    lag("region.motor_lag_ms", longest)?;
    check(shortest <= longest, "region.motor_lag_ms", longest, format!("at least the first, {shortest}"))?;
    let percent = |key: &str, value: f64| {
        check((0.0..=MOST_PERCENT).contains(&value), key, value, format!("from 0 to {MOST_PERCENT}"))
    };
    percent("region.mass_percent", region.mass_percent)?;
    percent("region.inertia_percent", region.inertia_percent)?;
    let delays = 0.0..=LONGEST_DELAY_MS;
    check(
        delays.contains(&region.delay_ms),
        "region.delay_ms",
        region.delay_ms,
        format!("from 0 to {LONGEST_DELAY_MS}"),
    )?;
    let foreign: [(&str, bool); 8] = [
        ("attitude", weights.attitude.is_some()),
        ("acceleration", weights.acceleration.is_some()),
        ("q3", weights.q3.is_some()),
        ("thrust_input", weights.thrust_input.is_some()),
        ("body_rate_input", weights.body_rate_input.is_some()),
        ("acceleration_input", weights.acceleration_input.is_some()),
        ("jerk_input", weights.jerk_input.is_some()),
        ("q3_rate_input", weights.q3_rate_input.is_some()),
    ];
    if let Some((key, _)) = foreign.iter().find(|(_, given)| *given) {
        return Err(misplaced(&format!("weights.{key}"), &"...", here));
    }
    let group = |key: &str, value: Option<[f64; 3]>| {
        let value = value.ok_or_else(|| missing(&format!("weights.{key}"), here, "three numbers, [x, y, z]"))?;
        value.iter().try_for_each(|entry| weight(key, *entry)).map(|()| value)
    };
    let command = weights.force_input.ok_or_else(|| missing("weights.force_input", here, "a number"))?;
    weight("force_input", command)?;
    Ok(Problem::ActuatorAware {
        motor_lag_s: 1e-3 * lag_ms,
        weights: ActuatorAwareWeights {
            position: group("position", weights.position)?,
            velocity: group("velocity", weights.velocity)?,
            rotation: group("rotation", weights.rotation)?,
            body_rates: group("body_rates", weights.body_rates)?,
            force: 0.0,
            integral: group("position_integral", weights.position_integral)?,
            command,
        },
        region: RegionBounds {
            lag_s: region.motor_lag_ms.map(|lag_ms| 1e-3 * lag_ms),
            mass_share: 1e-2 * region.mass_percent,
            inertia_share: 1e-2 * region.inertia_percent,
            delay_s: 1e-3 * region.delay_ms,
        },
    })
}

/// Keys that only a design for motors has.
fn not_of_motors(file: &DesignFile, weights: &Weights) -> Result<(), GainsError> {
    let foreign: [(&str, bool); 5] = [
        ("motor_lag_ms", file.motor_lag_ms.is_some()),
        ("[region]", file.region.is_some()),
        ("weights.rotation", weights.rotation.is_some()),
        ("weights.body_rates", weights.body_rates.is_some()),
        ("weights.force_input", weights.force_input.is_some()),
    ];
    match foreign.iter().find(|(_, given)| *given) {
        Some((key, _)) => Err(misplaced(key, &"...", &file.method)),
        None => Ok(()),
    }
}

/// As many knots as a table holds.
fn along(file: &DesignFile, weights: &Weights, folder: &Path, rate: Rate) -> Result<Problem, GainsError> {
    if file.linearisation == Linearisation::FlatOutput {
        return Err(misplaced("method", &file.method.quoted(), &file.linearisation));
    }
    let weights = equilibrium_weights(weights)?;
    if let Some(weight) = weights.state.iter().find(|weight| **weight <= 0.0) {
        let must = "above 0 for each error with method = \"along\": what costs nothing need not decrease";
        return Err(GainsError::Value { key: "weights".into(), value: weight.to_string(), must: must.into() });
    }
    let written = file
        .trajectory
        .as_ref()
        .ok_or_else(|| missing("trajectory", &file.method, "trajectory = \"aggressive\", or the path of a file"))?;
    let trajectory = Course::named(written, folder)?;
    let steps = (trajectory.trajectory().duration_s() * f64::from(rate.hz())).ceil();
    let steps_per_knot = (steps / (KNOTS_MAX - 1) as f64).ceil().max(1.0);
    if steps_per_knot > f64::from(u16::MAX) {
        return Err(GainsError::Value {
            key: "trajectory".into(),
            value: format!("\"{written}\""),
            must: format!("shorter than {} control steps", u32::from(u16::MAX) * (KNOTS_MAX as u32 - 1)),
        });
    }
    Ok(Problem::Along { weights, trajectory, steps_per_knot: steps_per_knot as u16 })
}

/// One of the two methods that are defined for both linearisations and have weights.
fn quadratic<W>(name: MethodName, weights: W, delay_samples: usize) -> Method<W> {
    if name == MethodName::Lqr { Method::Lqr { weights } } else { Method::SampledLqr { weights, delay_samples } }
}

fn misplaced(key: &str, value: &dyn ToString, with: &dyn ToString) -> GainsError {
    GainsError::Misplaced { key: key.to_owned(), value: value.to_string(), with: with.to_string() }
}

fn missing(key: &str, with: &dyn ToString, example: &'static str) -> GainsError {
    GainsError::Missing { key: key.to_owned(), with: with.to_string(), example }
}

fn equilibrium_weights(weights: &Weights) -> Result<EquilibriumWeights, GainsError> {
    let here = Linearisation::Equilibrium;
    absent("acceleration", weights.acceleration, here)?;
    absent("q3", weights.q3, here)?;
    absent("acceleration_input", weights.acceleration_input, here)?;
    absent("jerk_input", weights.jerk_input, here)?;
    absent("q3_rate_input", weights.q3_rate_input, here)?;
    let [x, y, z] = triple("position", weights.position, here)?;
    let [q1, q2, q3] = triple("attitude", weights.attitude, here)?;
    let [vx, vy, vz] = triple("velocity", weights.velocity, here)?;
    let thrust = single("thrust_input", weights.thrust_input, here)?;
    let [p, q, r] = triple("body_rate_input", weights.body_rate_input, here)?;
    Ok(EquilibriumWeights { state: [x, y, z, q1, q2, q3, vx, vy, vz], input: [thrust, p, q, r] })
}

fn flat_weights(weights: &Weights) -> Result<FlatWeights, GainsError> {
    let here = Linearisation::FlatOutput;
    absent("attitude", weights.attitude, here)?;
    absent("thrust_input", weights.thrust_input, here)?;
    absent("body_rate_input", weights.body_rate_input, here)?;
    let [x, y, z] = triple("position", weights.position, here)?;
    let [vx, vy, vz] = triple("velocity", weights.velocity, here)?;
    let [ax, ay, az] = triple("acceleration", weights.acceleration, here)?;
    let q3 = single("q3", weights.q3, here)?;
    let [ux, uy, uz] = triple("acceleration_input", weights.acceleration_input, here)?;
    let [jx, jy, jz] = triple("jerk_input", weights.jerk_input, here)?;
    let rate = single("q3_rate_input", weights.q3_rate_input, here)?;
    Ok(FlatWeights { state: [x, y, z, vx, vy, vz, ax, ay, az, q3], input: [ux, uy, uz, jx, jy, jz, rate] })
}

fn absent(key: &str, value: Option<impl std::fmt::Debug>, here: Linearisation) -> Result<(), GainsError> {
    value.map_or(Ok(()), |value| Err(misplaced(&format!("weights.{key}"), &format!("{value:?}"), &here)))
}

fn triple(key: &str, value: Option<[f64; 3]>, here: Linearisation) -> Result<[f64; 3], GainsError> {
    let value = value.ok_or_else(|| missing(&format!("weights.{key}"), &here, "three numbers, [x, y, z]"))?;
    value.iter().try_for_each(|entry| weight(key, *entry))?;
    Ok(value)
}

fn single(key: &str, value: Option<f64>, here: Linearisation) -> Result<f64, GainsError> {
    let value = value.ok_or_else(|| missing(&format!("weights.{key}"), &here, "a number"))?;
    weight(key, value)?;
    Ok(value)
}

/// A state may go without a weight; whether that leaves a mode unseen is for the solver to say. An input may not.
fn weight(key: &str, value: f64) -> Result<(), GainsError> {
    let name = format!("weights.{key}");
    if key.ends_with("_input") { positive(&name, value) } else { non_negative(&name, value) }
}

fn non_negative(key: &str, value: f64) -> Result<(), GainsError> {
    let holds = value == 0.0 || (SMALLEST..=LARGEST).contains(&value);
    check(holds, key, value, format!("0, or from {SMALLEST:e} to {LARGEST:e}"))
}

/// The vehicle's limits, or tighter ones.
fn limits(entry: &LimitsEntry, vehicle: &Vehicle, written: &str) -> Result<Limits, GainsError> {
    let refused = |reason: String| GainsError::Vehicle { vehicle: written.to_owned(), reason };
    let whole = vehicle.limits().map_err(|error| refused(error.to_string()))?;
    let (least, most) = (f64::from(whole.thrust_min_m_s2()), f64::from(whole.thrust_max_m_s2()));
    let min = entry.thrust_min_m_s2.unwrap_or(least);
    let max = entry.thrust_max_m_s2.unwrap_or(most);
    let hover = crate::model::GRAVITY_M_S2;
    check((least..hover).contains(&min), "limits.thrust_min_m_s2", min, format!("from {least} to below g = {hover}"))?;
    check(max > hover && max <= most, "limits.thrust_max_m_s2", max, format!("above g = {hover}, up to {most}"))?;
    let held = whole.body_rates_max_rad_s().map(f64::from);
    let rates = entry.body_rates_max_rad_s.map_or(held, Vector3::from);
    for (rate, most) in rates.iter().zip(held.iter()) {
        check(*rate > 0.0 && rate <= most, "limits.body_rates_max_rad_s", *rate, format!("above 0, up to {most}"))?;
    }
    Limits::new(min as f32, max as f32, rates.map(|rate| rate as f32)).map_err(|error| refused(error.to_string()))
}

fn minimum(entry: &MinimumEntry) -> Result<Minimum, GainsError> {
    let within = |key: &str, value: Option<f64>, above: f64, most: f64| {
        value.map_or(Ok(()), |value| {
            let must = format!("above {above}, up to {most}; leave it out to ask for nothing");
            check(value > above && value <= most, &format!("minimum.{key}"), value, must)
        })
    };
    within("gain_factor_each", entry.gain_factor_each, 1.0, 1e3)?;
    within("gain_factor_all", entry.gain_factor_all, 1.0, 1e3)?;
    within("phase_each_deg", entry.phase_each_deg, 0.0, 180.0)?;
    within("phase_all_deg", entry.phase_all_deg, 0.0, 180.0)?;
    within("delay_ms", entry.delay_ms, 0.0, 1e4)?;
    within("motor_lag_ms", entry.motor_lag_ms, 0.0, 1e4)?;
    within("decay_1_s", entry.decay_1_s, 0.0, 1e4)?;
    Ok(Minimum {
        gain_factor_each: entry.gain_factor_each,
        gain_factor_all: entry.gain_factor_all,
        phase_each_rad: entry.phase_each_deg.map(f64::to_radians),
        phase_all_rad: entry.phase_all_deg.map(f64::to_radians),
        delay_s: entry.delay_ms.map(|value| value * 1e-3),
        lag_s: entry.motor_lag_ms.map(|value| value * 1e-3),
        decay_1_s: entry.decay_1_s,
        ..Minimum::default()
    })
}
