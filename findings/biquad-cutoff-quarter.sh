#!/usr/bin/env bash
# Guess: a Butterworth low-pass asked for 80 Hz at a sample rate of 1 kHz lets 0.71 of a sine of 80 Hz through, and
# the next version of the same crate, called in the same way, does too.
# Observed: 0.4.2 does. 0.5.0 lets 0.06 through; its 0.71 is at 20 Hz, a quarter of the one asked for, and so for a
# notch, which takes out 20 Hz and leaves the 80 Hz that it was set on. from_params divides the cutoff by twice the
# sample rate where it should multiply by two. A cutoff above half the sample rate is no longer refused: up to twice
# the rate is taken.
# Why it matters: a gyro filter at a quarter of its cutoff has four times the delay; with 80 Hz in the loop the rate
# controller loses 50 degrees more of phase at 15 Hz. The version of a dependency is all that changed.
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
biquad = "=0.5.0"
before = { package = "biquad", version = "=0.4.2" }
EOF
cat > "$dir/src/main.rs" <<'EOF'
use std::f64::consts::PI;

fn gain(mut run: impl FnMut(f64) -> f64, frequency: f64) -> f64 {
    let (mut inphase, mut across) = (0.0, 0.0);
    for k in 0..6000 {
        let (sine, cosine) = (2.0 * PI * frequency * k as f64 / 1000.0).sin_cos();
        let y = run(sine);
        if k >= 1000 {
            inphase += y * sine / 2500.0;
            across += y * cosine / 2500.0;
        }
    }
    f64::hypot(inphase, across)
}

macro_rules! filters {
    ($name:ident) => {
        fn $name(frequency: f64, notch: bool) -> f64 {
            use ::$name::{Biquad, DirectForm1, Type};
            let mut filter = DirectForm1::<f64>::new(taken::$name(if notch { Type::Notch } else { Type::LowPass }, 80.0, if notch { 5.0 } else { 0.5f64.sqrt() }).unwrap());
            gain(move |x| filter.run(x), frequency)
        }
    };
}
filters!(biquad);
filters!(before);

/// The coefficients at a sample rate of 1 kHz, if they are to be had.
mod taken {
    macro_rules! coefficients {
        ($name:ident) => {
            pub fn $name(kind: ::$name::Type<f64>, cutoff: f64, q: f64) -> Option<::$name::Coefficients<f64>> {
                use ::$name::ToHertz;
                ::$name::Coefficients::<f64>::from_params(kind, 1000.0f64.hz(), cutoff.hz(), q).ok()
            }
        };
    }
    coefficients!(biquad);
    coefficients!(before);
}

fn main() {
    println!("biquad 0.5.0, and 0.4.2 before it");
    let low_pass = [biquad(20.0, false), biquad(80.0, false), before(20.0, false), before(80.0, false)];
    println!("low-pass for 80 Hz at 1 kHz, gain at 20 and 80 Hz: {:.3} {:.3}, before {:.3} {:.3}", low_pass[0], low_pass[1], low_pass[2], low_pass[3]);
    assert!((low_pass[0] - 0.707).abs() < 2e-3 && low_pass[1] < 0.07);
    assert!(low_pass[2] > 0.99 && (low_pass[3] - 0.707).abs() < 2e-3);
    let notch = [biquad(20.0, true), biquad(80.0, true), before(20.0, true), before(80.0, true)];
    println!("notch for 80 Hz, gain at 20 and 80 Hz: {:.3} {:.3}, before {:.3} {:.3}", notch[0], notch[1], notch[2], notch[3]);
    assert!(notch[0] < 0.01 && notch[1] > 0.95 && notch[2] > 0.95 && notch[3] < 0.01);
    let above = (taken::biquad(::biquad::Type::LowPass, 800.0, 0.7).is_some(), taken::before(::before::Type::LowPass, 800.0, 0.7).is_some());
    println!("a cutoff of 800 Hz is taken: {}, before {}", above.0, above.1);
    assert!(above == (true, false));
}
EOF
CARGO_TARGET_DIR="$dir/target" cargo run -q --manifest-path "$dir/Cargo.toml" | tee "$dir/out"
