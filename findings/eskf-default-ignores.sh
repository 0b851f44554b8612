#!/usr/bin/env bash
# Guess: a filter made as in the crate's own example, "a default filter", is moved by an observation, and its
# uncertainty with it, as the example's comments say. Variances are squares of deviations, as the word says.
# Observed: the default's uncertainty is 0, of the sensors too, and so is every gain: after a fix 10 m away the position
# is still 0.00 m, and nothing is reported. acceleration_variance(0.5) squares what it is given, and so does
# rotation_variance; the variances of the observations are taken as they are.
# Why it matters: the fixes arrive, and the craft flies on integrated noise. A sensor's variance of 0.01, put where
# a variance is asked for, is one of 0.0001, and the filter trusts the sensor a hundred times too much.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
mkdir "$dir/src"
cat > "$dir/Cargo.toml" <<'EOF'
[package]
name = "finding"
version = "0.0.0"
edition = "2021"
[dependencies]
eskf = "=0.2.0"
nalgebra = "=0.25.4"
EOF
cat > "$dir/src/main.rs" <<'EOF'
use eskf::{Builder, ESKF};
use nalgebra::{Point3, Vector3};
use std::time::Duration;

const STEP: Duration = Duration::from_millis(1000);

fn main() {
    println!("eskf 0.2.0");
    let rest = Vector3::new(0.0, 0.0, -9.81);
    let fix = |mut filter: ESKF, what: &str| {
        filter.predict(rest, Vector3::zeros(), STEP);
        filter.observe_position(Point3::new(10.0, 0.0, 0.0), ESKF::variance_from_element(0.25)).unwrap();
        println!("{what}: a fix at 10 m gives {:.2} m, uncertainty {:.2} m", filter.position.x, filter.position_uncertainty().x);
        (filter.position.x, filter.position_uncertainty().x)
    };
    assert!(fix(Builder::new().build(), "the default filter") == (0.0, 0.0));
    assert!(fix(Builder::new().acceleration_variance(0.5).initial_covariance(1.0).build(), "with an initial covariance of 1").0 > 8.0);

    let mut filter = Builder::new().acceleration_variance(0.5).rotation_variance(0.5).build();
    filter.predict(rest, Vector3::zeros(), STEP);
    let (velocity, angle) = (filter.velocity_uncertainty().x, filter.orientation_uncertainty().x);
    println!("variances of 0.5 for 1 s: uncertainty {velocity:.3} m/s and {angle:.3} rad; of a variance of 0.5 it is {:.3}", 0.5_f32.sqrt());
    assert!((velocity - 0.5).abs() < 1e-6 && (angle - 0.5).abs() < 1e-6);
}
EOF
CARGO_TARGET_DIR="$dir/target" cargo run -q --manifest-path "$dir/Cargo.toml" | tee "$dir/out"
