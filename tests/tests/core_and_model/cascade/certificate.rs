//! The design's gains against another solver's, and the certificate's loop against the core's own step.

use nalgebra::{DMatrix, Vector3};
use quatrack::cascade::{Air, Cascade, CascadeGains, CascadeInput, CascadeLimits, CascadeMemory, Followed};
use quatrack::gains::cascade as tables;
use quatrack::gains::table::{BuiltInCascade, CascadeTable};
use quatrack::{FifthOrderSample, Heading, Quaternion, Rate, State};
use quatrack_design::certify::cascade::{CascadeChain, CascadeCraft, CascadeRegion, CascadeVariation};
use quatrack_design::design::cascade::{CascadeWeights, cascade};
use quatrack_design::vehicle::Vehicle;
use quatrack_simulation::vehicles;

use crate::cascade::crafts::{BRUSHED_63, BRUSHLESS_50};

const H: f64 = 0.002;

fn designed(name: &str, lag_s: f64) -> (Vehicle, [f64; 16]) {
    designed_with(name, lag_s, &CascadeWeights::for_lag(lag_s))
}

fn designed_with(name: &str, lag_s: f64, weights: &CascadeWeights) -> (Vehicle, [f64; 16]) {
    let vehicle = vehicles::by_name(name).unwrap();
    let design = cascade(&vehicle, lag_s, weights, H).unwrap();
    assert!(design.relative_residual < 1e-12, "{name}: {}", design.relative_residual);
    let numbers = design.numbers();
    (vehicle, numbers)
}

#[test]
fn the_gains_are_those_of_another_solver() {
    // SciPy's `solve_discrete_are` on the four chains, to six digits.
    for (name, lag_s, wanted) in
        [("crazyflie-2.1-brushless", 0.05, BRUSHLESS_50), ("crazyflie-2.1", 0.0635, BRUSHED_63)]
    {
        let (_, numbers) = designed(name, lag_s);
        for (found, wanted) in numbers.into_iter().zip(wanted.numbers()) {
            assert!((found / f64::from(wanted) - 1.0).abs() < 5e-6, "{name}: {found} {wanted}");
        }
    }
}

#[test]
fn the_tables_in_the_core_are_the_designs() {
    for (name, lag_s, built_in) in [
        ("crazyflie-2.1-brushless", 0.05, tables::BRUSHLESS_50_MS),
        ("crazyflie-2.1-brushless", 0.02, tables::BRUSHLESS_20_MS),
        ("crazyflie-2.1", 0.1, tables::CRAZYFLIE_2_1_100_MS),
        ("crazyflie-2.1", 0.0635, tables::CRAZYFLIE_2_1_63_MS),
        ("crazyflie-2.1", 0.02, tables::CRAZYFLIE_2_1_20_MS),
        ("crazyflie-2.1-upgrade-kit", 0.1, tables::UPGRADE_KIT_100_MS),
        ("crazyflie-2.1-upgrade-kit", 0.0635, tables::UPGRADE_KIT_63_MS),
        ("crazyflie-2.1-upgrade-kit", 0.02, tables::UPGRADE_KIT_20_MS),
    ] {
        let mut weights = CascadeWeights::for_lag(lag_s);
        if built_in == tables::UPGRADE_KIT_63_MS {
            // Its design has weights of its own.
            weights.velocity[2] = 600.0;
        }
        let (vehicle, numbers) = designed_with(name, lag_s, &weights);
        assert_eq!(built_in.vehicle.id, vehicles::id(&vehicle), "{name}");
        for (designed, held) in numbers.into_iter().zip(built_in.table.gains.numbers()) {
            // A rounding to f32, and one more where another processor's last bits differ.
            assert!((designed / f64::from(held) - 1.0).abs() < 1.3e-7, "{name}: {designed} {held}");
        }
    }
}

