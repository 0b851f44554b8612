#!/usr/bin/env bash
# Guess: the last() of a buffer that keeps the newest values is the newest, iter() and windows(2) go from the oldest
# to the newest.
# Observed: HistoryBuf gives itself as a slice in the order of storage: of the values 0 to 5 in a buffer of four,
# last() is 3 and first() is 4; windows(2) has one difference of -3 among the ones. recent() is 5, oldest_ordered() is
# in order. Until the buffer has been filled once, all of them agree.
# Why it matters: a derivative or a median of a gyro over such a buffer is right for the first N samples, in a unit
# test, and has one wild sample per round in flight.
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
heapless = "=0.9.4"
EOF
cat > "$dir/src/main.rs" <<'EOF'
use heapless::HistoryBuf;

fn main() {
    println!("heapless 0.9.4");
    let mut buffer = HistoryBuf::<i32, 4>::new();
    (0..4).for_each(|k| buffer.write(k));
    println!("0 to 3: last {:?}, newest {:?}", buffer.last(), buffer.recent());
    assert!(buffer.last() == Some(&3) && buffer.recent() == Some(&3));
    (4..6).for_each(|k| buffer.write(k));
    let steps: Vec<i32> = buffer.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let ordered: Vec<i32> = buffer.oldest_ordered().copied().collect();
    println!("0 to 5: slice {:?}, last {:?}, first {:?}, newest {:?}, differences {steps:?}, oldest_ordered {ordered:?}", buffer.as_slice(), buffer.last(), buffer.first(), buffer.recent());
    assert!(buffer.last() == Some(&3) && buffer.first() == Some(&4) && buffer.recent() == Some(&5));
    assert!(steps == [1, -3, 1] && ordered == [2, 3, 4, 5]);
}
EOF
CARGO_TARGET_DIR="$dir/target" cargo run -q --manifest-path "$dir/Cargo.toml" | tee "$dir/out"
