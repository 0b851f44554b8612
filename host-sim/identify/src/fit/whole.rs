//! All figures of a craft from its flights: checked flights in; every figure with a 95 % interval, or the reason why it
//! is not known, out.

use std::collections::BTreeMap;

use nalgebra::{DVector, Vector3};

use super::balance::{Balance, balance};
use super::balanced;
use super::bootstrap::{Dice, few_units};
use super::drag::{Regression, drag};
use super::lag_curve::{LagPoint, lag_curve, most_explained};
use super::layout::{
    ASYMMETRY, COMMAND_POWER, DAMPING, DELAY, DRAG_Z, Found, INERTIA, LAG, LIFT, MOMENT, SHARED, VOLTAGE_POWER,
    drive_of, start,
};
use super::posterior::{EXPLAINED_LEAST, Posterior};
use super::prior::Base;
use super::problem::{Drive, Prepared, prepared};
use super::yaw::Yaw;
use crate::IdentifyError;
use crate::filter::{mean, quantile};
use crate::flight::{Flight, STEP_S};
use quatrack_design::model::GRAVITY_M_S2;

/// A figure with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Most likely.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Figures that differ from flight to flight.
#[derive(Clone, Debug, PartialEq)]
pub struct FlightFit {
    /// Thrust over mass that a full command gives at the reference voltage, m/s^2.
    pub full_m_s2: f64,
    /// Torque that is always there, N m.
    pub torque_bias_n_m: Vector3<f64>,
    /// Bias of the accelerometer, m/s^2.
    pub force_bias_m_s2: Vector3<f64>,
    /// Bias of the gyroscope, rad/s.
    pub gyro_bias_rad_s: Vector3<f64>,
}

/// Figures as the prediction takes them, whether or not they are known well enough to be told.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Model {
    pub(crate) drive: Drive,
    pub(crate) inertia: [f64; 3],
    pub(crate) moment: [f64; 2],
    pub(crate) damping: [f64; 3],
    pub(crate) drag: [f64; 3],
    pub(crate) lift: f64,
    pub(crate) yaw_lead_s: f64,
}

/// All that was found.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The vehicle's figures that it was found with.
    pub base: Base,
    /// By name; where one is not known, why and which manoeuvre would tell.
    pub figures: BTreeMap<&'static str, Result<Estimate, String>>,
    /// How much of the torques a lag explains.
    pub lag_curve: Vec<LagPoint>,
    /// Flight by flight.
    pub flights: Vec<FlightFit>,
    /// Explained share of the torques about x and y, of the thrust's variation, of the drag along x and y.
    pub explained: [f64; 5],
    /// Torques along a stretch of flight.
    pub balance: Option<Balance>,
    pub(crate) model: Model,
}

/// Identifies.
///
/// # Errors
/// [`IdentifyError::TooLittle`] where no section is long enough.
pub fn fit(flights: &[Flight], base: &Base) -> Result<Fit, IdentifyError> {
    let sections = prepared(flights, base);
    let points: usize = sections.iter().map(|one| one.inner.len()).sum();
    if points < 800 {
        return Err(IdentifyError::TooLittle(format!(
            "{:.0} s of flight in all logs: at least 8 s are needed; fly 10 s of hover, 20 s of steps between corners, 30 s of smooth flight",
            points as f64 * STEP_S
        )));
    }
    let voltage = flights.iter().all(|flight| flight.has_voltage);
    let drags = [drag(&sections, 0), drag(&sections, 1)];
    let curve = lag_curve(&sections, base, base.delay_s, base.powers);
    let fixed = if voltage { vec![ASYMMETRY] } else { vec![ASYMMETRY, VOLTAGE_POWER] };
    let (filler, priors) = start(base, &found(&sections, base, &curve, &drags));
    let begin = balanced::start(&sections, base, flights.len(), &curve, &drags, fixed.clone());
    let mut posterior = Posterior::balanced(&sections, base, begin, &fixed, &filler);
    let rough = summary(&sections, base, &posterior.values, &drags);
    if 0.5 * (rough.explained[0] + rough.explained[1]) > EXPLAINED_LEAST {
        let filtered = Posterior::filtered(&sections, base, flights.len(), &posterior.values, priors, &fixed);
        posterior = filtered.unwrap_or(posterior);
    }
    let Summary { full, yaws, model, explained: [x, y, thrust] } = summary(&sections, base, &posterior.values, &drags);
    if ![x, y, thrust].iter().all(|share| share.is_finite()) {
        return Err(IdentifyError::TooLittle(
            "nothing that is a number comes out of these logs; check the map's columns, or give the logs one by one"
                .to_owned(),
        ));
    }
    let flight_fits = flight_fits(&sections, base, &model, &full);
    let mut figures = Figures { base, all: BTreeMap::new(), spread: few_units(&posterior.blocks) };
    figures.refined(&posterior, voltage);
    figures.apart(&sections, base, &posterior, voltage);
    figures.drag(&drags);
    figures.yaw(&yaws);
    figures.biases(&flight_fits);
    figures.turning([x, y, thrust], yaws.forward.explained);
    let explained = [x, y, thrust, drags[0].explained, drags[1].explained];
    Ok(Fit {
        base: base.clone(),
        figures: figures.all,
        lag_curve: curve,
        explained,
        balance: balance(flights, &sections, base, &model, &flight_fits),
        flights: flight_fits,
        model,
    })
}

