//! The standard cascade of a vehicle, certified once in a process: campaigns and tables of laws fly it thousands of times.

use std::sync::{Arc, Mutex, PoisonError};

use quatrack::gains::table::CascadeTable;
use quatrack_crazyflie::own_craft::OwnCraft;
use quatrack_design::vehicle::Vehicle;
use thiserror::Error;

use super::own_craft::{OwnCraftError, own_craft, standard_design};
use crate::gains::{Certified, GainsError};

/// Crafts of which the answer is kept: more than a campaign or a command has.
const KEPT: usize = 8;

/// What `quatrack gains craft` makes of a vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StandardCascade {
    /// The certified table at 500 Hz, with the air that it is told and the region that it holds for.
    pub table: CascadeTable,
    /// The craft with that table, as the Crazyflie's object takes it.
    pub craft: OwnCraft,
}

/// Why a vehicle has no standard cascade.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum StandardError {
    /// It cannot be designed or certified.
    #[error(transparent)]
    Design(#[from] GainsError),
    /// The object does not take it.
    #[error(transparent)]
    Craft(#[from] OwnCraftError),
}

type Answer = Result<Arc<StandardCascade>, StandardError>;

/// The standard cascade of a vehicle, designed and certified when it is first asked for.
///
/// # Errors
/// [`StandardError`].
pub fn standard_cascade(vehicle: &Vehicle) -> Answer {
    static KNOWN: Mutex<Vec<(Vehicle, Answer)>> = Mutex::new(Vec::new());
    // Whoever asks meanwhile waits for the answer: it is computed once.
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, answer)) = known.iter().find(|(of, _)| of == vehicle) {
        return answer.clone();
    }
    let answer = certified(vehicle);
    known.truncate(KEPT - 1);
    known.insert(0, (vehicle.clone(), answer.clone()));
    answer
}

fn certified(vehicle: &Vehicle) -> Answer {
    let certified: Certified = standard_design(vehicle)?.certify()?;
    let craft = own_craft(&certified)?;
    let table = certified.table.as_ref().and_then(|table| table.cascade().copied());
    let table = table.ok_or(OwnCraftError::Method { method: certified.design.problem.named().1 })?;
    Ok(Arc::new(StandardCascade { table, craft }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vehicles;

    #[test]
    fn a_craft_is_certified_once_and_the_next_one_apart_from_it() {
        let text = include_str!("../../../../gains/vehicles/crazyflie-2.1-legacy.toml");
        let vehicle = |mass: &str| vehicles::from_toml(&text.replace("mass_kg = 0.029", mass)).unwrap();
        let (own, heavier) = (vehicle("mass_kg = 0.029"), vehicle("mass_kg = 0.031"));
        let first = standard_cascade(&own).unwrap();
        let other = standard_cascade(&heavier).unwrap();
        assert!(Arc::ptr_eq(&first, &standard_cascade(&own).unwrap()));
        assert!((first.craft.mass_kg, other.craft.mass_kg) == (0.029, 0.031) && first.table != other.table);
        // 80 % of the file's drag; its own lag by the design's share.
        assert!((first.table.air.drag_per_s - 0.8 * 0.395).abs() < 1e-6, "{:?}", first.table.air);
        assert!((first.table.motor_lag_s - 0.79 * 0.126).abs() < 1e-6);
    }
}
