//! The gyroscope of Bosch's BMI088 on I2C: registers in, body rates in rad/s out, in the axes of the chip.
//!
//! Numbers in brackets are sections of the data sheet, BST-BMI088-DS001, revision 1.3. On a Crazyflie 2.1 the chip's axes
//! are those of the body: x to the nose, y to the left, z up. The accelerometer, a device of its own on the same bus, is
//! left alone: attitude comes with the state.

use core::f32::consts::PI;
use core::fmt;

use embedded_hal::delay::DelayNs;
use embedded_hal::i2c::I2c;

/// Registers (5.5).
mod register {
    pub(super) const CHIP_ID: u8 = 0x00;
    pub(super) const RATE_X_LSB: u8 = 0x02;
    pub(super) const INT_STAT_1: u8 = 0x0A;
    pub(super) const RANGE: u8 = 0x0F;
    pub(super) const BANDWIDTH: u8 = 0x10;
    pub(super) const SOFTRESET: u8 = 0x14;
    pub(super) const INT_CTRL: u8 = 0x15;
    pub(super) const INT3_INT4_IO_CONF: u8 = 0x16;
    pub(super) const INT3_INT4_IO_MAP: u8 = 0x18;
}

/// Value of the register chip-id (5.5.1).
const CHIP_ID: u8 = 0x0F;
/// Resets when written to its register (5.5.7), which takes 30 ms.
const SOFTRESET: u8 = 0xB6;
const RESET_MS: u32 = 30;
/// Data ready makes an interrupt (5.5.8), on pin INT3 (5.5.10), push-pull and high (5.5.9; INT4 keeps its open drain).
const NEW_DATA: u8 = 0x80;
const NEW_DATA_TO_INT3: u8 = 0x01;
const INT3_PUSH_PULL_HIGH: u8 = 0x0D;
/// Of the register for the bandwidth: the upper bits read as they like.
const BANDWIDTH_MASK: u8 = 0x0F;

/// Its address on the bus, by the level that its pin SDO2 is tied to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Address {
    /// To ground; on a Crazyflie.
    Low = 0x68,
    /// To the supply.
    High = 0x69,
}

/// The largest rate (5.5.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// 2000 degrees a second, 34.9 rad/s; 1.07 mrad/s a bit.
    Degrees2000 = 0,
    /// 1000 degrees a second, 17.5 rad/s.
    Degrees1000 = 1,
    /// 500 degrees a second, 8.7 rad/s.
    Degrees500 = 2,
    /// 250 degrees a second, 4.4 rad/s.
    Degrees250 = 3,
    /// 125 degrees a second, 2.2 rad/s.
    Degrees125 = 4,
}

/// Width of the filter, and how often there is new data (5.5.5).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bandwidth {
    /// 532 Hz, new data at 2 kHz.
    Hz532 = 0,
    /// 230 Hz, new data at 2 kHz.
    Hz230 = 1,
    /// 116 Hz, new data at 1 kHz.
    Hz116 = 2,
    /// 47 Hz, new data at 400 Hz.
    Hz47 = 3,
    /// 23 Hz, new data at 200 Hz.
    Hz23 = 4,
    /// 12 Hz, new data at 100 Hz.
    Hz12 = 5,
    /// 64 Hz, new data at 200 Hz.
    Hz64 = 6,
    /// 32 Hz, new data at 100 Hz.
    Hz32 = 7,
}

/// A setting that is read back once it is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setting {
    /// [`Range`].
    Range,
    /// [`Bandwidth`].
    Bandwidth,
}

/// Why there are no rates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GyroError<E> {
    /// The bus did not carry it.
    Bus(E),
    /// Another chip answers at the address.
    ChipId {
        /// Its chip-id, not 0x0F.
        found: u8,
    },
    /// The chip did not take a setting.
    Setting {
        /// The setting.
        setting: Setting,
        /// The value written.
        written: u8,
        /// The value read back.
        found: u8,
    },
}

/// A gyroscope that runs as it was set.
#[derive(Debug)]
pub struct Gyro<I> {
    bus: I,
    address: u8,
    rad_s_per_bit: f32,
}

impl Range {
    /// Rate of the least bit, rad/s: the range over 2^15.
    pub const fn rad_s_per_bit(self) -> f32 {
        let degrees_s: f32 = match self {
            Self::Degrees2000 => 2000.0,
            Self::Degrees1000 => 1000.0,
            Self::Degrees500 => 500.0,
            Self::Degrees250 => 250.0,
            Self::Degrees125 => 125.0,
        };
        degrees_s / 32_768.0 * (PI / 180.0)
    }
}

