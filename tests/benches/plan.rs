//! The paper's two trajectories, from waypoints and bounds to a curve.

use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use quatrack_plan::plan::paper;

fn plans(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("plan");
    group.sample_size(10).measurement_time(Duration::from_secs(3));
    for (name, plan) in [("mild", paper::mild()), ("aggressive", paper::aggressive())] {
        let plan = plan.expect("it is a plan");
        group.bench_function(name, |bencher| bencher.iter(|| plan.solve().expect("there is a curve")));
    }
    group.finish();
}

criterion_group!(benches, plans);
criterion_main!(benches);
