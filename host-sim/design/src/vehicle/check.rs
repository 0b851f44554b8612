//! Ranges of figures: each refusal names key, value, range and the figure's meaning.

use super::VehicleError;

/// Far beyond any multicopter; keeps products of figures in range.
const LARGEST: f64 = 1e6;
/// Likewise downwards.
const SMALLEST: f64 = 1e-9;
/// Radii of gyration in arms: a body whose mass is where its rotors are has 1 about z.
const GYRATION_ARMS: [f64; 2] = [0.1, 3.0];
/// Torque per thrust in arms: that of a propeller is a tenth to a quarter of its radius, which is less than the arm.
const TORQUE_ARMS: [f64; 2] = [0.005, 1.0];
/// The same of nearly every craft: it tells an arm in another unit from an inertia that is.
const COMMON_TORQUE_ARMS: [f64; 2] = [0.03, 0.5];
/// Most thrust of all motors over the weight: racing craft reach 15.
const THRUST_WEIGHTS: f64 = 25.0;
/// Body rates, rad/s: racing craft turn with 35.
const RATES_RAD_S: [f64; 2] = [0.1, 60.0];
/// Lags of motors, s.
const LAG_S: [f64; 2] = [0.001, 1.0];

/// `Ok` if `holds`; a NaN makes every comparison false and so never passes.
pub(super) fn check(holds: bool, field: &str, value: f64, must: impl Into<String>) -> Result<(), VehicleError> {
    if holds { Ok(()) } else { Err(VehicleError::Value { field: field.to_owned(), value, must: must.into() }) }
}

pub(super) fn positive(field: &str, value: f64) -> Result<(), VehicleError> {
    check((SMALLEST..=LARGEST).contains(&value), field, value, format!("positive, from {SMALLEST} to {LARGEST}"))
}

pub(super) fn within(field: &str, value: f64, least: f64, most: f64, meaning: &str) -> Result<(), VehicleError> {
    check((least..=most).contains(&value), field, value, format!("from {least} to {most} ({meaning})"))
}

pub(super) fn lag(field: &str, value: f64) -> Result<(), VehicleError> {
    let [least, most] = LAG_S;
    within(field, value, least, most, "seconds: 67 ms are 0.067")
}

pub(super) fn body_rate(field: &str, value: f64) -> Result<(), VehicleError> {
    let [least, most] = RATES_RAD_S;
    within(field, value, least, most, "rad/s: 1146 degrees a second are 20")
}

pub(super) fn torque_per_thrust(field: &str, value: f64, arm_m: f64) -> Result<(), VehicleError> {
    let [from, to] = TORQUE_ARMS.map(|arms| arms * arm_m);
    let must = format!("from {from:.2e} to {to:.2e} for 0.005 to 1 arms (metres: 5.7 mm are 0.0057)");
    check((from..=to).contains(&value), field, value, must)
}

/// Above a quarter of the weight, and no more than any motors give.
pub(super) fn thrust_max(field: &str, value: f64, hover_n: f64) -> Result<(), VehicleError> {
    let most_n = THRUST_WEIGHTS * hover_n;
    let must = format!(
        "above {hover_n:.6} N, a quarter of the weight, to {most_n:.6} N, {THRUST_WEIGHTS} times that (newtons: a motor that lifts 20 g \
         has 0.196)"
    );
    check(value > hover_n && value <= most_n, field, value, must)
}

/// Mass, principal moments and arm have to be those of one body. Where they are not, one of them is in another unit,
/// and that one is named: a mass in grams, which the motors would not lift; an arm in millimetres, or in centimetres or decimetres where
/// the torque per thrust says so; or the inertia.
pub(super) fn one_body(
    mass_kg: f64,
    moments: [f64; 2],
    (arm_m, torque_per_thrust_m): (f64, f64),
    thrust_max_n: f64,
) -> Result<(), VehicleError> {
    let [least_arms, most_arms] = GYRATION_ARMS;
    let fits = |mass_kg: f64, arm_m: f64| {
        moments.iter().all(|moment| (least_arms..=most_arms).contains(&((moment / mass_kg).sqrt() / arm_m)))
    };
    if fits(mass_kg, arm_m) {
        return Ok(());
    }
    let is_common = |arm_m: f64| {
        let [least, most] = COMMON_TORQUE_ARMS;
        (least..=most).contains(&(torque_per_thrust_m / arm_m))
    };
    let shorter = |share: f64| fits(mass_kg, share * arm_m) && !is_common(arm_m) && is_common(share * arm_m);
    let [least, most] = moments;
    let square = |arms: f64| (arms * arm_m).powi(2);
    let reason = format!("for radii of gyration of {least_arms} to {most_arms} arms");
    let (field, value, [from, to], unit) = if 4.0 * thrust_max_n < mass_kg * crate::model::GRAVITY_M_S2
        && fits(1e-3 * mass_kg, arm_m)
    {
        ("body.mass_kg", mass_kg, [most / square(most_arms), least / square(least_arms)], "kilograms: 29 g are 0.029")
    } else if fits(mass_kg, 1e-3 * arm_m) || shorter(1e-2) || shorter(0.1) {
        let radii = [(most / mass_kg).sqrt() / most_arms, (least / mass_kg).sqrt() / least_arms];
        ("motors.arm_m", arm_m, radii, "metres: 46 mm are 0.046")
    } else {
        let worst = if (least / mass_kg).sqrt() < least_arms * arm_m { least } else { most };
        let range = [mass_kg * square(least_arms), mass_kg * square(most_arms)];
        ("body.inertia_kg_m2", worst, range, "kg m^2: 16.6 kg mm^2 are 16.6e-6")
    };
    check(false, field, value, format!("from {from:.2e} to {to:.2e} {reason} ({unit})"))
}
