#!/usr/bin/env bash
# Guess: set_field_range(Range8Gauss) of the magnetometer's driver sets the range to 8 gauss and leaves the data rate.
# Observed: the range is bits 4 and 5 of the control register 0x09 (data sheet), the rate bits 2 and 3. The driver
# sets bit 3: the range stays at 2 gauss, and a rate of 10 Hz becomes 100. Range2Gauss, which is a sensor's own after
# a reset, clears that bit: 200 Hz becomes 50, and 100 Hz 10. Set after the range, the rate undoes it.
# Why it matters: read with 3000 counts per gauss for the 12000 of its range, a field is four times too large. A
# rate of 10 Hz under a filter that was tuned for 100 is a heading that lags a turn by a step.
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
qmc5883l = "=0.0.1"
embedded-hal = "=0.2.7"
EOF
cat > "$dir/src/main.rs" <<'EOF'
use embedded_hal::blocking::i2c::{Write, WriteRead};
use qmc5883l::{FieldRange, OutputDataRate, QMC5883L};
use std::{cell::RefCell, convert::Infallible};

/// The sensor's registers; 0x0D is its identity.
struct Bus<'a>(&'a RefCell<[u8; 16]>);

impl Write for Bus<'_> {
    type Error = Infallible;
    fn write(&mut self, _: u8, bytes: &[u8]) -> Result<(), Infallible> {
        self.0.borrow_mut()[bytes[0] as usize] = bytes[1];
        Ok(())
    }
}

impl WriteRead for Bus<'_> {
    type Error = Infallible;
    fn write_read(&mut self, _: u8, from: &[u8], to: &mut [u8]) -> Result<(), Infallible> {
        to.iter_mut().enumerate().for_each(|(k, byte)| *byte = self.0.borrow()[from[0] as usize + k]);
        Ok(())
    }
}

fn main() {
    println!("qmc5883l 0.0.1");
    let registers = RefCell::new([0u8; 16]);
    registers.borrow_mut()[0x0D] = 0xFF;
    let mut sensor = QMC5883L::new(Bus(&registers)).unwrap();
    let read = |what: &str| {
        let control = registers.borrow()[0x09];
        let (gauss, hertz) = ([2, 8, 0, 0][(control >> 4 & 3) as usize], [10, 50, 100, 200][(control >> 2 & 3) as usize]);
        println!("{what}: register 0x09 is {control:#010b}: {gauss} gauss, {hertz} Hz");
        (gauss, hertz)
    };
    let mut ask = |rate, range, what: &str| {
        sensor.set_output_data_rate(rate).unwrap();
        sensor.set_field_range(range).unwrap();
        read(what)
    };
    assert!(ask(OutputDataRate::Rate10Hz, FieldRange::Range8Gauss, "10 Hz, then 8 gauss") == (2, 100));
    assert!(ask(OutputDataRate::Rate200Hz, FieldRange::Range2Gauss, "200 Hz, then 2 gauss") == (2, 50));
    assert!(ask(OutputDataRate::Rate100Hz, FieldRange::Range2Gauss, "100 Hz, then 2 gauss") == (2, 10));
    sensor.set_field_range(FieldRange::Range8Gauss).unwrap();
    sensor.set_output_data_rate(OutputDataRate::Rate50Hz).unwrap();
    assert!(read("8 gauss, then 50 Hz") == (2, 50));
}
EOF
CARGO_TARGET_DIR="$dir/target" cargo run -q --manifest-path "$dir/Cargo.toml" | tee "$dir/out"