fn variance(signal: &[f64]) -> f64 {
    let m = mean(signal);
    mean(&signal.iter().map(|v| (v - m).powi(2)).collect::<Vec<_>>())
}

/// Share of the mixtures about x and y and of the thrust that the balances explain below the corner.
fn explained(sections: &[Prepared], base: &Base, model: &Model, full: &[f64]) -> [f64; 3] {
    let (mut whole, mut rest) = ([0.0; 3], [0.0; 3]);
    let mut add = |kind: usize, all: &[f64], left: &[f64]| {
        whole[kind] += all.iter().map(|v| v * v).sum::<f64>();
        rest[kind] += left.iter().map(|v| v * v).sum::<f64>();
    };
    for one in sections {
        let driven = one.drive(&model.drive);
        let full = full[one.flight];
        for axis in 0..2 {
            let arm_n_m = 0.25 * base.mass_kg * full * base.half_arm_m;
            let torque: Vec<f64> = one.centred(&driven.mixture[axis]).iter().map(|m| arm_n_m * m).collect();
            let (angular, across, rates) =
                (one.centred(&one.angular[axis]), one.centred(&one.velocity[1 - axis]), one.centred(&one.rates[axis]));
            let moment = if axis == 0 { -model.moment[0] } else { model.moment[1] };
            let left: Vec<f64> = (0..torque.len())
                .map(|i| {
                    torque[i] - model.inertia[axis] * angular[i] - moment * across[i] - model.damping[axis] * rates[i]
                })
                .collect();
            add(axis, &torque, &left);
        }
        let felt = one.centred(&one.force[2]);
        let (given, up, across) = (one.centred(&driven.mean), one.centred(&one.velocity[2]), one.centred(&one.across));
        let left: Vec<f64> = (0..felt.len())
            .map(|i| felt[i] - full * given[i] + model.drag[2] * up[i] - model.lift * across[i])
            .collect();
        add(2, &felt, &left);
    }
    std::array::from_fn(|kind| 1.0 - rest[kind] / whole[kind].max(1e-12))
}

/// Figures that follow from the values.
struct Summary {
    full: Vec<f64>,
    yaws: Yaw,
    model: Model,
    explained: [f64; 3],
}

fn summary(sections: &[Prepared], base: &Base, values: &DVector<f64>, drags: &[Regression; 2]) -> Summary {
    let full: Vec<f64> = values.iter().skip(SHARED).map(|full| full.exp()).collect();
    let drive = drive_of(values);
    let yaws = Yaw::of(sections, base, &drive, &full);
    let model = model(values, drags, &yaws.forward);
    let explained = explained(sections, base, &model, &full);
    Summary { full, yaws, model, explained }
}

