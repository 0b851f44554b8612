#!/usr/bin/env bash
# Guess: a crate's commands for a motor controller have the numbers of the DShot protocol, as Betaflight and the
# controllers' firmware have them (dshot_command.h): 9 turns the 3D mode off, 10 turns it on, 32 turns the telemetry
# on the signal line off.
# Observed: ThreeDModeOn is sent as 9 and ThreeDModeOff as 10, SignalLineTelemetryEnable as 32 and
# SignalLineTelemetryDisable as 33: both pairs are the other way round. The beeps, the directions of rotation and the
# lights are right.
# Why it matters: in 3D mode half of the throttle range turns the motor backwards, and a low throttle becomes full
# reverse. A start-up that makes sure that the mode is off, and saves that, turns it on for good.
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
dshot-frame = "=0.4.0"
EOF
cat > "$dir/src/main.rs" <<'EOF'
use dshot_frame::{Command, Frame, NormalDshot};

fn number(command: Command) -> u16 {
    Frame::<NormalDshot>::command(command, false).inner() >> 5
}

fn main() {
    println!("dshot-frame 0.4.0");
    let sent = [
        ("ThreeDModeOff", number(Command::ThreeDModeOff), 9),
        ("ThreeDModeOn", number(Command::ThreeDModeOn), 10),
        ("SignalLineTelemetryDisable", number(Command::SignalLineTelemetryDisable), 32),
        ("SignalLineTelemetryEnable", number(Command::SignalLineTelemetryEnable), 33),
    ];
    for (name, number, protocol) in sent {
        println!("{name}: sent as {number}, {protocol} in the protocol");
    }
    assert!(sent.map(|(_, number, _)| number) == [10, 9, 33, 32]);
    let right = [number(Command::MotorStop), number(Command::Beep1), number(Command::SettingsSave), number(Command::SpinDirectionNormal), number(Command::Led0On)];
    assert!(right == [0, 1, 12, 20, 22]);
}
EOF
CARGO_TARGET_DIR="$dir/target" cargo run -q --manifest-path "$dir/Cargo.toml" | tee "$dir/out"
