#!/usr/bin/env bash
# Guess: a first-order low-pass in fixed point comes as near to its input as a step of the format divided by its gain,
# from either side.
# Observed: y += 0.01 (x - y) in I16F16, whose step is 0.000015, reaches 1 exactly from above and stops at 0.9985
# from below, a hundred steps short; to zero it comes from above, and from below it stops at -0.0015. A product is
# rounded towards minus infinity, not to nearest: -0.001 times 0.001 is -0.000015 and 0.001 times 0.001 is 0. So is a
# conversion to an integer: -0.00001 becomes -1. A division is rounded towards zero.
# Why it matters: noise does not average out over it, it drags the filter's output down: an estimate of a gyro's bias,
# or an integrator with a leak, has an offset with a sign.
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
fixed = "=1.31.0"
EOF
cat > "$dir/src/main.rs" <<'EOF'
use fixed::types::I16F16;

fn settle(from: f64, to: f64) -> f64 {
    let (gain, target) = (I16F16::from_num(0.01), I16F16::from_num(to));
    let mut y = I16F16::from_num(from);
    for _ in 0..100_000 {
        y += gain * (target - y);
    }
    y.to_num()
}

fn main() {
    println!("fixed 1.31.0, step {:.6}", I16F16::DELTA.to_num::<f64>());
    let ends = [settle(0.0, 1.0), settle(2.0, 1.0), settle(-1.0, 0.0), settle(1.0, 0.0)];
    println!("to 1 from 0 and 2: {:.5} {:.5}; to 0 from -1 and 1: {:.5} {:.5}", ends[0], ends[1], ends[2], ends[3]);
    assert!(ends[0] < 0.9986 && ends[1] == 1.0 && ends[2] < -0.0014 && ends[3] == 0.0);
    let small = I16F16::from_num(0.001);
    println!("-0.001 * 0.001 = {}, 0.001 * 0.001 = {}; -0.00001 as an integer {}; -1/3 = {}", -small * small, small * small, I16F16::from_num(-0.00001).to_num::<i32>(), I16F16::from_num(-1) / 3);
    assert!(-small * small == -I16F16::DELTA && small * small == 0 && I16F16::from_num(-0.00001).to_num::<i32>() == -1);
    assert!((I16F16::from_num(-1) / 3).to_bits() == -21845);
}
EOF
CARGO_TARGET_DIR="$dir/target" cargo run -q --manifest-path "$dir/Cargo.toml" | tee "$dir/out"
