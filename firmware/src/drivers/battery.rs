//! The battery: a reading in, a voltage that motors may be driven by out.

use core::fmt;

/// Voltage of the one LiPo cell that feeds the motors, V; checked by [`CellVoltage::new`].
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct CellVoltage(f32);

/// A reading that is no working cell's: a broken line or converter, or a cell that is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellVoltageError {
    /// The reading, V.
    pub voltage_v: f32,
}

impl CellVoltage {
    /// A cell half empty; taken where there is no reading.
    pub const NOMINAL: Self = Self(3.7);
    /// A cell just charged.
    pub const FULL: Self = Self(4.2);

    /// A damaged cell lies below, where the Crazyflie's own firmware stops its motors too.
    const MIN_V: f32 = 2.0;
    /// No charger brings a cell above.
    const MAX_V: f32 = 4.5;

    /// Checks a reading.
    ///
    /// # Errors
    /// [`CellVoltageError`] outside 2.0 to 4.5 V and for a NaN.
    pub const fn new(voltage_v: f32) -> Result<Self, CellVoltageError> {
        if voltage_v >= Self::MIN_V && voltage_v <= Self::MAX_V {
            Ok(Self(voltage_v))
        } else {
            Err(CellVoltageError { voltage_v })
        }
    }

    /// The voltage, V.
    #[inline]
    pub const fn volts(self) -> f32 {
        self.0
    }
}

impl fmt::Display for CellVoltageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (min, max) = (CellVoltage::MIN_V, CellVoltage::MAX_V);
        write!(f, "battery: {} V; a cell has {min} to {max} V, check its reading", self.voltage_v)
    }
}

impl core::error::Error for CellVoltageError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reading_that_is_no_cells_is_refused() {
        for voltage_v in [0.0, 1.999, 4.501, -3.7, f32::INFINITY] {
            assert_eq!(CellVoltage::new(voltage_v), Err(CellVoltageError { voltage_v }));
        }
        assert!(CellVoltage::new(f32::NAN).is_err());
        for sound in [CellVoltage::NOMINAL, CellVoltage::FULL] {
            assert_eq!(CellVoltage::new(sound.volts()), Ok(sound));
        }
    }
}
