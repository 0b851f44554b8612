#!/usr/bin/env bash
# Guess: an offset, a crosstalk or a period that the driver of the range sensor sets reads back unchanged from the
# same register.
# Observed: an offset of -10 mm is written rightly and read as 2038 mm: the sign of the register's 13 bits is not
# extended. A crosstalk of 127 counts/s is set as 126, and one of 500 as 115: the value is shifted out of its 16 bits
# before it is divided. A pause of 50 ms between two measurements is kept; one of 100 ms, of which the sensor's clock
# makes 92800 in 16 bits, becomes 29 ms in a release build, where the wrap is silent.
# Why it matters: an offset that is read, corrected and written back puts the ground two metres away from a height
# hold, and a rate that was lowered to save power triples.
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
vl53l1x-uld = "=2.0.1"
embedded-hal = "=0.2.7"
EOF
cat > "$dir/src/main.rs" <<'EOF'
use embedded_hal::blocking::i2c::{Write, WriteRead};
use std::{cell::RefCell, convert::Infallible};
use vl53l1x_uld::VL53L1X;

/// The sensor's registers, of 16-bit addresses.
struct Bus<'a>(&'a RefCell<[u8; 65536]>);

fn register(bytes: &[u8]) -> usize {
    u16::from_be_bytes([bytes[0], bytes[1]]) as usize
}

impl Write for Bus<'_> {
    type Error = Infallible;
    fn write(&mut self, _: u8, bytes: &[u8]) -> Result<(), Infallible> {
        bytes[2..].iter().enumerate().for_each(|(k, byte)| self.0.borrow_mut()[register(bytes) + k] = *byte);
        Ok(())
    }
}

impl WriteRead for Bus<'_> {
    type Error = Infallible;
    fn write_read(&mut self, _: u8, from: &[u8], to: &mut [u8]) -> Result<(), Infallible> {
        to.iter_mut().enumerate().for_each(|(k, byte)| *byte = self.0.borrow()[register(from) + k]);
        Ok(())
    }
}

fn main() {
    println!("vl53l1x-uld 2.0.1");
    let registers = RefCell::new([0u8; 65536]);
    registers.borrow_mut()[0x00DE..0x00E0].copy_from_slice(&928u16.to_be_bytes()); // the calibration of its clock
    let mut sensor = VL53L1X::new(Bus(&registers), 0x29);
    let offsets = [10, -10].map(|asked| {
        sensor.set_offset(asked).unwrap();
        (asked, sensor.get_offset().unwrap())
    });
    let crosstalks = [100, 127, 500].map(|asked| {
        sensor.set_cross_talk(asked).unwrap();
        (asked, sensor.get_cross_talk().unwrap())
    });
    let periods = [20, 50, 100, 1000].map(|asked| {
        sensor.set_inter_measurement_period_ms(asked).unwrap();
        (asked, sensor.get_inter_measurement_period_ms().unwrap())
    });
    println!("set and read back: offsets {offsets:?} mm, crosstalks {crosstalks:?} counts/s, periods {periods:?} ms");
    assert!(offsets == [(10, 10), (-10, 2038)]);
    assert!(crosstalks[0].1 >= 99 && crosstalks[1].1 >= 126 && crosstalks[2].1 < 120);
    assert!(periods[1].1 == 50 && periods[2].1 < 35);
}
EOF
CARGO_TARGET_DIR="$dir/target" cargo run -q --release --manifest-path "$dir/Cargo.toml" | tee "$dir/out"
