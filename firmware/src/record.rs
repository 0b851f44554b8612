//! The fault that outlives a restart: a fault in, before the processor is reset; the same fault out, after.

use core::mem::MaybeUninit;
use core::ptr;

use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use quatrack::Tick;
use quatrack::link::FaultReport;
use quatrack::supervisor::Fault;

/// Marks a record that was written on purpose; RAM holds other bytes after power-up.
const MAGIC: u32 = 0x5174_4661;

/// A record: [`MAGIC`], the program counter, and the exclusive or of both.
type Record = [u32; 3];

#[allow(unsafe_code, reason = "names a section that start-up leaves alone")]
#[unsafe(link_section = ".uninit.fault_record")]
static mut RECORD: MaybeUninit<Record> = MaybeUninit::uninit();

/// The fault that made the processor restart, if one did. It is forgotten only when the power goes.
#[allow(unsafe_code, reason = "reads a variable that only the hard fault's handler writes")]
pub fn read() -> Option<FaultReport> {
    // SAFETY: any bits are numbers, and nothing else runs when this is called at start-up.
    let [magic, address, check] = unsafe { ptr::read_volatile((&raw const RECORD).cast::<Record>()) };
    const TICK: Tick = 0;
    (magic == MAGIC && check == magic ^ address).then_some(FaultReport { fault: Fault::HardFault, tick: TICK, address })
}

/// Stops everything: the reset takes the motors' timers with it, and the image starts disarmed and faulted.
#[allow(unsafe_code, reason = "an exception handler; writes the record, which nothing else can be using")]
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    let address = frame.pc();
    // SAFETY: nothing preempts this handler and it does not return.
    unsafe { ptr::write_volatile((&raw mut RECORD).cast::<Record>(), [MAGIC, address, MAGIC ^ address]) };
    SCB::sys_reset()
}
