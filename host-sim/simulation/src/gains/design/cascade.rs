//! A design of the cascade: its entries in; lag, weights and air out, with the [`region`].

use quatrack::cascade::Air;
use quatrack_design::certify::cascade::CascadeAir;
use quatrack_design::design::cascade::CascadeWeights;
use quatrack_design::vehicle::Vehicle;

use super::entry::{check, misplaced, missing};
use super::problem::Problem;
use super::region::{self, Region};
use super::weights::weight;
use crate::gains::GainsError;
use crate::gains::file::{AirEntry, DesignFile, Linearisation, RegionSource, Weights};

/// Longest lag of motors, ms.
const LONGEST_LAG_MS: f64 = 1e3;
/// Of the identified air, as much as is told where a design states none.
const TOLD_SHARE: f64 = 0.8;
/// Share of the wind's moment that is fed forward where a design states none.
const GUST: f64 = 0.55;
/// Off-diagonal inertia over the least moment that is taken for none.
const PRINCIPAL: f64 = 1e-6;

pub(super) fn cascade(file: &DesignFile, vehicle: &Vehicle) -> Result<Problem, GainsError> {
    let here = &file.method;
    if file.linearisation == Linearisation::FlatOutput {
        return Err(misplaced("method", &here.quoted(), &file.linearisation));
    }
    if let Some(gain) = file.rate_loop_gain_1_s {
        return Err(misplaced("rate_loop_gain_1_s", &gain, here));
    }
    principal_axes(vehicle)?;
    // The core wants two control periods at least.
    let least = 2e3 / f64::from(file.control_rate_hz.max(1));
    let lag = |key: &str, value: f64| {
        check((least..=LONGEST_LAG_MS).contains(&value), key, value, format!("from {least} to {LONGEST_LAG_MS} ms"))
    };
    let region = file.region.ok_or_else(|| missing("[region]", here, "[region] with motor_lag_ms = [50.0, 126.0]"))?;
    let identified = region.from == Some(RegionSource::Identified);
    let own_lag_ms = identified.then(|| 1e3 * vehicle.motors().lag_s);
    let lag_ms = file.motor_lag_ms.or(own_lag_ms);
    let lag_ms = lag_ms.ok_or_else(|| missing("motor_lag_ms", here, "motor_lag_ms = 100.0"))?;
    lag("motor_lag_ms", lag_ms)?;
    let air = air(file.air.as_ref(), vehicle)?;
    let Region { lags_ms: [shortest, longest], bounds, from } = region::resolved(&region, vehicle, &air, here)?;
    let holds = shortest > 0.0 && shortest <= lag_ms;
    check(holds, "region.motor_lag_ms", shortest, format!("above 0, up to motor_lag_ms = {lag_ms}"))?;
    let holds = (lag_ms..=LONGEST_LAG_MS).contains(&longest);
    check(holds, "region.motor_lag_ms", longest, format!("from motor_lag_ms = {lag_ms} to {LONGEST_LAG_MS} ms"))?;
    Ok(Problem::Cascade {
        motor_lag_s: 1e-3 * lag_ms,
        weights: weights(file.weights.as_ref(), 1e-3 * lag_ms, here)?,
        air,
        region: bounds,
        region_from: from,
    })
}

fn principal_axes(vehicle: &Vehicle) -> Result<(), GainsError> {
    let inertia = vehicle.inertia_kg_m2();
    let least = inertia.diagonal().min();
    let off = [inertia.m12, inertia.m13, inertia.m23].into_iter().fold(0.0, |most: f64, off| most.max(off.abs()));
    if off <= PRINCIPAL * least {
        return Ok(());
    }
    Err(GainsError::Vehicle {
        vehicle: vehicle.name().to_owned(),
        reason: format!("its products of inertia reach {off:e} kg m^2; the cascade is for principal axes: give 0"),
    })
}

/// As written, and for the rest a share of the vehicle's identified air; none where nothing was.
fn air(entry: Option<&AirEntry>, vehicle: &Vehicle) -> Result<CascadeAir, GainsError> {
    let none = AirEntry::default();
    let entry = entry.unwrap_or(&none);
    let share_of_identified = entry.share_of_identified.unwrap_or(TOLD_SHARE);
    let holds = share_of_identified > 0.0 && share_of_identified <= 1.0;
    check(holds, "air.share_of_identified", share_of_identified, "above 0, up to 1")?;
    let identified = vehicle.flown().air;
    let drag_per_s = entry.drag_per_s.unwrap_or_else(|| {
        identified.map_or(0.0, |air| share_of_identified * 0.5 * (air.drag_per_s[0] + air.drag_per_s[1]))
    });
    let moment_n_s = entry
        .moment_n_m_per_m_s
        .unwrap_or_else(|| identified.map_or([0.0; 2], |air| air.moment_n_m_per_m_s.map(|c| share_of_identified * c)));
    let most_drag = f64::from(Air::DRAG_MAX_PER_S);
    check((0.0..=most_drag).contains(&drag_per_s), "air.drag_per_s", drag_per_s, format!("from 0 to {most_drag} 1/s"))?;
    let most = f64::from(Air::MOMENT_MAX_N_S);
    for moment in moment_n_s {
        let must = format!("from 0 to {most} N m per m/s");
        check((0.0..=most).contains(&moment), "air.moment_n_m_per_m_s", moment, must)?;
    }
    let gust = entry.gust.unwrap_or(GUST);
    check((0.0..=1.0).contains(&gust), "air.gust", gust, "from 0 to 1")?;
    Ok(CascadeAir { drag_per_s, moment_n_s, share_of_identified, gust, learn: entry.learn.unwrap_or(true) })
}

/// The standard ones for a lag with those that are written.
fn weights(weights: Option<&Weights>, lag_s: f64, here: &dyn ToString) -> Result<CascadeWeights, GainsError> {
    let standard = CascadeWeights::for_lag(lag_s);
    let Some(weights) = weights else { return Ok(standard) };
    let integral = weights.position_integral.map(|_| "position_integral");
    if let Some(key) = weights.of_the_paper_alone().or(integral) {
        return Err(misplaced(&format!("weights.{key}"), &"...", here));
    }
    let group = |key: &str, value: Option<[f64; 3]>, standard: [f64; 3]| {
        let value = value.unwrap_or(standard);
        value.iter().try_for_each(|entry| weight(key, *entry)).map(|()| value)
    };
    let command = weights.force_input.unwrap_or(standard.command);
    weight("force_input", command)?;
    Ok(CascadeWeights {
        position: group("position", weights.position, standard.position)?,
        velocity: group("velocity", weights.velocity, standard.velocity)?,
        rotation: group("rotation", weights.rotation, standard.rotation)?,
        body_rates: group("body_rates", weights.body_rates, standard.body_rates)?,
        command,
    })
}
