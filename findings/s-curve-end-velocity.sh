#!/usr/bin/env bash
# Guess: a generator of S-curves whose own check calls a move feasible ("certainly doable") makes a curve that ends
# where, and as fast as, it was asked, without steps.
# Observed: from rest it does. 1 m from rest to 1 m/s under 3 m/s, 1 m/s^2 and 2 m/s^3, feasible by its check, is
# a curve of 2 s that stays at 0 with no speed to its end; started at 0.5 m/s it goes on at 0.5 m/s to 0.67 m. -1 m
# with an end speed of 0.5 m/s has a step of 0.36 m in the position on its way. Nothing is reported.
# Why it matters: legs of a course are joined at speed. The position controller gets a setpoint that stays behind and
# then jumps to the next leg's start, with no acceleration to go with it.
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
s_curve = "=0.1.7"
EOF
cat > "$dir/src/main.rs" <<'EOF'
use s_curve::{s_curve_generator, Derivative, SCurveConstraints, SCurveInput, SCurveStartConditions};

/// Duration, end and end speed of a move, and its largest step in a thousandth of the time.
fn fly(q1: f64, v0: f64, v1: f64) -> [f64; 4] {
    let input = SCurveInput {
        constraints: SCurveConstraints { max_jerk: 2.0, max_acceleration: 1.0, max_velocity: 3.0 },
        start_conditions: SCurveStartConditions { q0: 0.0, q1, v0, v1 },
    };
    assert!(input.is_trajectory_feasible());
    let (parameters, position) = s_curve_generator(&input, Derivative::Position);
    let (_, velocity) = s_curve_generator(&input, Derivative::Velocity);
    let end = parameters.time_intervals.total_duration();
    let at = |k: usize| position(end * k as f64 / 1000.0);
    let step = (0..1000).map(|k| (at(k + 1) - at(k)).abs()).fold(0.0, f64::max);
    let result = [end, position(end), velocity(end), step];
    println!("to {q1} m, from {v0} to {v1} m/s: {:.2} s, ends at {:.3} m with {:.2} m/s, largest step {:.4} m", result[0], result[1], result[2], result[3]);
    result
}

fn main() {
    println!("s_curve 0.1.7");
    let rest = fly(1.0, 0.0, 0.0);
    assert!((rest[1] - 1.0).abs() < 1e-3 && rest[2].abs() < 1e-3 && rest[3] < 0.01);
    let still = fly(1.0, 0.0, 1.0);
    assert!(still[1].abs() < 1e-9 && still[2].abs() < 1e-9 && (still[0] - 2.0).abs() < 1e-9);
    let short = fly(1.0, 0.5, 1.0);
    assert!((short[1] - 0.667).abs() < 1e-3 && (short[2] - 0.5).abs() < 1e-9);
    let jumps = fly(-1.0, 0.0, 0.5);
    assert!(jumps[3] > 0.3);
}
EOF
CARGO_TARGET_DIR="$dir/target" cargo run -q --manifest-path "$dir/Cargo.toml" | tee "$dir/out"
