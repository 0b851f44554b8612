//! A craft that the controller does not know: a certified design of the cascade in; the craft with its table, as the object takes it,
//! and the header that the app is built with, out.

use std::fmt::Write as _;

use quatrack_crazyflie::own_craft::{OwnCraft, TABLE_BYTES};
use quatrack_design::vehicle::Vehicle;
use thiserror::Error;

use crate::gains::{Certified, Design, GainsError};

/// Why a design gives no craft for the object.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum OwnCraftError {
    /// Another law.
    #[error("{method} is no law that the Crazyflie object flies of a craft's own: write method = \"cascade\"")]
    Method {
        /// The design's.
        method: &'static str,
    },
    /// Another control rate.
    #[error("control_rate_hz = {found}: the Crazyflie object steps at 500")]
    Rate {
        /// The design's, Hz.
        found: u32,
    },
    /// The vehicle's own lag is not in the design's region.
    #[error(
        "the vehicle's motors lag {lag_ms} ms, the design's region is {from_ms} to {to_ms} ms: widen region.motor_lag_ms or mend \
         motors.lag_s"
    )]
    MotorLag {
        /// The vehicle's, ms.
        lag_ms: f32,
        /// The shortest of the region, ms.
        from_ms: f32,
        /// The longest, ms.
        to_ms: f32,
    },
}

/// Shares of the vehicle's lag: of the lag that is designed for, and of that again the shortest and the longest that are certified.
/// With 126 ms they are those of the built-in default, 100 ms and 50 to 126 ms.
const DESIGN_SHARE: f64 = 0.79;
const REGION_SHARES: [f64; 2] = [0.5, 1.25];
/// The craft that the standard weights were found on, kg; the weight of forces goes with the inverse square of the mass.
const WEIGHED_KG: f64 = 0.034;

/// The standard weight of forces for a mass: twice the mass and inertia fly alike with a quarter of it.
pub fn standard_force_input(mass_kg: f64) -> f64 {
    1e4 * (WEIGHED_KG / mass_kg).powi(2)
}

/// The design of a vehicle of which nobody has written one: standard weights, and the certified region of the built-in
/// tables.
///
/// # Errors
/// [`GainsError`] of a vehicle that cannot be designed for.
pub fn standard_design(vehicle: &Vehicle) -> Result<Design, GainsError> {
    let own_s = vehicle.motors().lag_s;
    let lag_s = DESIGN_SHARE * own_s;
    let [from_s, to_s] = REGION_SHARES.map(|share| share * lag_s);
    let to_s = to_s.max(own_s);
    let force_input = standard_force_input(vehicle.mass_kg());
    let text = format!(
        "description = \"The standard cascade.\"\nvehicle = \"\"\nlinearisation = \"equilibrium\"\nmethod = \"cascade\"\n\
         control_rate_hz = 500\nmotor_lag_ms = {:?}\n[weights]\nforce_input = {force_input:?}\n[region]\n\
         motor_lag_ms = [{:?}, {:?}]\nmass_percent = 20.0\ninertia_percent = 30.0\nforce_percent = [70.0, 105.0]\n\
         delay_ms = 10.0\n[minimum]\ngain_factor_all = 1.8\nphase_all_deg = 32.0\ndelay_ms = 20.0\nmotor_lag_ms = {:?}\n",
        1e3 * lag_s,
        1e3 * from_s,
        1e3 * to_s,
        1e3 * to_s,
    );
    Design::for_vehicle(vehicle, &text)
}

/// The craft of a design, with its table, as the object takes it.
///
/// # Errors
/// [`OwnCraftError`].
pub fn own_craft(certified: &Certified) -> Result<OwnCraft, OwnCraftError> {
    let design = &certified.design;
    let method = design.problem.named().1;
    let refused = || OwnCraftError::Method { method };
    let table = certified.table.as_ref().ok_or_else(refused)?;
    let cascade = table.cascade().ok_or_else(refused)?;
    if design.rate.hz() != 500 {
        return Err(OwnCraftError::Rate { found: design.rate.hz() });
    }
    let (vehicle, motors) = (&design.vehicle, design.vehicle.motors());
    let lag_s = motors.lag_s as f32;
    if !cascade.certified.holds_lag(lag_s) {
        let [from_s, to_s] = cascade.certified.motor_lag_s;
        return Err(OwnCraftError::MotorLag { lag_ms: 1e3 * lag_s, from_ms: 1e3 * from_s, to_ms: 1e3 * to_s });
    }
    let bytes = table.to_bytes().and_then(|bytes| <[u8; TABLE_BYTES]>::try_from(bytes).ok()).ok_or_else(refused)?;
    let i = vehicle.inertia_kg_m2();
    let rates = vehicle.body_rates_max_rad_s();
    Ok(OwnCraft {
        mass_kg: vehicle.mass_kg() as f32,
        inertia_kg_m2: [i.m11, i.m12, i.m13, i.m22, i.m23, i.m33].map(|moment| moment as f32),
        arm_m: motors.arm_m as f32,
        force_n: [motors.thrust_min_n as f32, motors.thrust_max_n as f32],
        torque_per_thrust_m: motors.torque_per_thrust_m as f32,
        motor_lag_s: lag_s,
        body_rates_rad_s: [rates.x, rates.y, rates.z].map(|rate| rate as f32),
        table: bytes,
    })
}

/// `quatrack_craft.h`: the craft as the constant `ownCraft`.
///
/// # Errors
/// [`OwnCraftError`].
pub fn craft_header(certified: &Certified) -> Result<String, OwnCraftError> {
    let OwnCraft { mass_kg, inertia_kg_m2, arm_m, force_n, torque_per_thrust_m, motor_lag_s, body_rates_rad_s, table } =
        own_craft(certified)?;
    // Nine digits tell every f32.
    let listed = |figures: &[f32]| figures.iter().map(|figure| format!("{figure:.8e}f")).collect::<Vec<_>>().join(", ");
    let mut text = format!(
        "/* {}, flown by the table {}: made by `quatrack gains craft` and not edited by hand. */\n\
         static const quatrackCraft_t ownCraft = {{\n  .massKg = {},\n  .inertiaKgM2 = {{{}}},\n  .armM = {},\n  .forceN = {{{}}},\n  \
         .torquePerThrustM = {},\n  .motorLagS = {},\n  .bodyRatesRadS = {{{}}},\n  .table = {{\n",
        certified.design.vehicle.name(),
        certified.design.name,
        listed(&[mass_kg]),
        listed(&inertia_kg_m2),
        listed(&[arm_m]),
        listed(&force_n),
        listed(&[torque_per_thrust_m]),
        listed(&[motor_lag_s]),
        listed(&body_rates_rad_s),
    );
    for bytes in table.chunks(20) {
        let bytes: Vec<String> = bytes.iter().map(|byte| format!("0x{byte:02x}")).collect();
        // Writing to a string does not fail.
        let _ = writeln!(text, "    {},", bytes.join(", "));
    }
    text += "  },\n};\n";
    Ok(text)
}
