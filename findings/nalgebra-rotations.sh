#!/usr/bin/env bash
# Guess: nalgebra's unit quaternions convert, interpolate and compare as rotations do.
# Observed: from_matrix of a half turn about y gives the identity, with no error; from_rotation_matrix gives the
# half turn. euler_angles at a pitch of 90 degrees gives a roll and a yaw whose rotation is up to 130 degrees from the
# one that was given. Half of the way to a yaw of 11.5 degrees whose quaternion is stored with the other sign, nlerp
# is turned by 174 degrees and slerp by 5.7. And q == -q is true, so that no test of equality sees the difference.
# Why it matters: a host simulation logs angles, initialises attitudes from matrices and blends setpoints with these
# calls. A half turn that becomes level is a craft that is upside down and is told that it is not.
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
nalgebra = { version = "=0.35.0", default-features = false, features = ["std", "macros"] }
EOF
cat > "$dir/src/main.rs" <<'EOF'
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use std::f64::consts::PI;

fn degrees(q: &UnitQuaternion<f64>) -> f64 {
    q.angle().to_degrees()
}

fn main() {
    println!("nalgebra 0.35.0");
    let half_turn = Matrix3::from_diagonal(&Vector3::new(-1.0, 1.0, -1.0));
    let read = UnitQuaternion::from_matrix(&half_turn);
    let direct = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(half_turn));
    println!("half turn about y: from_matrix gives an angle of {:.1} degrees, from_rotation_matrix {:.1}",
        degrees(&read), degrees(&direct));

    let mut worst = (0.0, 0.0, 0.0, 0.0);
    for roll in -17..=17 {
        for yaw in -17..=17 {
            for offset in [0.0, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6] {
                let (r, p, y) = (roll as f64 * PI / 18.0, PI / 2.0 - offset, yaw as f64 * PI / 18.0);
                let q = UnitQuaternion::from_euler_angles(r, p, y);
                let (a, b, c) = q.euler_angles();
                let off = q.angle_to(&UnitQuaternion::from_euler_angles(a, b, c)).to_degrees();
                if off > worst.0 {
                    worst = (off, r.to_degrees(), 90.0 - offset.to_degrees(), y.to_degrees());
                }
            }
        }
    }
    println!("euler_angles and back, at and near a pitch of 90 degrees: off by up to {:.1} degrees (roll {:.0}, pitch {}, yaw {:.0})",
        worst.0, worst.1, worst.2, worst.3);

    let from = UnitQuaternion::from_euler_angles(0.0, 0.0, 0.0);
    let to = UnitQuaternion::new_unchecked(-UnitQuaternion::from_euler_angles(0.0, 0.0, 0.2).into_inner());
    println!("half of the way to a yaw of 11.5 degrees, stored as -q: nlerp {:.1} degrees, slerp {:.1}",
        degrees(&from.nlerp(&to, 0.5)), degrees(&from.slerp(&to, 0.5)));
    println!("q == -q: {}", to == UnitQuaternion::from_euler_angles(0.0, 0.0, 0.2));
}
EOF
CARGO_TARGET_DIR="$dir/target" cargo run -q --manifest-path "$dir/Cargo.toml" | tee "$dir/out"
grep -q 'from_matrix gives an angle of 0.0 degrees, from_rotation_matrix 180.0' "$dir/out"
grep -Eq 'off by up to 1[0-9]{2}\.' "$dir/out"
grep -q 'nlerp 174.3 degrees, slerp 5.7' "$dir/out"
grep -q 'q == -q: true' "$dir/out"