/// The core's closed loop at hover on a chain's plant, run from a small offset: one value a step.
fn flown_by_the_core(
    vehicle: &Vehicle,
    numbers: [f64; 16],
    lag_s: f64,
    air: &Air,
    chain: CascadeChain,
    steps: usize,
) -> Vec<f64> {
    let gains = CascadeGains::from_numbers(numbers.map(|gain| gain as f32)).unwrap();
    let inertia = vehicle.inertia_kg_m2();
    let motors = vehicle.motors();
    let airframe = quatrack::Airframe::new(quatrack::AirframeFigures {
        mass_kg: vehicle.mass_kg() as f32,
        inertia_kg_m2: [0, 1, 2].map(|i| inertia[(i, i)] as f32),
        lever_arm_m: motors.half_arm_m() as f32,
        torque_per_thrust_m: motors.torque_per_thrust_m as f32,
        force_min_n: 0.0,
        force_max_n: motors.thrust_max_n as f32,
        motor_lag_s: lag_s as f32,
    })
    .unwrap();
    let core = Cascade::new(&gains, &airframe, Rate::from_hz(500).unwrap(), &CascadeLimits::STANDARD, air).unwrap();
    let (mut memory, mut forces_n) = (CascadeMemory::IN_FLIGHT, [airframe.hover_force_n(); 4]);
    let hover = f64::from(airframe.hover_force_n());
    let craft = crate::cascade::plant::Craft {
        mass_kg: vehicle.mass_kg(),
        inertia: [0, 1, 2].map(|i| inertia[(i, i)]),
        lever_m: motors.half_arm_m(),
        torque_per_thrust_m: motors.torque_per_thrust_m,
        force_max_n: motors.thrust_max_n,
        lag_s: [lag_s; 2],
        delay_s: 0.0,
        drag: [0.4; 3],
        moment: [3.8e-4, 4.3e-4],
        motors: [1.0; 4],
        torque_bias: [0.0; 3],
    };
    let mut plant = crate::cascade::plant::Plant::at(craft, offset(chain), true);
    plant.forces = [hover; 4];
    let sample = FifthOrderSample::at_rest(Vector3::new(0.0_f32, 0.0, 0.0), 0.0);
    let mut trace = Vec::new();
    for _ in 0..steps {
        trace.push(match chain {
            CascadeChain::X => plant.p.x,
            CascadeChain::Y => plant.p.y,
            CascadeChain::Z => plant.p.z,
            CascadeChain::Yaw => plant.q.euler_angles().2,
        });
        let q = plant.q;
        let state = State {
            position_m: plant.p.cast(),
            attitude: Quaternion::new(q.w as f32, q.i as f32, q.j as f32, q.k as f32),
            velocity_m_s: plant.v.cast(),
        };
        let rates = plant.w.cast();
        let (heading, followed) = (Heading::ZERO, Followed::ALL);
        let input = CascadeInput { state: &state, body_rates_rad_s: &rates, sample: &sample, heading, followed };
        let felt = plant.felt.cast();
        let (forces, _) = core.step(&mut memory, &mut forces_n, &input, Some(&felt)).unwrap();
        for _ in 0..4 {
            plant.step(&forces.map(f64::from), &Vector3::zeros(), &Vector3::zeros());
        }
    }
    trace
}

/// 2 cm: large against the rounding of f32, small against every limit.
fn offset(chain: CascadeChain) -> Vector3<f64> {
    match chain {
        CascadeChain::X => Vector3::new(0.02, 0.0, 0.0),
        CascadeChain::Y => Vector3::new(0.0, 0.02, 0.0),
        CascadeChain::Z | CascadeChain::Yaw => Vector3::new(0.0, 0.0, 0.02),
    }
}

#[test]
fn the_certificates_loop_is_the_cores() {
    let (name, lag_s) = ("crazyflie-2.1", 0.0635);
    let (vehicle, numbers) = designed(name, lag_s);
    let air = Air { learn: false, ..Air::BRUSHED };
    let craft = CascadeCraft {
        moment_n_s: [3.8e-4, 4.3e-4],
        told_drag_per_s: f64::from(air.drag_per_s),
        told_moment_n_s: air.moment_n_s.map(f64::from),
        gust: f64::from(air.gust),
        ..CascadeCraft::new(&vehicle, numbers, lag_s, H)
    };
    let at = CascadeVariation {
        drag_per_s: 0.4,
        moment_factor: 1.0,
        believed_drag_per_s: craft.told_drag_per_s,
        ..CascadeVariation::none(lag_s)
    };
    for chain in [CascadeChain::X, CascadeChain::Y, CascadeChain::Z] {
        const STEPS: usize = 1000;
        let core = flown_by_the_core(&vehicle, numbers, lag_s, &air, chain, STEPS);
        let [without, with] = [false, true].map(|looks| chain.matrix(&craft, &at, looks));
        let mut x = DMatrix::zeros(with.nrows(), 1);
        x[0] = 0.02;
        // The core begins with its first estimates: position seen, nothing else remembered.
        let memory = if chain == CascadeChain::Z { 3 } else { 5 };
        x[memory] = 0.02;
        let mut worst = 0.0_f64;
        for (step, flown) in core.iter().enumerate() {
            worst = worst.max((x[0] - flown).abs());
            x = (if step % 5 == 0 { &with } else { &without }) * x;
        }
        // Found: 1e-6. Second-order terms of a tilt of some degrees, rounding to f32.
        assert!(worst < 5e-6, "{chain:?}: {worst:.2e} m");
    }
}

