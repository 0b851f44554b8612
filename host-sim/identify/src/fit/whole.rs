//! All figures of a craft from its flights: checked flights in; every figure with a 95 % interval, or the reason why it
//! is not known, out.

use std::collections::BTreeMap;

use super::balance::{Balance, balance};
use super::balanced;
use super::bootstrap::few_units;
use super::contradiction::contradictions;
use super::drag::{Regression, drag};
use super::estimate::Estimate;
use super::figures::Figures;
use super::lag_curve::{LagPoint, lag_curve, most_explained};
use super::layout::{ASYMMETRY, Found, VOLTAGE_POWER, start};
use super::model::{FlightFit, Model, Summary, flight_fits, summary};
use super::posterior::{EXPLAINED_LEAST, Posterior};
use super::prior::Base;
use super::problem::{Drive, Prepared, prepared};
use super::slow_log::{slowest, untold};
use super::thrust::steeper;
use crate::IdentifyError;
use crate::filter::mean;
use crate::flight::{Flight, STEP_S};

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
    let told = |posterior: &Posterior| {
        let steeper = steeper(&sections, base, &posterior.values);
        let mut figures = Figures::new(base, few_units(&posterior.blocks), steeper);
        figures.refined(posterior, voltage);
        figures
    };
    let mut figures = told(&posterior);
    let rough = summary(&sections, base, &posterior.values, &drags);
    let slow = slowest(flights);
    if slow.is_none() && 0.5 * (rough.explained[0] + rough.explained[1]) > EXPLAINED_LEAST {
        let filtered = Posterior::filtered(&sections, base, flights.len(), &posterior.values, priors, &fixed);
        if let Some(filtered) = filtered {
            let all = told(&filtered);
            let refused = contradictions(&figures, &all);
            if refused.is_empty() {
                (posterior, figures) = (filtered, all);
            } else {
                figures.refuse(refused);
            }
        }
    }
    let Summary { full, yaws, model, explained: [x, y, thrust] } = summary(&sections, base, &posterior.values, &drags);
    if ![x, y, thrust].iter().all(|share| share.is_finite()) {
        return Err(IdentifyError::TooLittle(
            "nothing that is a number comes out of these logs; check the map's columns, or give the logs one by one"
                .to_owned(),
        ));
    }
    let flight_fits = flight_fits(&sections, base, &model, &full);
    figures.apart(&sections, base, &posterior, voltage);
    figures.drag(&drags);
    figures.yaw(&yaws);
    figures.biases(&flight_fits);
    figures.turning([x, y, thrust], yaws.forward.explained);
    if let Some(flight) = slow {
        figures.refuse(untold(&figures, flight));
    }
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
