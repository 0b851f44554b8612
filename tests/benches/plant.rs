//! 2 ms of the plant: one Runge-Kutta step, alone and four side by side.

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{Vector3, Vector4};
use quatrack_simulation::plant::{Environment, Plant, PlantGroup, RigidState, Truth, Wind};
use quatrack_simulation::vehicles;

fn plants(criterion: &mut Criterion) {
    let vehicle = vehicles::by_name("crazyflie-2.1-brushless").expect("it is built in");
    let hover_n = vehicle.hover_thrust_n();
    let mut air = Environment { wind: Wind::constant(Vector3::new(1.0, 0.5, 0.0)), ..Environment::VACUUM };
    (air.air.drag_per_s, air.air.moment_n_m_per_m_s) = ([0.4; 3], [7e-4; 2]);
    let made = |environment: &Environment| {
        let start = RigidState::at_rest(Vector3::z(), hover_n);
        Plant::new(&vehicle, environment, &Truth::as_designed(&vehicle), &start, 1).expect("it can be flown")
    };
    let commands_n = Vector4::repeat(hover_n);
    let mut group = criterion.benchmark_group("plant");
    for (name, environment) in [("vacuum", &Environment::VACUUM), ("air", &air)] {
        let mut plant = made(environment);
        group.bench_function(name, |bencher| bencher.iter(|| plant.advance(&commands_n, 0.002)));
        let mut four = PlantGroup::new((0..PlantGroup::MOST).map(|_| made(environment)).collect());
        group.bench_function(format!("{name}, four"), |bencher| {
            bencher.iter(|| four.advance(&[commands_n; PlantGroup::MOST], 0.002));
        });
    }
    group.finish();
}

criterion_group!(benches, plants);
criterion_main!(benches);
