//! Counts the instructions of the Crazyflie controller's object, linked as it is shipped: recorded calls in, from a file
//! of the host; counts and the controller's outputs, to another.
//!
//! Both files are in the folder in which the emulator runs, all numbers little-endian. `calls.bin`: for each flight the
//! platform (four floats), the table's number, the motors' lag (float) and the number of calls; then, for each call, the
//! step, an action before it (bit 0: the controller is selected; from bit 8 on: the number of a table that is asked for,
//! plus one), setpoint, sensors and state as they lie in memory. `counts.bin`: the cost of reading the counter, counts of
//! two loops of known length; then, for each call, its count and the control; at the end the most stack that a call took,
//! bytes.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image {
    use cortex_m_rt::entry;
    use quatrack_firmware::counter::Counter;
    use quatrack_firmware::semihosting::{File, Mode, exit};
    use quatrack_firmware::stack;
    use stm32f4::stm32f405::Peripherals;

    const SETPOINT_BYTES: usize = 128;
    const SENSORS_BYTES: usize = 56;
    const STATE_BYTES: usize = 80;
    const CONTROL_BYTES: usize = 20;

    /// Where the object's variables have the motors' lag and the number of the table.
    const MOTOR_LAG_AT: usize = 28;
    const TABLE_AT: usize = 60;

    /// Rounds of a loop of two instructions: the costs differ by 2000.
    const LOOPS: [u32; 2] = [100, 1100];

    #[repr(C, align(8))]
    struct Bytes<const N: usize>([u8; N]);

    #[allow(unsafe_code, reason = "the object's symbols, as its header has them")]
    mod object {
        use super::{Bytes, CONTROL_BYTES, SENSORS_BYTES, SETPOINT_BYTES, STATE_BYTES};

        unsafe extern "C" {
            pub(super) safe fn controllerOutOfTree(
                control: &mut Bytes<CONTROL_BYTES>,
                setpoint: &Bytes<SETPOINT_BYTES>,
                sensors: &Bytes<SENSORS_BYTES>,
                state: &Bytes<STATE_BYTES>,
                step: u32,
            );
            pub(super) safe fn controllerOutOfTreeInit();
            pub(super) safe fn quatrackService();
            pub(super) safe fn quatrackPlatform(platform: &[f32; 4]) -> bool;
            pub(super) static mut quatrack: [u8; 224];
        }

        /// Sets a parameter, as the firmware's parameter task does.
        pub(super) fn set(at: usize, bytes: &[u8]) {
            for (index, byte) in bytes.iter().enumerate() {
                // SAFETY: within the parameters, and nobody else is running.
                unsafe { (&raw mut quatrack).cast::<u8>().add(at + index).write_volatile(*byte) };
            }
        }
    }

    #[entry]
    fn main() -> ! {
        exit(run().is_some())
    }

    fn run() -> Option<()> {
        let peripherals = Peripherals::take()?;
        let counter = Counter::start(peripherals.TIM5, &peripherals.RCC);
        let mut calls = File::open(c"calls.bin", Mode::Read)?;
        let mut counts = File::open(c"counts.bin", Mode::Write)?;
        let start = counter.now();
        let overhead = counter.now().wrapping_sub(start);
        let loops = LOOPS.map(|rounds| {
            let start = counter.now();
            spin(rounds);
            counter.now().wrapping_sub(start).wrapping_sub(overhead)
        });
        for word in [overhead, loops[0], loops[1]] {
            counts.write(&word.to_le_bytes()).then_some(())?;
        }
        let mut stack_bytes = 0;
        while let Some([mass, arm, thrust, torque, table, lag, number]) = read_words::<7>(&mut calls) {
            object::set(MOTOR_LAG_AT, &lag.to_le_bytes());
            object::set(TABLE_AT, &table.to_le_bytes()[..1]);
            object::quatrackPlatform(&[mass, arm, thrust, torque].map(f32::from_bits)).then_some(())?;
            object::quatrackService();
            let mut control = Bytes([0; CONTROL_BYTES]);
            for _ in 0..number {
                let [step, before] = read_words::<2>(&mut calls)?;
                if before & 1 != 0 {
                    object::controllerOutOfTreeInit();
                }
                if let Some(table) = (before >> 8).checked_sub(1) {
                    object::set(TABLE_AT, &table.to_le_bytes()[..1]);
                    object::quatrackService();
                }
                let setpoint = read::<SETPOINT_BYTES>(&mut calls)?;
                let sensors = read::<SENSORS_BYTES>(&mut calls)?;
                let state = read::<STATE_BYTES>(&mut calls)?;
                // Three has no factor in common with the setpoints' ten steps: every kind of call is looked at.
                let is_looked_at = step.is_multiple_of(3);
                if is_looked_at {
                    stack::paint_below();
                }
                let start = counter.now();
                object::controllerOutOfTree(&mut control, &setpoint, &sensors, &state, step);
                let count = counter.now().wrapping_sub(start).wrapping_sub(overhead);
                if is_looked_at {
                    stack_bytes = stack_bytes.max(stack::used_below());
                }
                (counts.write(&count.to_le_bytes()) && counts.write(&control.0)).then_some(())?;
            }
        }
        counts.write(&stack_bytes.to_le_bytes()).then_some(())
    }

    /// Out of line, so that both loops are the same one, with the same padding before it.
    #[inline(never)]
    fn spin(rounds: u32) {
        cortex_m::asm::delay(rounds);
    }

    fn read<const N: usize>(file: &mut File) -> Option<Bytes<N>> {
        let mut bytes = Bytes([0; N]);
        (file.read(&mut bytes.0) == N).then_some(bytes)
    }

    fn read_words<const N: usize>(file: &mut File) -> Option<[u32; N]> {
        let mut bytes = [[0_u8; 4]; N];
        let flat = bytes.as_flattened_mut();
        let whole = flat.len();
        (file.read(flat) == whole).then(|| bytes.map(u32::from_le_bytes))
    }
}

/// On a desk there is nothing to run: `quatrack crazyflie --count` builds the image and starts it.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is an image for an emulated STM32F405; run it with `quatrack crazyflie --count`");
}
