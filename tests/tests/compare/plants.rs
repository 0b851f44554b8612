//! Rivals on the plants that others publish, beside figures of Bitcraze's own controllers on the same equations.

use nalgebra::Vector3;
use quatrack_design::vehicle::Vehicle;
use quatrack_simulation::control_law::ControlLaw;
use quatrack_simulation::flight::rigid_loop::RigidFlight;
use quatrack_simulation::plant::{Environment, Plant, RigidState, Truth};
use quatrack_simulation::rivals::{
    Actuation, CascadedPid, CascadedPidConfig, Lee, LeeConfig, Mellinger, MellingerConfig,
};
use quatrack_simulation::scenario::course::Flown;
use quatrack_simulation::scenario::flight::{Bench, Setpoints};
use quatrack_simulation::scenario::sensors::Sensors;
use quatrack_simulation::vehicles;

/// A craft as a package publishes it: drag in N per m/s along the body's axes, the motors' lag at hover.
struct Craft {
    name: &'static str,
    /// Whose motors and arm the firmware is built for.
    base: &'static str,
    mass_kg: f64,
    inertia_kg_m2: [f64; 3],
    half_arm_m: f64,
    lag_s: f64,
    drag_n_s_m: [f64; 3],
}

const CRAFT: [Craft; 5] = [
    Craft { name: "RotorPy brushed", base: "crazyflie-2.1", mass_kg: 0.03, inertia_kg_m2: [1.43e-5, 1.43e-5, 2.89e-5], half_arm_m: 0.0304, lag_s: 0.072, drag_n_s_m: [0.0073, 0.0073, 0.0054] },
    Craft { name: "RotorPy Brushless", base: "crazyflie-2.1-brushless", mass_kg: 0.044, inertia_kg_m2: [3.3e-5, 3.6e-5, 5.9e-5], half_arm_m: 0.0304, lag_s: 0.050, drag_n_s_m: [0.033, 0.033, 0.077] },
    Craft { name: "P250", base: "crazyflie-2.1", mass_kg: 0.0318, inertia_kg_m2: [16.8e-6, 16.8e-6, 29.8e-6], half_arm_m: 0.03253, lag_s: 0.107, drag_n_s_m: [0.01351483, 0.01351483, 0.01677452] },
    Craft { name: "T350", base: "crazyflie-2.1-upgrade-kit", mass_kg: 0.0379, inertia_kg_m2: [16.8e-6, 16.8e-6, 29.8e-6], half_arm_m: 0.03253, lag_s: 0.078, drag_n_s_m: [0.01556697, 0.01556697, 0.02191672] },
    Craft { name: "B500", base: "crazyflie-2.1-brushless", mass_kg: 0.04338, inertia_kg_m2: [25e-6, 28e-6, 49e-6], half_arm_m: 0.035355, lag_s: 0.059, drag_n_s_m: [0.02149163, 0.02149163, 0.02359736] },
];

impl Craft {
    fn vehicle(&self) -> Vehicle {
        let base = vehicles::by_name(self.base).unwrap();
        let (m, [x, y, z], lag) = (base.motors(), self.inertia_kg_m2, self.lag_s);
        vehicles::from_toml(&format!(
            "name = \"{}\"\n[body]\nmass_kg = {}\ninertia_kg_m2 = [[{x:?}, 0.0, 0.0], [0.0, {y:?}, 0.0], [0.0, 0.0, {z:?}]]\n\
             [motors]\narm_m = {}\nthrust_min_n = 0.0\nthrust_max_n = {}\ntorque_per_thrust_m = {}\nlag_s = {lag}\n\
             published_lag_s = [{lag}, {lag}]\n[limits]\nbody_rates_rad_s = [20.0, 20.0, 10.0]\n",
            base.name(),
            self.mass_kg,
            self.half_arm_m * std::f64::consts::SQRT_2,
            m.thrust_max_n,
            m.torque_per_thrust_m,
        ))
        .unwrap()
    }

    fn fly(&self, law: &mut dyn ControlLaw, flown: &Flown, in_air: bool) -> RigidFlight {
        let vehicle = self.vehicle();
        let mut environment = Environment::VACUUM;
        if in_air {
            environment.air.drag_per_s = self.drag_n_s_m.map(|drag| drag / self.mass_kg);
        }
        let start = RigidState::at_rest(Vector3::z(), vehicle.hover_thrust_n());
        let mut plant = Plant::new(&vehicle, &environment, &Truth::as_designed(&vehicle), &start, 1).unwrap();
        Bench { flown, setpoints: Setpoints::At100Hz, sensors: Sensors::exact() }.fly(&mut plant, law)
    }

    /// Told the craft's mass; arm and motors are the firmware's.
    fn laws(&self) -> [Box<dyn ControlLaw>; 3] {
        let base = vehicles::by_name(self.base).unwrap();
        let actuation = Actuation::of(&base);
        [
            Box::new(Lee::new(LeeConfig::firmware(self.mass_kg), actuation)),
            Box::new(Mellinger::new(MellingerConfig::firmware(self.mass_kg, &actuation), actuation)),
            Box::new(CascadedPid::new(CascadedPidConfig::firmware(&base, self.mass_kg), actuation)),
        ]
    }
}

#[test]
fn table() {
    for (name, flown) in [("eight", Flown::eight(2.1, 12.0)), ("step", Flown::step(1.0, 5.0))] {
        for in_air in [false, true] {
            for craft in &CRAFT {
                print!("{name:<6}{:<20}{:<7}", craft.name, if in_air { "air" } else { "vacuum" });
                for mut law in craft.laws() {
                    let flight = craft.fly(law.as_mut(), &flown, in_air);
                    let over = flight.samples.iter().map(|s| s.state.position_m.x).fold(0.0, f64::max);
                    print!("  {:.4} ({:.3} {:.3})", flight.iae_m_s().unwrap_or(f64::NAN), flight.max_error_m(), over);
                }
                println!();
            }
        }
    }
}