/// From the best lag of the curve, the vehicle's own powers, and the thrust that carries the craft.
fn found(sections: &[Prepared], base: &Base, curve: &[LagPoint], drags: &[Regression; 2]) -> Found {
    let best = most_explained(curve);
    let lag_s = best.lag_s.min(0.12);
    let drive = Drive { rise_s: lag_s, fall_s: lag_s, delay_s: base.delay_s, jump_s: 0.0, powers: base.powers };
    let (mut felt, mut given) = (0.0, 0.0);
    for one in sections {
        let driven = one.drive(&drive);
        felt += one.inner.clone().map(|i| one.force[2][i]).sum::<f64>();
        given += one.inner.clone().map(|i| driven.mean[i]).sum::<f64>();
    }
    let arm_n_m = 0.25 * base.mass_kg * (felt / given.max(1e-9)).max(1e-3) * base.half_arm_m;
    // Of white noise the second difference has six times the variance.
    let white = |signals: &dyn Fn(&Prepared) -> [&Vec<f64>; 2]| -> f64 {
        let all: Vec<f64> = sections
            .iter()
            .flat_map(|one| {
                signals(one).map(|signal| {
                    mean(&signal.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).powi(2)).collect::<Vec<_>>()) / 6.0
                })
            })
            .collect();
        mean(&all).sqrt().max(1e-3)
    };
    Found {
        lag_s,
        inertia: [0, 1].map(|axis| {
            let believed = base.inertia_kg_m2[axis];
            (arm_n_m * best.inertia[axis]).clamp(0.5 * believed, 2.0 * believed)
        }),
        moment: [0, 1].map(|axis| arm_n_m * best.moment[axis]),
        drag: [0, 1].map(|axis| drags[axis].values[0]),
        sensors: [
            white(&|one| [&one.logged.rates[0], &one.logged.rates[1]]),
            white(&|one| [&one.logged.force[0], &one.logged.force[1]]),
        ],
    }
}

fn model(values: &DVector<f64>, drags: &[Regression; 2], yaws: &Regression) -> Model {
    Model {
        drive: drive_of(values),
        inertia: [values[INERTIA[0]].exp(), values[INERTIA[1]].exp(), yaws.values[0].max(1e-9)],
        moment: MOMENT.map(|j| values[j]),
        damping: [values[DAMPING[0]], values[DAMPING[1]], yaws.values[1].max(0.0)],
        drag: [drags[0].values[0], drags[1].values[0], values[DRAG_Z]],
        lift: values[LIFT],
        yaw_lead_s: yaws.values[2].max(0.0),
    }
}

/// Biases of each flight: the mean residuals of the balances.
fn flight_fits(sections: &[Prepared], base: &Base, model: &Model, full: &[f64]) -> Vec<FlightFit> {
    full.iter()
        .enumerate()
        .map(|(flight, full)| {
            let (mut torque, mut force, mut gyro, mut points) =
                (Vector3::zeros(), Vector3::zeros(), Vector3::zeros(), 0.0);
            for one in sections.iter().filter(|one| one.flight == flight) {
                let count = one.inner.len() as f64;
                torque += section_bias(one, base, model, *full) * count;
                force += one.force_bias * count;
                gyro += one.gyro_bias * count;
                points += count;
            }
            let points = f64::max(points, 1.0);
            FlightFit {
                full_m_s2: *full,
                torque_bias_n_m: torque / points,
                force_bias_m_s2: force / points,
                gyro_bias_rad_s: gyro / points,
            }
        })
        .collect()
}

/// Torque that a section needs beyond that of its motors, N m.
fn section_bias(one: &Prepared, base: &Base, model: &Model, full: f64) -> Vector3<f64> {
    let driven = one.drive(&model.drive);
    let newton = 0.25 * base.mass_kg * full;
    let arms = [newton * base.half_arm_m, newton * base.half_arm_m, newton * base.torque_per_thrust_m];
    let average = |signal: &[f64]| mean(&signal[one.inner.clone()]);
    let moments = [model.moment[0] * average(&one.velocity[1]), -model.moment[1] * average(&one.velocity[0]), 0.0];
    Vector3::from_fn(|axis, _| {
        let rate = average(&one.rates[axis]) - one.gyro_bias[axis];
        model.inertia[axis] * average(&one.angular[axis]) + model.damping[axis] * rate
            - moments[axis]
            - arms[axis] * average(&driven.mixture[axis])
    })
}

struct Figures<'a> {
    base: &'a Base,
    all: BTreeMap<&'static str, Result<Estimate, String>>,
    spread: f64,
}

/// Systematic errors of figures, as a share and at 95 %, on simulated crafts whose flights are as long as one likes:
/// attitude and velocity are of an estimator that does not know of drag, and the course of a command between its samples
/// is not in the log.
const SYSTEMATIC: [(&str, f64); 8] = [
    ("lag_", 0.11),
    ("command_power", 0.07),
    ("inertia_z", 0.16),
    ("inertia_", 0.08),
    ("drag_", 0.07),
    ("moment_", 0.08),
    ("thrust_", 0.05),
    ("hover_command", 0.02),
];

/// What no body and no motor has less of than nothing.
const POSITIVE: [&str; 6] = ["lag_", "inertia_", "rotor_inertia", "command_power", "thrust_", "hover_command"];

