#!/usr/bin/env bash
# Guess: UnitQuaternion::mean_of two equal attitudes is that attitude, and append_axisangle_linearized appends the
# gyro's measurement of a step, a turn about the body's axes.
# Observed: the mean of two identities is a half turn about z; of two yaws of 0.1 rad it is a rotation of 180
# degrees, with a roll of 0.1 and a yaw of pi. The four numbers of the mean are right and are taken in the wrong
# order: the last, which is the scalar, for z. append_axisangle_linearized multiplies from the left: rolled by 90
# degrees and turning about its z axis by 1 rad in small steps, the attitude ends 1.38 rad from where the gyro went,
# and is that of a turn about the world's z. Level craft see no difference.
# Why it matters: the mean is how a reference attitude is made of a hover's samples, the other how a rate is
# integrated without sines.
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
nalgebra = { version = "=0.35.0", default-features = false, features = ["std"] }
EOF
cat > "$dir/src/main.rs" <<'EOF'
use nalgebra::{UnitQuaternion, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};

fn main() {
    println!("nalgebra 0.35.0");
    let identity = UnitQuaternion::<f64>::identity();
    let mean = UnitQuaternion::mean_of(vec![identity, identity]);
    println!("mean of two identities: a turn by {:.3} rad about {:?}", mean.angle(), mean.axis().unwrap().as_slice());
    assert!((mean.angle() - PI).abs() < 1e-9 && (mean.axis().unwrap().z.abs() - 1.0).abs() < 1e-9);
    let yaw = UnitQuaternion::from_euler_angles(0.0, 0.0, 0.1);
    let mean = UnitQuaternion::mean_of(vec![yaw, yaw]);
    println!("mean of two yaws of 0.1: roll, pitch, yaw {:.3?}, a turn of {:.3} rad", mean.euler_angles(), mean.angle());
    assert!((mean.angle() - PI).abs() < 1e-6 && (mean.euler_angles().0 - 0.1).abs() < 1e-6);

    let step = Vector3::new(0.0, 0.0, 1e-3);
    for roll in [0.0, FRAC_PI_2] {
        let start = UnitQuaternion::from_euler_angles(roll, 0.0, 0.0);
        let turn = UnitQuaternion::from_scaled_axis(step * 1000.0);
        let end = (0..1000).fold(start, |q, _| q.append_axisangle_linearized(&step));
        let (from_body, from_world) = (end.angle_to(&(start * turn)), end.angle_to(&(turn * start)));
        println!("rolled by {roll:.2}, 1 rad about z in steps: {from_body:.6} rad from the turn about the body's axis, {from_world:.6} from the world's");
        assert!(from_world < 1e-4 && if roll == 0.0 { from_body < 1e-4 } else { from_body > 1.3 });
    }
}
EOF
CARGO_TARGET_DIR="$dir/target" cargo run -q --manifest-path "$dir/Cargo.toml" | tee "$dir/out"
