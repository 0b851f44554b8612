#!/usr/bin/env bash
# Guess: set_filter(Filter::c3) of the driver sets the barometer's filter to the coefficient 3, and power_control()
# says whether the sensor sleeps.
# Observed: the filter's three bits are 1 to 3 of the register 0x1F (data sheet), and the driver writes them to 0
# to 2: c1 is no filter, c3 is 1, c127 is 7. It reads them back from where it wrote them, and so repeats the request.
# power_control() takes the bits that enable the two sensors for the mode: of a sensor that sleeps with both enabled
# it says Normal.
# Why it matters: pressure noise of a height hold is judged with a filter that is two steps weaker than it is called,
# and a check that the sensor was woken passes on one that sleeps and repeats its last value.
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
bmp388 = "=0.1.0"
embedded-hal = "=0.2.7"
EOF
cat > "$dir/src/main.rs" <<'EOF'
use bmp388::{Filter, PowerControl, PowerMode, BMP388};
use embedded_hal::blocking::i2c::WriteRead;
use std::{cell::RefCell, convert::Infallible};

/// The sensor's registers; 0x00 is its identity.
struct Bus<'a>(&'a RefCell<[u8; 256]>);

impl WriteRead for Bus<'_> {
    type Error = Infallible;
    fn write_read(&mut self, _: u8, from: &[u8], to: &mut [u8]) -> Result<(), Infallible> {
        let register = from[0] as usize;
        from[1..].iter().enumerate().for_each(|(k, byte)| self.0.borrow_mut()[register + k] = *byte); // the driver writes so too
        to.iter_mut().enumerate().for_each(|(k, byte)| *byte = self.0.borrow()[register + k]);
        Ok(())
    }
}

fn main() {
    println!("bmp388 0.1.0");
    let registers = RefCell::new([0u8; 256]);
    registers.borrow_mut()[0] = 0x50;
    let mut sensor = BMP388::new(Bus(&registers)).unwrap();
    let coefficients = [0, 1, 3, 7, 15, 31, 63, 127];
    let mut set = Vec::new();
    for (asked, filter) in [(1, Filter::c1), (3, Filter::c3), (127, Filter::c127)] {
        sensor.set_filter(filter).unwrap();
        let register = registers.borrow()[0x1F];
        set.push((asked, coefficients[(register >> 1 & 7) as usize]));
        println!("filter {asked}: register 0x1F is {register:#05b}, whose bits 1 to 3 mean {}; read back as {:?}", set.last().unwrap().1, sensor.filter().unwrap());
    }
    assert!(set == [(1, 0), (3, 1), (127, 7)]);
    sensor.set_power_control(PowerControl { pressure_enable: true, temperature_enable: true, mode: PowerMode::Sleep }).unwrap();
    let register = registers.borrow()[0x1B];
    let said = format!("{:?}", sensor.power_control().unwrap().mode);
    println!("put to sleep: register 0x1B is {register:#08b}, whose bits 4 and 5 mean sleep; mode read as {said}");
    assert!(register == 0b11 && said == "Normal");
}
EOF
CARGO_TARGET_DIR="$dir/target" cargo run -q --manifest-path "$dir/Cargo.toml" | tee "$dir/out"