/// Share of the torques about an axis that has to be explained before anything is told of them: less, and the flight is at rest, or its
/// columns are not what the map says.
const TORQUES_LEAST: f64 = 0.5;

const STEPS: &str = "fly 20 s of steps between corners, which turn the craft fast";
const SPEED: &str = "fly 30 s at 1 m/s and more in both directions";
const CLIMBS: &str = "fly climbs and drops of 0.5 m and more, as fast as they go";
const DISCHARGE: &str = "log the battery's voltage over a few minutes, or two flights, one with a full battery";
const TURNS: &str = "turn the heading by 90 degrees and back, fast, a few times";

impl Figures<'_> {
    fn put(&mut self, name: &'static str, value: f64, draws: &[f64], most: f64, manoeuvre: &str) {
        let mut estimate = interval(value, draws, self.spread);
        let half = 0.5 * (estimate.high - estimate.low);
        let positive = POSITIVE.iter().any(|start| name.starts_with(start));
        let told = half <= most && half.is_finite() && value.is_finite() && !(positive && estimate.low <= 0.0);
        if let Some((_, share)) = SYSTEMATIC.iter().find(|(start, _)| name.starts_with(start)) {
            // Errors of estimator and model, which drawing blocks of the same flight does not show.
            let more = share * value.abs();
            estimate.low = value - (value - estimate.low).hypot(more);
            estimate.high = value + (estimate.high - value).hypot(more);
        }
        let refused =
            || format!("+-{half:.2e} about {value:.3e} at 95 %, and no more than +-{most:.2e} is told: {manoeuvre}");
        self.all.insert(name, if told { Ok(estimate) } else { Err(refused()) });
    }

    /// Refuses a figure that what was believed before the flight tells, and not the flight.
    fn excited(&mut self, posterior: &Posterior, name: &'static str, j: usize, most: f64, manoeuvre: &str) {
        let by_data = 1.96 * posterior.by_data(j);
        if by_data > most {
            let reason = format!("this flight does not tell it, at most +-{most:.2e} at 95 % would: {manoeuvre}");
            self.all.insert(name, Err(reason));
        }
    }

    /// Refuses what torques tell about axes whose torques are not explained.
    fn turning(&mut self, explained: [f64; 3], yaw: f64) {
        let shares = [("x", explained[0]), ("y", explained[1]), ("z", yaw)];
        for (axis, share) in shares.into_iter().filter(|(_, share)| *share < TORQUES_LEAST) {
            let manoeuvre = if axis == "z" { TURNS } else { STEPS };
            let names = self.all.keys().filter(|name| {
                let turns = ["inertia_", "moment_", "rate_damping_"].iter().any(|start| name.starts_with(start));
                turns && name.split('_').any(|part| part == axis) || axis == "z" && name.starts_with("rotor_")
            });
            for name in names.copied().collect::<Vec<_>>() {
                let reason = format!(
                    "the motors explain {share:.2} of the torque about {axis}, {TORQUES_LEAST} is the least: {manoeuvre}"
                );
                self.all.insert(name, Err(reason));
            }
        }
        if explained[0].max(explained[1]) < TORQUES_LEAST {
            for name in ["lag_ms", "lag_rise_ms", "lag_fall_ms", "delay_ms"] {
                let reason = format!("the motors explain less than {TORQUES_LEAST} of the torques: {STEPS}");
                self.all.insert(name, Err(reason));
            }
        }
    }

    fn refined(&mut self, posterior: &Posterior, voltage: bool) {
        let Posterior { values, draws, .. } = posterior;
        let of = |f: &dyn Fn(&DVector<f64>) -> f64| -> (f64, Vec<f64>) { (f(values), draws.iter().map(f).collect()) };
        let flights = values.len() - SHARED;
        let mass = self.base.mass_kg;
        let (lag, all) = of(&|v| 1e3 * v[LAG].exp());
        self.put("lag_ms", lag, &all, 0.3 * lag, STEPS);
        self.excited(posterior, "lag_ms", LAG, 0.4, STEPS);
        let (delay, all) = of(&|v| 1e3 * v[DELAY]);
        self.put("delay_ms", delay, &all, 8.0, STEPS);
        // The course of a command between two samples is not in the log: half a sample to either side.
        if let Some(Ok(delay)) = self.all.get_mut("delay_ms") {
            delay.low -= 500.0 * STEP_S;
            delay.high += 500.0 * STEP_S;
        }
        let (power, all) = of(&|v| v[COMMAND_POWER]);
        self.put("command_power", power, &all, 0.3, CLIMBS);
        self.excited(posterior, "command_power", COMMAND_POWER, 0.5, CLIMBS);
        if voltage {
            let (power, all) = of(&|v| v[VOLTAGE_POWER]);
            self.put("voltage_power", power, &all, 0.4, DISCHARGE);
            self.excited(posterior, "voltage_power", VOLTAGE_POWER, 0.5, DISCHARGE);
        } else {
            self.all.insert("voltage_power", Err(format!("the log has no voltage: {DISCHARGE}")));
        }
        let full = |v: &DVector<f64>| (SHARED..v.len()).map(|j| v[j]).sum::<f64>() / flights as f64;
        let (per_mass, mut all) = of(&|v| full(v).exp());
        self.between_flights(values, &mut all);
        self.put("thrust_per_mass_m_s2", per_mass, &all, 0.2 * per_mass, CLIMBS);
        let newton: Vec<f64> = all.iter().map(|a| 0.25 * mass * a).collect();
        self.put("thrust_full_n", 0.25 * mass * per_mass, &newton, 0.05 * mass * per_mass, CLIMBS);
        // A full command is not flown: what it gives is what the power makes of the thrust at hover.
        if self.all.get("command_power").is_none_or(Result::is_err) {
            for name in ["thrust_per_mass_m_s2", "thrust_full_n"] {
                self.all.insert(
                    name,
                    Err(format!("the power of the command is not told, by which it follows from hover: {CLIMBS}")),
                );
            }
        }
        // At the reference voltage.
        let hover = |v: &DVector<f64>| (GRAVITY_M_S2 / full(v).exp()).powf(1.0 / v[COMMAND_POWER]);
        let (command, all) = of(&hover);
        self.put("hover_command", command, &all, 0.1, CLIMBS);
        let (drag, all) = of(&|v| v[DRAG_Z]);
        self.put("drag_z_per_s", drag, &all, 0.2, CLIMBS);
        let (lift, all) = of(&|v| v[LIFT]);
        self.put("lift_per_m", lift, &all, 0.05, SPEED);
        for (axis, [inertia, moment, damping]) in [
            ["inertia_x_kg_m2", "moment_x_n_m_per_m_s", "rate_damping_x_n_m_s"],
            ["inertia_y_kg_m2", "moment_y_n_m_per_m_s", "rate_damping_y_n_m_s"],
        ]
        .into_iter()
        .enumerate()
        {
            let (value, all) = of(&|v| v[INERTIA[axis]].exp());
            self.put(inertia, value, &all, 0.2 * value, STEPS);
            self.excited(posterior, inertia, INERTIA[axis], 0.3, STEPS);
            let (value, all) = of(&|v| v[MOMENT[axis]]);
            let most = (0.25 * value.abs()).max(2e-3 * self.base.half_arm_m * self.base.mass_kg);
            self.put(moment, value, &all, most, SPEED);
            let (value, all) = of(&|v| v[DAMPING[axis]]);
            self.put(damping, value, &all, 0.4 * self.base.damping_scale(), STEPS);
        }
    }

    /// Batteries and motors differ from flight to flight: the uncertainty of the mean of all of them.
    fn between_flights(&self, values: &DVector<f64>, draws: &mut [f64]) {
        let logs: Vec<f64> = values.iter().skip(SHARED).copied().collect();
        let deviation = (variance(&logs) / (logs.len().max(2) - 1) as f64).sqrt();
        let mut dice = Dice::new();
        draws.iter_mut().for_each(|draw| *draw *= (deviation * dice.normal()).exp());
    }

    /// Rise and fall, where the flights tell them apart.
    fn apart(&mut self, sections: &[Prepared], base: &Base, one: &Posterior, voltage: bool) {
        let fixed = if voltage { Vec::new() } else { vec![VOLTAGE_POWER] };
        let Some(refined) = one.again(sections, base, &fixed) else { return };
        let draws = &refined.draws;
        let asymmetry =
            interval(refined.values[ASYMMETRY], &draws.iter().map(|v| v[ASYMMETRY]).collect::<Vec<_>>(), self.spread);
        for (name, sign) in [("lag_rise_ms", 0.5), ("lag_fall_ms", -0.5)] {
            let of = |v: &DVector<f64>| 1e3 * (v[LAG] + sign * v[ASYMMETRY]).exp();
            let value = of(&refined.values);
            let all: Vec<f64> = draws.iter().map(of).collect();
            self.put(name, value, &all, 0.3 * value, STEPS);
            if asymmetry.low <= 0.0 && asymmetry.high >= 0.0 {
                self.all.insert(name, Err(format!("rise and fall are not told apart, lag_ms is for both: {STEPS}")));
            }
        }
    }

    fn drag(&mut self, drags: &[Regression; 2]) {
        for (name, regression) in ["drag_x_per_s", "drag_y_per_s"].into_iter().zip(drags) {
            let value = regression.values[0];
            let all: Vec<f64> = regression.draws().iter().map(|v| v[0]).collect();
            self.put(name, value, &all, (0.25 * value.abs()).max(0.05), SPEED);
        }
    }

    fn yaw(&mut self, yaws: &Yaw) {
        const ROTORS: &str = "rotor_inertia_kg_m2";
        let Some([least, most]) = yaws.bracket() else {
            let reason = format!("torque by motion and motion by torque give {} about z: {TURNS}", yaws.told());
            for name in ["inertia_z_kg_m2", "rate_damping_z_n_m_s", "rotor_lead_ms", ROTORS] {
                self.all.insert(name, Err(reason.clone()));
            }
            return;
        };
        let draws = yaws.forward.draws();
        let values = &yaws.forward.values;
        let column = |j: usize, factor: f64| -> Vec<f64> { draws.iter().map(|v| factor * v[j]).collect() };
        // The middle of both by ratio; the interval holds both.
        let inertia = (least * most).sqrt();
        let name = "inertia_z_kg_m2";
        self.put(name, inertia, &column(0, inertia / values[0]), 0.25 * inertia, TURNS);
        if let Some(Ok(estimate)) = self.all.get_mut(name) {
            (estimate.low, estimate.high) = (estimate.low.min(least), estimate.high.max(most));
        }
        self.put("rate_damping_z_n_m_s", values[1], &column(1, 1.0), 0.4 * self.base.damping_scale(), TURNS);
        self.put("rotor_lead_ms", 1e3 * values[2], &column(2, 1e3), 15.0, TURNS);
        let Some(thrust_n_s2) = self.base.thrust_n_s2 else {
            let reason =
                format!("{} has no thrust_n_s2 in [propeller], which turns a lead into an inertia", self.base.name);
            self.all.insert(ROTORS, Err(reason));
            return;
        };
        // J_r = 2 k W kappa L, with W the speed at hover.
        let speed = (0.25 * self.base.mass_kg * GRAVITY_M_S2 / thrust_n_s2).sqrt();
        let factor = 2.0 * thrust_n_s2 * speed * self.base.torque_per_thrust_m;
        self.put(ROTORS, factor * values[2], &column(2, factor), 0.4 * (factor * values[2]).abs(), TURNS);
    }

    fn biases(&mut self, flights: &[FlightFit]) {
        let of = |f: &dyn Fn(&FlightFit) -> f64| -> Estimate {
            let all: Vec<f64> = flights.iter().map(f).collect();
            let value = mean(&all);
            let deviation = (variance(&all) * all.len() as f64 / (all.len().max(2) - 1) as f64).sqrt();
            Estimate { value, low: value - 1.96 * deviation, high: value + 1.96 * deviation }
        };
        let one = "one flight does not tell a bias from its change: give more flights";
        for (axis, names) in [
            ["torque_bias_x_n_m", "gyro_bias_x_rad_s", "accelerometer_bias_x_m_s2"],
            ["torque_bias_y_n_m", "gyro_bias_y_rad_s", "accelerometer_bias_y_m_s2"],
            ["torque_bias_z_n_m", "gyro_bias_z_rad_s", "accelerometer_bias_z_m_s2"],
        ]
        .into_iter()
        .enumerate()
        {
            let all = [
                of(&|flight| flight.torque_bias_n_m[axis]),
                of(&|flight| flight.gyro_bias_rad_s[axis]),
                of(&|flight| flight.force_bias_m_s2[axis]),
            ];
            for (name, estimate) in names.into_iter().zip(all) {
                self.all.insert(name, if flights.len() > 1 { Ok(estimate) } else { Err(one.to_owned()) });
            }
        }
    }
}

/// From the draws' quantiles, made wider for few units, and shifted so that it is about the value.
fn interval(value: f64, draws: &[f64], spread: f64) -> Estimate {
    let (low, high, middle) = (quantile(draws, 0.025), quantile(draws, 0.975), quantile(draws, 0.5));
    Estimate { value, low: value - spread * (middle - low).max(0.0), high: value + spread * (high - middle).max(0.0) }
}
