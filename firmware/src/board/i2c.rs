//! The sensors' bus: I2C3 in, transactions of `embedded-hal` at 400 kHz out. Every wait is bounded, so that a bus that
//! hangs costs a fraction of a millisecond and an error, never a step; that is why it is not a HAL's, which waits for ever.
//!
//! Sequences of the reference manual RM0090, section 27.3.3: the last three bytes of a read are taken while the clock is
//! stretched, so that an interrupt in between does no harm.

use embedded_hal::i2c::{ErrorKind, ErrorType, I2c, NoAcknowledgeSource, Operation};
use stm32f4::stm32f405::i2c1::sr1;
use stm32f4::stm32f405::{I2C3, RCC};

/// Looks at a flag before it is given up: at 168 MHz some 0.2 ms, in which eight bytes pass.
const LOOKS: u32 = 2000;

/// The started bus.
#[derive(Debug)]
pub struct Bus {
    i2c: I2C3,
    clock_hz: u32,
}

/// Why a transaction failed. The peripheral has been reset since.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BusError {
    /// The hardware found it.
    Hardware(ErrorKind),
    /// A flag did not come in time: a line is held, or there is no such peripheral.
    Timeout,
    /// A read that something follows in the same transaction, which no device of this board needs.
    NotSupported,
}

impl embedded_hal::i2c::Error for BusError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Hardware(kind) => *kind,
            Self::Timeout | Self::NotSupported => ErrorKind::Other,
        }
    }
}

impl ErrorType for Bus {
    type Error = BusError;
}

impl Bus {
    /// Starts the peripheral on the clock of APB1. Its pins are its own already.
    pub(super) fn start(i2c: I2C3, rcc: &RCC, clock_hz: u32) -> Self {
        rcc.apb1enr().modify(|_, w| w.i2c3en().enabled());
        let bus = Self { i2c, clock_hz };
        bus.reset();
        bus
    }

    /// Lets both lines go and sets everything anew.
    #[allow(unsafe_code, reason = "the register's description does not know which numbers these fields may hold")]
    fn reset(&self) {
        let i2c = &self.i2c;
        i2c.cr1().write(|w| w.swrst().reset());
        i2c.cr1().reset();
        let clock_mhz = self.clock_hz / 1_000_000;
        // SAFETY: the frequency is 2 to 50 MHz; the divider at least 1, low for two parts of three, rounded up.
        i2c.cr2().write(|w| unsafe { w.freq().bits(clock_mhz as u8) });
        i2c.ccr()
            .write(|w| unsafe { w.f_s().fast().duty().duty2_1().ccr().bits(self.clock_hz.div_ceil(1_200_000) as u16) });
        // 300 ns, and one.
        i2c.trise().write(|w| w.trise().set((clock_mhz * 3 / 10 + 1) as u8));
        i2c.cr1().write(|w| w.pe().enabled());
    }

    fn wait(&self, is_ready: impl Fn(&sr1::R) -> bool) -> Result<(), BusError> {
        for _ in 0..LOOKS {
            let status = self.i2c.sr1().read();
            let fault = if status.af().bit_is_set() {
                ErrorKind::NoAcknowledge(NoAcknowledgeSource::Unknown)
            } else if status.arlo().bit_is_set() {
                ErrorKind::ArbitrationLoss
            } else if status.berr().bit_is_set() {
                ErrorKind::Bus
            } else if status.ovr().bit_is_set() {
                ErrorKind::Overrun
            } else if is_ready(&status) {
                return Ok(());
            } else {
                continue;
            };
            return Err(BusError::Hardware(fault));
        }
        Err(BusError::Timeout)
    }

    fn carry(&self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), BusError> {
        if !(0..LOOKS).any(|_| self.i2c.sr2().read().busy().bit_is_clear()) {
            return Err(BusError::Timeout);
        }
        let writes = operations.iter().take_while(|operation| matches!(operation, Operation::Write(_))).count();
        let Some((writes, reads)) = operations.split_at_mut_checked(writes) else { return Err(BusError::NotSupported) };
        if reads.iter().any(|operation| matches!(operation, Operation::Write(_))) {
            return Err(BusError::NotSupported);
        }
        if !writes.is_empty() || reads.is_empty() {
            self.write(address, writes)?;
        }
        let length =
            reads.iter().map(|operation| if let Operation::Read(bytes) = operation { bytes.len() } else { 0 }).sum();
        if length == 0 {
            self.stop();
            return Ok(());
        }
        self.read(address, length, reads)
    }

    /// Start or repeated start, and the address with its direction.
    fn address(&self, byte: u8) -> Result<(), BusError> {
        self.i2c.cr1().modify(|_, w| w.start().start());
        self.wait(|status| status.sb().bit_is_set())?;
        self.i2c.dr().write(|w| w.dr().set(byte));
        self.wait(|status| status.addr().bit_is_set())
    }

    /// Both status registers read: the address is done with, and the clock runs on.
    fn go_on(&self) {
        self.i2c.sr1().read();
        self.i2c.sr2().read();
    }

    fn stop(&self) {
        self.i2c.cr1().modify(|_, w| w.stop().stop());
    }

    fn refuse_next(&self) {
        self.i2c.cr1().modify(|_, w| w.ack().nak());
    }

    /// Ends with the last byte on the line and the clock held, for a stop or a repeated start.
    fn write(&self, address: u8, operations: &[Operation<'_>]) -> Result<(), BusError> {
        self.address(address << 1)?;
        self.go_on();
        let mut any = false;
        for operation in operations {
            let Operation::Write(bytes) = operation else { continue };
            for byte in *bytes {
                self.wait(|status| status.tx_e().bit_is_set())?;
                self.i2c.dr().write(|w| w.dr().set(*byte));
                any = true;
            }
        }
        if any { self.wait(|status| status.btf().bit_is_set()) } else { Ok(()) }
    }

    /// Reads `length` bytes, at least one, and stops.
    fn read(&self, address: u8, length: usize, operations: &mut [Operation<'_>]) -> Result<(), BusError> {
        // Of two bytes the second is refused, which is to be said before the first has come.
        self.i2c.cr1().modify(|_, w| w.ack().bit(length > 1).pos().bit(length == 2));
        self.address(address << 1 | 1)?;
        self.go_on();
        match length {
            1 => self.stop(),
            2 => self.refuse_next(),
            _ => {}
        }
        let mut left = length;
        for operation in operations {
            let Operation::Read(bytes) = operation else { continue };
            for byte in bytes.iter_mut() {
                // Three are left, one of them in the data register and one behind it: the next is to be refused.
                if left == 3 {
                    self.wait(|status| status.btf().bit_is_set())?;
                    self.refuse_next();
                }
                // The last two lie in both places.
                if left == 2 {
                    self.wait(|status| status.btf().bit_is_set())?;
                    self.stop();
                }
                self.wait(|status| status.rx_ne().bit_is_set())?;
                *byte = self.i2c.dr().read().dr().bits();
                left -= 1;
            }
        }
        Ok(())
    }
}

impl I2c for Bus {
    /// Writes, then reads; in this order only.
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), BusError> {
        let carried = self.carry(address, operations);
        if carried.is_err() {
            self.reset();
        }
        carried
    }
}
