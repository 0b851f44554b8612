#!/usr/bin/env bash
# Guess: a second-order low-pass in single precision passes a constant as it is; a low-pass is for that. A
# cutoff that is too low for the precision is refused, as one that is too high is.
# Observed: at 8 kHz a cutoff of 2 Hz makes 10.4 of a constant 9.81, 1 Hz 8.7 and 0.5 Hz 15.9, or 10.0, 10.2 and
# 8.0 in the filter's other form; at 0.25 Hz the output is 0 for ever. The numerator is a difference of 1 and a
# cosine, of which single precision leaves a few steps or none. With f64 all are right. (0.5.0 has the same, from four
# times the frequency: its cutoffs are a quarter.)
# Why it matters: accelerometer and battery are filtered with such cutoffs on a flight controller, in f32 and at the
# gyro's rate. Gravity of 16 m/s^2 is nothing that a test with sines at 80 Hz would show.
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
biquad = "=0.4.2"
EOF
cat > "$dir/src/main.rs" <<'EOF'
use biquad::{Biquad, Coefficients, DirectForm1, DirectForm2Transposed, ToHertz, Type, Q_BUTTERWORTH_F32, Q_BUTTERWORTH_F64};

fn main() {
    println!("biquad 0.4.2");
    let cases = [(1000.0f32, 80.0f32, 9.81f32), (8000.0, 10.0, 9.79), (8000.0, 2.0, 10.38), (8000.0, 1.0, 8.70), (8000.0, 0.5, 15.88), (8000.0, 0.25, 0.0)];
    let mut got_all = Vec::new();
    for (rate, cutoff, want) in cases {
        let single = Coefficients::<f32>::from_params(Type::LowPass, rate.hz(), cutoff.hz(), Q_BUTTERWORTH_F32).unwrap();
        let double = Coefficients::<f64>::from_params(Type::LowPass, (rate as f64).hz(), (cutoff as f64).hz(), Q_BUTTERWORTH_F64).unwrap();
        let (mut first, mut second, mut exact) = (DirectForm1::<f32>::new(single), DirectForm2Transposed::<f32>::new(single), DirectForm1::<f64>::new(double));
        let mut got = (0.0, 0.0, 0.0);
        for _ in 0..(10.0 * rate / cutoff) as usize {
            got = (first.run(9.81), second.run(9.81), exact.run(9.81));
        }
        println!("{rate} Hz, cutoff {cutoff} Hz, a constant of 9.81: {:.2} by form 1, {:.2} by form 2 transposed, {:.2} in f64", got.0, got.1, got.2);
        got_all.push((got, want));
    }
    for (got, want) in got_all {
        assert!((got.0 - want).abs() < 0.05 && (got.2 - 9.81f64).abs() < 1e-3);
    }
}
EOF
CARGO_TARGET_DIR="$dir/target" cargo run -q --manifest-path "$dir/Cargo.toml" | tee "$dir/out"
