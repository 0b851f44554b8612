//! Rivals on plants with the mass, inertia, lag and drag that RotorPy 3.0.0 and drone-models 0.1.0 publish.

use nalgebra::{Vector3, Vector4};
use quatrack_simulation::control_law::ControlLaw;
use quatrack_simulation::plant::{Craft, Load, RigidState, Wrench};
use quatrack_simulation::rivals::{Actuation, CascadedPid, CascadedPidConfig, Lee, LeeConfig, Mellinger, MellingerConfig};
use quatrack_simulation::scenario::course::Flown;
use quatrack_simulation::scenario::flight::{Bench, Setpoints, World};
use quatrack_simulation::scenario::sensors::Sensors;
use quatrack_simulation::vehicles;
use quatrack_design::vehicle::Vehicle;

struct Drag(Vector3<f64>);

impl Load for Drag {
    fn wrench(&self, _time_s: f64, state: &RigidState) -> Wrench {
        let through = state.attitude.inverse() * state.velocity_m_s;
        Wrench { force_n: -(state.attitude * self.0.component_mul(&through)), ..Wrench::default() }
    }
}

struct StandIn<'a> {
    craft: &'a Craft,
    state: RigidState,
    time_s: f64,
}

impl World for StandIn<'_> {
    fn state(&self) -> &RigidState {
        &self.state
    }

    fn specific_force_m_s2(&mut self) -> Vector3<f64> {
        Vector3::zeros()
    }

    fn battery_v(&self) -> f64 {
        4.0
    }

    fn advance(&mut self, commands_n: &Vector4<f64>, duration_s: f64) {
        self.state = self.craft.hold(&self.state, commands_n, self.time_s, duration_s);
        self.time_s += duration_s;
    }
}

struct Plant {
    name: &'static str,
    base: &'static str,
    mass_kg: f64,
    inertia: [f64; 3],
    half_arm: f64,
    lag_s: f64,
    drag: [f64; 3],
}

const PLANTS: [Plant; 5] = [
    Plant { name: "RotorPy brushed", base: "crazyflie-2.1", mass_kg: 0.03, inertia: [1.43e-5, 1.43e-5, 2.89e-5], half_arm: 0.0304, lag_s: 0.072, drag: [0.0073, 0.0073, 0.0054] },
    Plant { name: "RotorPy Brushless", base: "crazyflie-2.1-brushless", mass_kg: 0.044, inertia: [3.3e-5, 3.6e-5, 5.9e-5], half_arm: 0.0304, lag_s: 0.050, drag: [0.033, 0.033, 0.077] },
    Plant { name: "P250", base: "crazyflie-2.1", mass_kg: 0.0318, inertia: [16.8e-6, 16.8e-6, 29.8e-6], half_arm: 0.03253, lag_s: 0.107, drag: [0.01351483, 0.01351483, 0.01677452] },
    Plant { name: "T350", base: "crazyflie-2.1-upgrade-kit", mass_kg: 0.0379, inertia: [16.8e-6, 16.8e-6, 29.8e-6], half_arm: 0.03253, lag_s: 0.078, drag: [0.01556697, 0.01556697, 0.02191672] },
    Plant { name: "B500", base: "crazyflie-2.1-brushless", mass_kg: 0.04338, inertia: [25e-6, 28e-6, 49e-6], half_arm: 0.035355, lag_s: 0.059, drag: [0.02149163, 0.02149163, 0.02359736] },
];

fn vehicle(plant: &Plant) -> Vehicle {
    let base = vehicles::by_name(plant.base).unwrap();
    let m = base.motors();
    let [x, y, z] = plant.inertia;
    vehicles::from_toml(&format!(
        "name = \"{}\"\n[body]\nmass_kg = {}\ninertia_kg_m2 = [[{x:?}, 0.0, 0.0], [0.0, {y:?}, 0.0], [0.0, 0.0, {z:?}]]\n[motors]\narm_m = {}\nthrust_min_n = 0.0\nthrust_max_n = {}\ntorque_per_thrust_m = {}\nlag_s = {}\npublished_lag_s = [{}, {}]\n[limits]\nbody_rates_rad_s = [20.0, 20.0, 10.0]\n",
        base.name(), plant.mass_kg, plant.half_arm * std::f64::consts::SQRT_2, m.thrust_max_n, m.torque_per_thrust_m, plant.lag_s, plant.lag_s, plant.lag_s
    )).unwrap()
}

#[test]
fn table() {
    for flown in [Flown::eight(2.1, 12.0), Flown::step(1.0, 5.0)] {
    for air in [false, true] {
        for plant in &PLANTS {
            let vehicle = vehicle(plant);
            let base = vehicles::by_name(plant.base).unwrap();
            // The firmware's idea of the arm.
            let actuation = Actuation::of(&base);
            let mut craft = Craft::new(&vehicle);
            if air {
                craft = craft.with_load(Drag(Vector3::from(plant.drag)));
            }
            let mut laws: Vec<Box<dyn ControlLaw>> = vec![
                Box::new(Lee::new(LeeConfig::firmware(plant.mass_kg), actuation)),
                Box::new(Mellinger::new(MellingerConfig::firmware(plant.mass_kg, &actuation), actuation)),
                Box::new(CascadedPid::new(CascadedPidConfig::firmware(&base, plant.mass_kg), actuation)),
            ];
            let start = RigidState::at_rest(Vector3::new(0.0, 0.0, 1.0), vehicle.hover_thrust_n());
            print!("{:<20} {}", plant.name, if air { "air   " } else { "vacuum" });
            for law in &mut laws {
                let bench = Bench { flown: &flown, setpoints: Setpoints::At100Hz, sensors: Sensors::exact() };
                let flight = bench.fly(&mut StandIn { craft: &craft, state: start, time_s: 0.0 }, law.as_mut());
                print!("  {:?} ({:.3})", flight.iae_m_s().map(|v| (v * 1e4).round() / 1e4), flight.max_error_m());
            }
            println!();
        }
    }
    }
}
