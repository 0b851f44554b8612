#!/usr/bin/env bash
# Guess: the channels of a receiver, in microseconds, are symmetric about the middle of 1500: full deflection is 988
# one way and 2012 the other, as CRSF defines its 172 and 1811, and throttles and trims below 1000 are told apart.
# Observed: the default mapping gives 1000 for 172, for 191 and for 0, and 2012 for 1811 and 2159 for 2047: the
# low end is cut and the high end is not.
# Why it matters: a rate command scaled by the deflection is 2.4 % weaker to the left than to the right at full stick.
# A receiver's failsafe that is set below 1000, as a value that no stick gives, cannot be told from the stick's end.
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
crsf = "=2.0.1"
EOF
cat > "$dir/src/main.rs" <<'EOF'
use crsf::{DefaultChannelsMapper, RcChannels, RcChannelsMapped};

fn main() {
    println!("crsf 2.0.1");
    let mut raw = [992u16; 16];
    raw[..6].copy_from_slice(&[0, 172, 191, 992, 1811, 2047]);
    let mapped = RcChannelsMapped::<DefaultChannelsMapper>::new(&RcChannels(raw));
    println!("{:?} are {:?} microseconds", &raw[..6], &mapped[..6]);
    assert!(mapped[..5] == [1000, 1000, 1000, 1500, 2012] && mapped[5] > 2100);
}
EOF
CARGO_TARGET_DIR="$dir/target" cargo run -q --manifest-path "$dir/Cargo.toml" | tee "$dir/out"
