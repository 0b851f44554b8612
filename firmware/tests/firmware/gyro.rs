//! The gyroscope's driver on a bus that plays the chip: the registers written, their order, and the readings or errors
//! made of the answers.

use embedded_hal::i2c::ErrorKind;
use embedded_hal_mock::eh1::delay::{CheckedDelay, Transaction as Wait};
use embedded_hal_mock::eh1::i2c::{Mock, Transaction};
use quatrack_firmware::drivers::bmi088::{Address, Bandwidth, Gyro, GyroError, Range, Setting};

const CHIP: u8 = 0x68;

/// The data sheet's start for 2000 degrees a second and 116 Hz, with new data on INT3.
fn start() -> Vec<Transaction> {
    vec![
        Transaction::write_read(CHIP, vec![0x00], vec![0x0F]),
        Transaction::write(CHIP, vec![0x14, 0xB6]),
        Transaction::write(CHIP, vec![0x0F, 0x00]),
        Transaction::write_read(CHIP, vec![0x0F], vec![0x00]),
        Transaction::write(CHIP, vec![0x10, 0x02]),
        // The upper bit reads as 1 (reset value 0x80).
        Transaction::write_read(CHIP, vec![0x10], vec![0x82]),
        Transaction::write(CHIP, vec![0x16, 0x0D]),
        Transaction::write(CHIP, vec![0x18, 0x01]),
        Transaction::write(CHIP, vec![0x15, 0x80]),
    ]
}

fn begin(bus: &Mock) -> Result<Gyro<Mock>, GyroError<ErrorKind>> {
    let mut delay = CheckedDelay::new(&[Wait::delay_ms(30)]);
    let gyro = Gyro::start(bus.clone(), Address::Low, Range::Degrees2000, Bandwidth::Hz116, &mut delay);
    delay.done();
    gyro
}

/// A gyroscope that has started and then meets some transactions.
fn running(after: &[Transaction]) -> (Gyro<Mock>, Mock) {
    let bus = Mock::new(&[start(), after.to_vec()].concat());
    (begin(&bus).expect("the chip answers as it should"), bus)
}

fn burst(bytes: [u8; 6]) -> Transaction {
    Transaction::write_read(CHIP, vec![0x02], bytes.to_vec())
}

#[test]
fn a_burst_is_signed_and_little_endian_and_in_rad_s() {
    // 16384 bits are half the range; -1 is the least bit; the end of the range.
    let (mut gyro, mut bus) = running(&[burst([0x00, 0x40, 0xFF, 0xFF, 0x00, 0x80])]);
    let [x, y, z] = gyro.body_rates_rad_s().expect("the bus answers").map(f64::from);
    let range = 2000_f64.to_radians();
    // Two roundings of f32 each.
    for (found, exact) in [(x, 0.5 * range), (y, -range / 32_768.0), (z, -range)] {
        assert!((found / exact - 1.0).abs() < 2e-7, "{found} rad/s for {exact} rad/s");
    }
    bus.done();
}

#[test]
fn every_range_has_the_data_sheets_resolution() {
    // Table 3 of the data sheet, bits for a degree a second.
    let sheet = [
        (Range::Degrees2000, 16.384),
        (Range::Degrees1000, 32.768),
        (Range::Degrees500, 65.536),
        (Range::Degrees250, 131.072),
        (Range::Degrees125, 262.144),
    ];
    for (range, bits) in sheet {
        let degrees_s = f64::from(range.rad_s_per_bit()).to_degrees();
        assert!((degrees_s * bits - 1.0).abs() < 2e-7, "{range:?}");
    }
}

#[test]
fn new_data_is_the_upper_bit() {
    let status = |bits| Transaction::write_read(CHIP, vec![0x0A], vec![bits]);
    let (mut gyro, mut bus) = running(&[status(0x7F), status(0x80)]);
    assert_eq!((gyro.has_new_data(), gyro.has_new_data()), (Ok(false), Ok(true)));
    bus.done();
}

#[test]
fn another_chip_is_not_written_to() {
    // The accelerometer's id.
    let mut bus = Mock::new(&[Transaction::write_read(CHIP, vec![0x00], vec![0x1E])]);
    let mut delay = CheckedDelay::new(&[]);
    let found = Gyro::start(bus.clone(), Address::Low, Range::Degrees2000, Bandwidth::Hz116, &mut delay);
    assert_eq!(found.err(), Some(GyroError::ChipId { found: 0x1E }));
    delay.done();
    bus.done();
}

#[test]
fn a_setting_that_does_not_stick_is_named() {
    let mut expected = start()[..5].to_vec();
    expected.push(Transaction::write_read(CHIP, vec![0x10], vec![0x80]));
    let mut bus = Mock::new(&expected);
    let refused = GyroError::Setting { setting: Setting::Bandwidth, written: 0x02, found: 0x80 };
    assert_eq!(begin(&bus).err(), Some(refused));
    assert!(refused.to_string().contains("Bandwidth set to 0x02 reads 0x80"), "{refused}");
    bus.done();
}

#[test]
fn a_bus_that_fails_gives_no_rates() {
    let failing = burst([0; 6]).with_error(ErrorKind::ArbitrationLoss);
    let (mut gyro, mut bus) = running(&[failing, burst([0; 6])]);
    assert_eq!(gyro.body_rates_rad_s(), Err(GyroError::Bus(ErrorKind::ArbitrationLoss)));
    assert_eq!(gyro.body_rates_rad_s(), Ok([0.0; 3]), "and may answer again");
    bus.done();
}
