#!/usr/bin/env bash
# Guess: set_bandwidth(2000) of the driver makes the BMI088's gyro give 2000 samples per second and anything below it
# 1000; set_range takes the range that is meant or refuses it.
# Observed: the two are the other way round. Asked for 2000 it writes 2, which is 1000 Hz and a filter of 116 Hz
# by the data sheet (register 0x10), and asked for 1000, which setup does by itself, it writes 1: 2000 Hz and 230 Hz.
# Any range below 2000 degrees/s, 125 too, becomes 1000 without a word, and the readings are raw integers.
# Why it matters: a rate loop that reads at 2 kHz gets each sample twice, with twice the delay of the filter that it
# was designed for; one that asked for 125 degrees/s has readings eight times too small.
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
bmi088 = "=0.2.1"
embedded-hal = "=1.0.0"
EOF
cat > "$dir/src/main.rs" <<'EOF'
use embedded_hal::delay::DelayNs;
use embedded_hal::spi::{ErrorType, Operation, SpiDevice};

struct NoDelay;

impl DelayNs for NoDelay {
    fn delay_ns(&mut self, _: u32) {}
}

/// Registers of the gyro, as the data sheet has them: 0x00 is its identity.
struct Bus<'a>(&'a std::cell::RefCell<[u8; 256]>);

impl ErrorType for Bus<'_> {
    type Error = core::convert::Infallible;
}

impl SpiDevice<u8> for Bus<'_> {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Self::Error> {
        for operation in operations {
            if let Operation::TransferInPlace(bytes) = operation {
                let register = (bytes[0] & 0x7F) as usize;
                let reads = bytes[0] & 0x80 != 0;
                for (k, byte) in bytes[1..].iter_mut().enumerate() {
                    if reads {
                        *byte = self.0.borrow()[register + k];
                    } else {
                        self.0.borrow_mut()[register + k] = *byte;
                    }
                }
            }
        }
        Ok(())
    }
}

fn main() {
    println!("bmi088 0.2.1");
    let registers = std::cell::RefCell::new([0u8; 256]);
    registers.borrow_mut()[0] = 0x0F;
    let mut gyro = bmi088::Builder::new_gyro_spi(Bus(&registers));
    gyro.setup(&mut NoDelay).ok().unwrap();
    let after_setup = registers.borrow()[0x10];
    let mut written = [(2000u32, 0u8), (1000, 0)];
    for (rate, value) in &mut written {
        gyro.set_bandwidth(*rate).ok().unwrap();
        *value = registers.borrow()[0x10];
    }
    println!("register 0x10 (1 is 2000 Hz, 2 is 1000 Hz): {after_setup} after setup; asked for, written: {written:?}");
    assert!(after_setup == 1 && written == [(2000, 2), (1000, 1)]);
    let mut ranges = [(2000u32, 0u8), (1000, 0), (250, 0), (125, 0)];
    for (range, value) in &mut ranges {
        gyro.set_range(*range).ok().unwrap();
        *value = registers.borrow()[0x0F];
    }
    println!("register 0x0F (0 is 2000 degrees/s, 1 is 1000, 3 is 250, 4 is 125): asked for, written: {ranges:?}");
    assert!(ranges == [(2000, 0), (1000, 1), (250, 1), (125, 1)]);
}
EOF
CARGO_TARGET_DIR="$dir/target" cargo run -q --manifest-path "$dir/Cargo.toml" | tee "$dir/out"
