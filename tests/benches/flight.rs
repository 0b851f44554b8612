//! The eight of 30 s, of which 25 s are measured, flown alone as `quatrack fly` does, every row of it kept.

use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use quatrack_simulation::scenario::file::ScenarioFile;
use quatrack_simulation::scenario::{Law, Scenario};

fn flights(criterion: &mut Criterion) {
    let text = "vehicle = \"crazyflie-2.1-brushless\"\ncourse = \"eight\"\nduration_s = 25.0\n";
    let file = ScenarioFile::parse(text, "bench").expect("it is a scenario");
    let scenario = Scenario::checked(&file, "bench", "".as_ref()).expect("it has sense");
    let flown = scenario.flown(None);
    let mut group = criterion.benchmark_group("flight");
    group.sample_size(10).measurement_time(Duration::from_secs(3));
    for law in [Law::ActuatorAware, Law::Quatrack, Law::Crazyflie, Law::Mellinger, Law::LqrE] {
        group.bench_function(law.name(), |bencher| {
            bencher.iter(|| {
                let mut law = law.start(&scenario.vehicle, &scenario.told).expect("it flies this vehicle");
                scenario.fly(law.as_mut(), &flown).expect("it can be flown from its start")
            });
        });
    }
    group.finish();
}

criterion_group!(benches, flights);
criterion_main!(benches);
