//! One control step of each law: the paper's to thrust and body rates, ours down to the motors.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use quatrack::gains::paper;
use quatrack::nalgebra::Vector3;
use quatrack::{
    ActuatorAware, Controller, Equilibrium, FifthOrderSample, FlatOutput, FlatSample, Heading, Limits, Measured,
    Memory, MotorReference, Target,
};
use quatrack_simulation::flight::motor_loop::RATE;
use quatrack_simulation::scenario::file::ScenarioFile;
use quatrack_simulation::scenario::{Scenario, actuation_of, actuator_aware_of, flown_cascade};
use quatrack_tests::cases::case;

fn steps(criterion: &mut Criterion) {
    let file = ScenarioFile::of_vehicle("crazyflie-2.1-brushless");
    let scenario = Scenario::checked(&file, "bench", "".as_ref()).expect("the defaults have sense");
    let (vehicle, told) = (&scenario.vehicle, &scenario.told);
    let case = case(7, 0.0);
    let (state, reference) = (&case.state, &case.reference);
    let rates = Vector3::new(0.3, -0.2, 0.1);
    let felt = Vector3::new(0.1, 0.0, 9.8);
    let measured = Measured::new(state).with_body_rates(&rates).with_specific_force(&felt);

    let limits = Limits::new(1.8, 16.5, Vector3::new(20.0, 20.0, 10.0)).expect("in range");
    let equilibrium = Controller::new(Equilibrium::new(&paper::LQR_E), limits);
    let flat_output = Controller::new(FlatOutput::new(&paper::LQR_F), limits);
    let (gain, lag_s) = actuator_aware_of(vehicle, told).expect("there is a design");
    let actuation = actuation_of(vehicle, told, lag_s, RATE).expect("the core takes the vehicle");
    let aware = Controller::new(ActuatorAware::new(&gain, &actuation), Limits::NONE);
    let cascade = flown_cascade(vehicle, told).expect("there is a design");
    let ours = Controller::new(&cascade, Limits::NONE);

    let sample = FifthOrderSample::of_jerk(FlatSample { heading_rad: 0.0, heading_rate_rad_s: 0.0, ..case.sample });
    let motors = MotorReference::from_flat(&sample, actuation.airframe()).expect("it can be flown");
    let followed = Target::with_sample(&sample, Heading::ZERO);

    let mut group = criterion.benchmark_group("step");
    let mut step = |name: &str, controller: &Controller<'_>, target: Target<'_>, airframe: &quatrack::Airframe| {
        let mut memory = Memory::hovering(airframe);
        group.bench_function(name, |bencher| {
            bencher.iter(|| controller.step(&mut memory, black_box(measured), black_box(target)));
        });
    };
    step("lqr-e", &equilibrium, Target::new(reference), actuation.airframe());
    step("lqr-f", &flat_output, Target::new(reference), actuation.airframe());
    step("actuator-aware", &aware, Target::with_forces(&motors), actuation.airframe());
    step("quatrack", &ours, followed, cascade.airframe());
    group.finish();
}

criterion_group!(benches, steps);
criterion_main!(benches);
