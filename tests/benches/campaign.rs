//! Sixteen runs of a campaign on one core: the eight of 30 s under masses and inertias that are drawn.

use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use quatrack_campaign::definition::Asked;
use quatrack_campaign::{Campaign, fly::Crew};

const RUNS: u64 = 16;

fn campaigns(criterion: &mut Criterion) {
    let dir = tempfile::tempdir().expect("a folder for temporary files");
    let mut group = criterion.benchmark_group("campaign");
    group.sample_size(10).measurement_time(Duration::from_secs(3)).throughput(Throughput::Elements(RUNS));
    for (name, law, air) in [
        ("actuator-aware, vacuum", "actuator-aware", ""),
        ("quatrack, vacuum", "quatrack", ""),
        ("quatrack, air", "quatrack", "[air]\ndrag_per_s = [0.4, 0.4, 0.4]\nmoment_n_m_per_m_s = [7e-4, 9e-4]\n"),
    ] {
        let text = format!(
            "vehicle = \"crazyflie-2.1-brushless\"\ncourse = \"eight\"\nduration_s = 25.0\nlaws = [\"{law}\"]\n{air}[vary]\n\
             errors.mass_factor = {{ uniform = [0.95, 1.05] }}\nerrors.inertia_factor = {{ uniform = [0.9, 1.1] }}\n"
        );
        let path = dir.path().join("bench.toml");
        std::fs::write(&path, text).expect("it can be written");
        let none = |name: &str| Err(format!("{name}: no trajectory is flown here"));
        let campaign = Campaign::read(&path, &Asked::default(), &none).expect("it has sense");
        let mut crew = Crew::default();
        group.bench_function(name, |bencher| bencher.iter(|| crew.fly(&campaign, 0..RUNS)));
    }
    group.finish();
}

criterion_group!(benches, campaigns);
criterion_main!(benches);