/// Every built-in table with its vehicle.
fn built_in() -> Vec<(Vehicle, BuiltInCascade)> {
    [
        ("crazyflie-2.1-brushless", tables::BRUSHLESS),
        ("crazyflie-2.1", tables::CRAZYFLIE_2_1),
        ("crazyflie-2.1-upgrade-kit", tables::UPGRADE_KIT),
    ]
    .into_iter()
    .flat_map(|(name, tables)| tables.map(|table| (vehicles::by_name(name).unwrap(), table)))
    .collect()
}

fn craft_in_air(vehicle: &Vehicle, table: &CascadeTable) -> CascadeCraft {
    let (numbers, lag_s, air) = (table.gains.numbers().map(f64::from), f64::from(table.motor_lag_s), &table.air);
    let told = air.moment_n_s.map(f64::from);
    CascadeCraft {
        // 80 % of the identified air are told.
        moment_n_s: told.map(|moment| moment / 0.8),
        told_drag_per_s: f64::from(air.drag_per_s),
        told_moment_n_s: told,
        gust: f64::from(air.gust),
        ..CascadeCraft::new(vehicle, numbers, lag_s, H)
    }
}

#[test]
fn every_table_is_stable_over_its_region_in_air() {
    for (vehicle, BuiltInCascade { table, .. }) in built_in() {
        let (name, lag_s) = (vehicle.name(), table.motor_lag_s);
        let [shortest_s, longest_s] = table.certified.motor_lag_s.map(f64::from);
        let craft = craft_in_air(&vehicle, &table);
        // The ends of everything, of the lags the middle as well.
        let ends = |values: &[f64]| vec![values[0], values[values.len() - 1]];
        let all = CascadeRegion::in_air(shortest_s, longest_s);
        let region = CascadeRegion {
            lags_s: vec![all.lags_s[0], all.lags_s[2], all.lags_s[4]],
            mass_factors: ends(&all.mass_factors),
            inertia_factors: ends(&all.inertia_factors),
            command_factors: ends(&all.command_factors),
            drags_per_s: ends(&all.drags_per_s),
            moment_factors: ends(&all.moment_factors),
            believed_drags_per_s: ends(&all.believed_drags_per_s),
            believed_ratio_factors: ends(&all.believed_ratio_factors),
            ..all
        };
        let bounds = [0.9988, 0.9988, 0.9980, 0.9995];
        for (found, bound) in region.certify(&craft).unwrap().iter().zip(bounds) {
            println!("{name}, {lag_s} s, {:?}: radius {:.5}", found.chain, found.spectral_radius);
            assert!(found.spectral_radius < bound, "{name} {lag_s}: {found:?}");
        }
        for found in region.before_its_motors_are_seen().certify(&craft).unwrap() {
            assert!(found.spectral_radius < 0.99985, "{name} {lag_s}: {found:?}");
        }
    }
}

#[test]
fn every_table_has_margins_in_air() {
    for (vehicle, BuiltInCascade { table, margins: stated, delay_max_s, .. }) in built_in() {
        let name = vehicle.name();
        let craft = craft_in_air(&vehicle, &table);
        let lag_s = craft.lag_s;
        let (mut least_gain, mut least_delay) = (f64::INFINITY, f64::INFINITY);
        for chain in CascadeChain::ALL {
            let at = CascadeVariation {
                drag_per_s: craft.told_drag_per_s / 0.8,
                moment_factor: 1.0,
                believed_drag_per_s: craft.told_drag_per_s,
                ..CascadeVariation::none(lag_s)
            };
            let margins = chain.margins(&craft, &at).unwrap();
            let gain = margins.disk.gain_max.unwrap_or(f64::INFINITY);
            let phase_deg = margins.disk.phase_rad.to_degrees();
            let delay_ms = 1e3 * margins.delay_s;
            println!(
                "{name}, {lag_s} s, {chain:?}: gain {gain:.2}, phase {phase_deg:.1} degrees, delay {delay_ms:.1} ms"
            );
            (least_gain, least_delay) = (least_gain.min(gain), least_delay.min(margins.delay_s));
            let least = if matches!(chain, CascadeChain::X | CascadeChain::Y) { 1.8 } else { 2.0 };
            assert!(gain > least && phase_deg > 32.0 && margins.delay_s >= 0.02, "{name} {chain:?}: {margins:?}");
        }
        // The table states a little less: rounded down to four digits.
        for (stated, found) in [(stated.gain_factor, least_gain), (delay_max_s, least_delay)] {
            assert!((0.999..=1.0).contains(&(f64::from(stated) / found)), "{name} {lag_s}: {stated} {found}");
        }
    }
}