impl<I: I2c> Gyro<I> {
    /// Resets the chip, looks whether it is one, sets it, and has pin INT3 go high on new data. Takes a little over 30 ms.
    ///
    /// # Errors
    /// [`GyroError`].
    pub fn start(
        mut bus: I,
        address: Address,
        range: Range,
        bandwidth: Bandwidth,
        delay: &mut impl DelayNs,
    ) -> Result<Self, GyroError<I::Error>> {
        let address = address as u8;
        let mut found = [0];
        bus.write_read(address, &[register::CHIP_ID], &mut found).map_err(GyroError::Bus)?;
        let [found] = found;
        if found != CHIP_ID {
            return Err(GyroError::ChipId { found });
        }
        bus.write(address, &[register::SOFTRESET, SOFTRESET]).map_err(GyroError::Bus)?;
        delay.delay_ms(RESET_MS);
        let mut gyro = Self { bus, address, rad_s_per_bit: range.rad_s_per_bit() };
        gyro.set(register::RANGE, range as u8, u8::MAX, Setting::Range)?;
        gyro.set(register::BANDWIDTH, bandwidth as u8, BANDWIDTH_MASK, Setting::Bandwidth)?;
        gyro.write(register::INT3_INT4_IO_CONF, INT3_PUSH_PULL_HIGH)?;
        gyro.write(register::INT3_INT4_IO_MAP, NEW_DATA_TO_INT3)?;
        gyro.write(register::INT_CTRL, NEW_DATA)?;
        Ok(gyro)
    }

    /// Whether data came within the last 280 to 400 us, after which the chip takes the word back (5.5.3).
    ///
    /// # Errors
    /// [`GyroError::Bus`].
    pub fn has_new_data(&mut self) -> Result<bool, GyroError<I::Error>> {
        let [status] = self.read(register::INT_STAT_1)?;
        Ok(status & NEW_DATA != 0)
    }

    /// The newest rates about x, y, z, rad/s, by one burst (5.5.2): the chip holds the two bytes of a number together. One
    /// beyond the range reads as its end.
    ///
    /// # Errors
    /// [`GyroError::Bus`].
    #[inline]
    pub fn body_rates_rad_s(&mut self) -> Result<[f32; 3], GyroError<I::Error>> {
        let [x0, x1, y0, y1, z0, z1] = self.read(register::RATE_X_LSB)?;
        let bits = [[x0, x1], [y0, y1], [z0, z1]].map(i16::from_le_bytes);
        Ok(bits.map(|bits| f32::from(bits) * self.rad_s_per_bit))
    }

    /// Gives the bus back.
    pub fn release(self) -> I {
        self.bus
    }

    fn set(&mut self, register: u8, written: u8, mask: u8, setting: Setting) -> Result<(), GyroError<I::Error>> {
        self.write(register, written)?;
        let [found] = self.read(register)?;
        if found & mask == written { Ok(()) } else { Err(GyroError::Setting { setting, written, found }) }
    }

    fn write(&mut self, register: u8, value: u8) -> Result<(), GyroError<I::Error>> {
        self.bus.write(self.address, &[register, value]).map_err(GyroError::Bus)
    }

    #[inline]
    fn read<const N: usize>(&mut self, register: u8) -> Result<[u8; N], GyroError<I::Error>> {
        let mut bytes = [0; N];
        self.bus.write_read(self.address, &[register], &mut bytes).map_err(GyroError::Bus)?;
        Ok(bytes)
    }
}

impl<E> GyroError<E> {
    /// In a word, for a log.
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Bus(_) => "nothing answers on the bus",
            Self::ChipId { .. } => "another chip answers",
            Self::Setting { .. } => "a setting does not stick",
        }
    }
}

impl<E: fmt::Debug> fmt::Display for GyroError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bus(error) => write!(f, "gyroscope: the bus failed ({error:?}); check its lines"),
            Self::ChipId { found } => {
                write!(f, "gyroscope: chip id {found:#04x}, not {CHIP_ID:#04x}; check its address")
            }
            Self::Setting { setting, written, found } => {
                write!(f, "gyroscope: {setting:?} set to {written:#04x} reads {found:#04x}; switch it off and on")
            }
        }
    }
}

impl<E: fmt::Debug> core::error::Error for GyroError<E> {}
