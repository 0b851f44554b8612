//! Ranges of figures: each refusal names key, value, range and the figure's meaning.

use super::VehicleError;

/// Far beyond any multicopter; keeps products of figures in range.
pub(super) const LARGEST: f64 = 1e6;
/// Likewise downwards.
const SMALLEST: f64 = 1e-9;
/// Radii of gyration in arms: a body whose mass is where its rotors are has 1 about z.
const GYRATION_ARMS: [f64; 2] = [0.1, 3.0];
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

/// Mass, principal moments and arm have to be those of one body. Where they are not, one of them is in another unit,
/// and that one is named: a mass in grams, which the motors would not lift; an arm in millimetres; or the inertia.
pub(super) fn one_body(mass_kg: f64, moments: [f64; 2], arm_m: f64, thrust_max_n: f64) -> Result<(), VehicleError> {
    let [least_arms, most_arms] = GYRATION_ARMS;
    let fits = |mass_kg: f64, arm_m: f64| {
        moments.iter().all(|moment| (least_arms..=most_arms).contains(&((moment / mass_kg).sqrt() / arm_m)))
    };
    if fits(mass_kg, arm_m) {
        return Ok(());
    }
    let [least, most] = moments;
    let square = |arms: f64| (arms * arm_m).powi(2);
    let reason = format!("for radii of gyration of {least_arms} to {most_arms} arms");
    let (field, value, [from, to], unit) = if 4.0 * thrust_max_n < mass_kg * crate::model::GRAVITY_M_S2
        && fits(1e-3 * mass_kg, arm_m)
    {
        ("body.mass_kg", mass_kg, [most / square(most_arms), least / square(least_arms)], "kilograms: 29 g are 0.029")
    } else if fits(mass_kg, 1e-3 * arm_m) {
        let radii = [(most / mass_kg).sqrt() / most_arms, (least / mass_kg).sqrt() / least_arms];
        ("motors.arm_m", arm_m, radii, "metres: 46 mm are 0.046")
    } else {
        let worst = if (least / mass_kg).sqrt() < least_arms * arm_m { least } else { most };
        let range = [mass_kg * square(least_arms), mass_kg * square(most_arms)];
        ("body.inertia_kg_m2", worst, range, "kg m^2: 16.6 kg mm^2 are 16.6e-6")
    };
    check(false, field, value, format!("from {from:.2e} to {to:.2e} {reason} ({unit})"))
}
