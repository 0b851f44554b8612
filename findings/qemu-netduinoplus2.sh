#!/usr/bin/env bash
# Guess: QEMU's netduinoplus2 is an STM32F405 as its manual describes it, so that firmware for that chip runs on it or
# is told why not.
# Observed: the 64 kB of core-coupled memory at 0x10000000 are not there: a write faults. The cycle counter says
# that it exists (DWT_CTRL's NOCYCCNT is 0) and counts nothing when it is enabled. The clock control takes the request
# for the external oscillator and the PLL and never reports them ready. SYST_CALIB claims 10 ms for a clock of 21 MHz,
# where the processor runs at 168.
# Why it matters: a start-up that waits for a ready flag hangs, a table moved into the fast memory crashes before
# main, and a step time measured by the cycle counter is 0, which passes every limit.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
apt-get download -q qemu-system-arm=1:7.2+dfsg-7+deb12u18+b3 > /dev/null 2>&1  # its libraries are those of the installed package
dpkg -x qemu-system-arm_*.deb root
cat > link.x <<'EOF'
MEMORY { FLASH : ORIGIN = 0x08000000, LENGTH = 1M RAM : ORIGIN = 0x20000000, LENGTH = 128K }
ENTRY(reset)
SECTIONS { .vectors : { KEEP(*(.vectors)) } > FLASH .text : { *(.text*) *(.rodata*) } > FLASH /DISCARD/ : { *(.ARM.*) } }
EOF
cat > main.rs <<'EOF'
#![no_std]
#![no_main]
use core::{arch::asm, ptr};

fn host(operation: usize, argument: usize) {
    unsafe { asm!("bkpt 0xab", inout("r0") operation => _, in("r1") argument) }
}

fn say(name: &str, value: u32) {
    for byte in name.bytes() {
        host(3, &byte as *const u8 as usize);
    }
    for place in (0..8).rev() {
        let digit = (value >> (4 * place)) & 15;
        let byte = if digit < 10 { b'0' + digit as u8 } else { b'a' + digit as u8 - 10 };
        host(3, &byte as *const u8 as usize);
    }
    host(3, &b'\n' as *const u8 as usize);
}

fn read(address: usize) -> u32 {
    unsafe { ptr::read_volatile(address as *const u32) }
}

fn write(address: usize, value: u32) {
    unsafe { ptr::write_volatile(address as *mut u32, value) }
}

extern "C" fn fault() -> ! {
    say("core-coupled memory: a write faults, BFAR/MMFAR ", read(0xE000_ED38));
    host(0x18, 0x20026);
    loop {}
}

#[no_mangle]
pub extern "C" fn reset() -> ! {
    write(0xE000_EDFC, read(0xE000_EDFC) | 1 << 24); // DEMCR.TRCENA
    say("DWT_CTRL ", read(0xE000_1000));
    write(0xE000_1000, read(0xE000_1000) | 1);
    let before = read(0xE000_1004);
    for _ in 0..10_000 {
        unsafe { asm!("nop") }
    }
    say("cycles counted over ten thousand rounds ", read(0xE000_1004).wrapping_sub(before));
    write(0x4002_3800, 1 << 16 | 1 << 24); // RCC_CR: HSEON, PLLON
    for _ in 0..1_000_000 {
        unsafe { asm!("nop") }
    }
    say("RCC_CR ready flags ", read(0x4002_3800) & (1 << 17 | 1 << 25));
    say("SYST_CALIB ", read(0xE000_E01C));
    write(0x1000_0000, 0x1234_5678);
    say("core-coupled memory holds ", read(0x1000_0000));
    host(0x18, 0x20026);
    loop {}
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}

#[repr(C)]
pub struct Vectors(usize, extern "C" fn() -> !, extern "C" fn() -> !, extern "C" fn() -> !);
#[link_section = ".vectors"]
#[used]
static VECTORS: Vectors = Vectors(0x2002_0000, reset, fault, fault);
EOF
rustc --edition 2021 --target thumbv7em-none-eabihf -C opt-level=2 -C link-arg=-Tlink.x -o image main.rs
root/usr/bin/qemu-system-arm --version | head -1
timeout 20 root/usr/bin/qemu-system-arm -M netduinoplus2 -nographic -semihosting-config enable=on,target=native -kernel image \
  2> out < /dev/null > out.stdout || true
cat out out.stdout | grep -v '^$' | tee lines
grep -Eq '^DWT_CTRL [0-9a-f]{8}$' lines
ctrl=$((16#$(grep '^DWT_CTRL' lines | cut -d' ' -f2)))
((ctrl >> 25 & 1)) && { echo 'DWT says that it has no cycle counter now'; exit 1; }
grep -q 'rounds 00000000' lines
grep -q 'flags 00000000' lines
calib=$((16#$(grep '^SYST_CALIB' lines | cut -d' ' -f2) & 0xffffff))
echo "ticks in 10 ms: $calib"
((calib == 209999 || calib == 210000))
grep -q 'a write faults' lines
