//! A law of one's own beside ours: `cargo run --release --example own_law [SCENARIO.toml]`.
//!
//! It points the thrust along `a + g z - k_p e_p - k_v e_v` and turns the craft there, nothing more.

use std::path::Path;

use nalgebra::{Vector3, Vector4};
use quatrack_simulation::control_law::{ControlLaw, Input};
use quatrack_simulation::rivals::{Actuation, ForceTorque};
use quatrack_simulation::scenario::compare::Table;
use quatrack_simulation::scenario::file::ScenarioFile;
use quatrack_simulation::scenario::{Law, Scenario};

struct OwnLaw {
    mass_kg: f64,
    actuation: Actuation,
}

impl ControlLaw for OwnLaw {
    fn rate_hz(&self) -> u32 {
        500
    }

    fn step(&mut self, input: &Input) -> Result<Vector4<f64>, String> {
        let (estimate, setpoint) = (&input.estimate, &input.setpoint);
        let wanted = setpoint.acceleration_m_s2 + Vector3::z() * 9.81
            - 6.0 * (estimate.position_m - setpoint.position_m)
            - 4.0 * (estimate.velocity_m_s - setpoint.velocity_m_s);
        let up = estimate.attitude.inverse() * wanted.normalize();
        let turn = Vector3::z().cross(&up) * 0.006 - (estimate.body_rates_rad_s - setpoint.body_rates_rad_s) * 0.001;
        let force_n = self.mass_kg * wanted.dot(&(estimate.attitude * Vector3::z()));
        Ok(self.actuation.forces_n(&ForceTorque { force_n, torque_n_m: turn }))
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scenario = match std::env::args().nth(1) {
        Some(path) => Scenario::from_file(Path::new(&path))?,
        None => Scenario::checked(&ScenarioFile::of_vehicle("crazyflie-2.1"), "default", Path::new(""))?,
    };
    let flown = scenario.flown(None);
    let mut own = OwnLaw { mass_kg: scenario.told.mass_kg, actuation: Actuation::of(&scenario.vehicle) };
    let mut lee = Law::Lee.start(&scenario.vehicle, &scenario.told)?;
    let flights =
        [("own".to_owned(), scenario.fly(&mut own, &flown)?), ("lee".to_owned(), scenario.fly(lee.as_mut(), &flown)?)];
    println!("{scenario}\n\n{}", Table::of(&flights));
    Ok(())
}
