#!/usr/bin/env bash
# Guess: a parser of PX4's logs gives a topic's messages by its name, all motors of a report, and the log's duration.
# Observed: of an array of reports it reads the first, and what follows from the wrong bytes: of two motors that turn
# with 8000 and 9000 one is there, and their number, 2, is 0. Of two gyros a name gives one or the other by chance,
# anew at each parse. The "messages" are lists of one field each: a rate of 100 Hz is none, and a log of 2 s lasts 0.
# pyulog reads all of it as it was written.
# Why it matters: the motor that fails is not in the log, and a comparison of two flights compares two sensors.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
mkdir "$dir/src"
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" -q --disable-pip-version-check install --no-compile --no-deps pyulog==1.2.2 numpy==2.4.6
cat > "$dir/Cargo.toml" <<'EOF'
[package]
name = "finding"
version = "0.0.0"
edition = "2021"
[dependencies]
ulog-rs = "=0.0.4"
EOF
cat > "$dir/src/main.rs" <<'EOF'
use std::collections::BTreeSet;
use ulog_rs::{ulog::ULog, ULogValue};

fn message(kind: u8, body: &[u8]) -> Vec<u8> {
    [&(body.len() as u16).to_le_bytes()[..], &[kind], body].concat()
}

/// 2 s of two gyros at 100 Hz, and one report of two motors.
fn log() -> Vec<u8> {
    let mut bytes = [&b"ULog\x01\x12\x35\x01"[..], &1_000_000u64.to_le_bytes()].concat();
    bytes.extend(message(b'B', &[0; 40]));
    for format in [
        "sensor_gyro:uint64_t timestamp;float x;float y;float z;",
        "esc_report:uint64_t timestamp;int32_t esc_rpm;uint8_t esc_state;uint8_t[3] _padding0;",
        "esc_status:uint64_t timestamp;esc_report[2] esc;uint8_t esc_count;",
    ] {
        bytes.extend(message(b'F', format.as_bytes()));
    }
    for (multi, id, name) in [(0u8, 0u16, "sensor_gyro"), (1, 1, "sensor_gyro"), (0, 2, "esc_status")] {
        bytes.extend(message(b'A', &[&[multi][..], &id.to_le_bytes(), name.as_bytes()].concat()));
    }
    for k in 0..=200u64 {
        for id in [0u16, 1] {
            let time = 1_000_000 + 10_000 * k;
            let rates = [0.1f32, 0.2, 0.3].map(|rate| rate + f32::from(id)).map(f32::to_le_bytes).concat();
            bytes.extend(message(b'D', &[&id.to_le_bytes()[..], &time.to_le_bytes(), &rates].concat()));
        }
    }
    let report = |rpm: i32| [&2_900_000u64.to_le_bytes()[..], &rpm.to_le_bytes(), &[1, 0, 0, 0]].concat();
    bytes.extend(message(b'D', &[&2u16.to_le_bytes()[..], &3_000_000u64.to_le_bytes(), &report(8000), &report(9000), &[2]].concat()));
    bytes
}

fn main() {
    std::fs::write("log.ulg", log()).unwrap();
    println!("ulog-rs 0.0.4");
    let parse = || ULog::parse(&log()[..]).unwrap();
    let ulog = parse();
    let report = format!("{:?}", ulog.get_subscription_messages("esc_status").unwrap());
    println!("esc_status: {report}");
    assert!(report.contains("Int32(8000)") && !report.contains("Int32(9000)") && report.ends_with("[UInt8(0)]]"));
    let first = |_| match parse().get_subscription_messages("sensor_gyro").unwrap()[1][0] {
        ULogValue::Float(x) => (10.0 * x).round() as i32,
        _ => unreachable!(),
    };
    let tenths: BTreeSet<i32> = (0..40).map(first).collect();
    println!("x of sensor_gyro in 40 parses of the same bytes, tenths: {tenths:?}");
    assert!(tenths == BTreeSet::from([1, 11]));
    let gyro = ulog.get_subscription_messages("sensor_gyro").unwrap();
    let (rate, duration) = (ulog.message_frequency("sensor_gyro"), ulog.duration_seconds());
    println!("its messages: {} lists of {}; rate {rate:?}, duration of the log {duration} s", gyro.len(), gyro[0].len());
    assert!(gyro.len() == 4 && gyro[0].len() == 201 && rate.is_none() && duration == 0.0);
}
EOF
cd "$dir"
CARGO_TARGET_DIR="$dir/target" cargo run -q --manifest-path "$dir/Cargo.toml" | tee "$dir/out"
venv/bin/python - <<'EOF'
from importlib.metadata import version
from pyulog import ULog

log = ULog('log.ulg')
topics = {(topic.name, topic.multi_id): topic.data for topic in log.data_list}
motors = [int(topics['esc_status', 0][key][0]) for key in ('esc[0].esc_rpm', 'esc[1].esc_rpm', 'esc_count')]
gyros = [round(float(topics['sensor_gyro', instance]['x'][0]), 6) for instance in (0, 1)]
seconds = (log.last_timestamp - log.start_timestamp) / 1e6
print('pyulog', version('pyulog'), 'reads motors and number', motors, 'gyros', gyros, 'duration', seconds, 's')
assert motors == [8000, 9000, 2] and gyros == [0.1, 1.1] and seconds == 2
EOF
