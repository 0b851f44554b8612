//! Riccati equations by their number of states: CARE and DARE of the same pair, which is unstable. `python/benchmarks/riccati.py` has
//! SciPy beside them on the same matrices.

use std::time::Duration;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use nalgebra::DMatrix;
use quatrack_design::design::{care, dare};

/// Entries between -1 and 1 without a pattern: the sine of the square of their number, by rows.
fn matrix(rows: usize, columns: usize, from: usize) -> DMatrix<f64> {
    DMatrix::from_fn(rows, columns, |i, j| ((from + i * columns + j) as f64).powi(2).sin())
}

fn equations(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("riccati");
    group.sample_size(10).measurement_time(Duration::from_secs(2));
    for n in [4_usize, 6, 9, 20, 30, 40] {
        let m = n.div_ceil(4);
        let (a, b) = (matrix(n, n, 0), matrix(n, m, 5000));
        let (q, r) = (DMatrix::identity(n, n), DMatrix::identity(m, m));
        group.bench_with_input(BenchmarkId::new("care", n), &n, |bencher, _| {
            bencher.iter(|| care(&a, &b, &q, &r).expect("it has a solution"));
        });
        group.bench_with_input(BenchmarkId::new("dare", n), &n, |bencher, _| {
            bencher.iter(|| dare(&a, &b, &q, &r).expect("it has a solution"));
        });
    }
    group.finish();
}

criterion_group!(benches, equations);
criterion_main!(benches);
