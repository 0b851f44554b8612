//! Counts the instructions of the estimator: inertial samples and positions in, from a file of the host; counts and a
//! hash of the estimate out, to another.
//!
//! Both files are in the folder in which the emulator runs, all numbers little-endian, 32 bits. `samples.bin`: for each
//! step, nine floats: mean body rates (rad/s), mean specific force (m/s^2), position (m). `counts.bin`: the cost of
//! reading the counter, counts of two loops of known length; then, for each filter (with drag, all axes of the
//! accelerometer, as the Crazyflie's, in this order) and each step, counts of the prediction over 10 ms and of the
//! update with a position (1 mm), and a hash of state and covariance; at the end the most stack of a prediction and of
//! an update, bytes.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;

    use cortex_m_rt::entry;
    use quatrack::State;
    use quatrack::estimator::{Estimate, Estimator, EstimatorConfig, Force, Imu, Integration};
    use quatrack::nalgebra::Vector3;
    use quatrack_firmware::counter::Counter;
    use quatrack_firmware::semihosting::{File, Mode, exit};
    use quatrack_firmware::stack;
    use stm32f4::stm32f405::Peripherals;

    /// Rounds of a loop of two instructions: the costs differ by 2000.
    const LOOPS: [u32; 2] = [100, 1100];

    const WITH_DRAG: EstimatorConfig = EstimatorConfig {
        integration: Integration::SecondOrder,
        drag_per_s: [0.447, 0.435],
        deviation_min: 1e-5,
        ..EstimatorConfig::CRAZYFLIE
    };

    const CONFIGS: [EstimatorConfig; 3] =
        [WITH_DRAG, EstimatorConfig { force: Force::AllAxes, ..WITH_DRAG }, EstimatorConfig::CRAZYFLIE];

    #[entry]
    fn main() -> ! {
        exit(run().is_some())
    }

    fn run() -> Option<()> {
        let peripherals = Peripherals::take()?;
        let counter = Counter::start(peripherals.TIM5, &peripherals.RCC);
        let mut counts = File::open(c"counts.bin", Mode::Write)?;
        let start = counter.now();
        let overhead = counter.now().wrapping_sub(start);
        let loops = LOOPS.map(|rounds| {
            let start = counter.now();
            spin(rounds);
            counter.now().wrapping_sub(start).wrapping_sub(overhead)
        });
        write(&mut counts, [overhead, loops[0], loops[1]])?;
        let mut stack_bytes = [0; 2];
        for config in CONFIGS {
            let estimator = black_box(Estimator::new(config).ok()?);
            let mut samples = File::open(c"samples.bin", Mode::Read)?;
            let mut estimate = None;
            while let Some([p, q, r, fx, fy, fz, x, y, z]) = read(&mut samples) {
                let imu = black_box(Imu {
                    body_rates_rad_s: Vector3::new(p, q, r),
                    specific_force_m_s2: Vector3::new(fx, fy, fz),
                });
                let position = black_box(Vector3::new(x, y, z));
                let now = match &mut estimate {
                    Some(now) => now,
                    none => none.insert(estimator.start(&State::at_rest(position)).ok()?),
                };
                let [of_prediction, stack] = counted(counter, overhead, || predict(&estimator, now, &imu))?;
                stack_bytes[0] = stack.max(stack_bytes[0]);
                let [of_update, stack] = counted(counter, overhead, || update(&estimator, now, &position))?;
                stack_bytes[1] = stack.max(stack_bytes[1]);
                write(&mut counts, [of_prediction, of_update, hash(now)])?;
            }
        }
        write(&mut counts, stack_bytes)
    }

    /// Instructions and stack of a step, bytes; nothing where it failed.
    fn counted(counter: Counter, overhead: u32, step: impl FnOnce() -> bool) -> Option<[u32; 2]> {
        stack::paint_below();
        let start = counter.now();
        let is_done = step();
        let count = counter.now().wrapping_sub(start).wrapping_sub(overhead);
        let stack_bytes = stack::used_below();
        is_done.then_some([count, stack_bytes])
    }

    #[inline(never)]
    fn predict(estimator: &Estimator, estimate: &mut Estimate, imu: &Imu) -> bool {
        estimator.predict(estimate, imu, black_box(0.01)).is_ok()
    }

    #[inline(never)]
    fn update(estimator: &Estimator, estimate: &mut Estimate, position: &Vector3<f32>) -> bool {
        black_box(estimator.update_position(estimate, position, black_box(1e-3))).is_ok()
    }

    /// FNV-1a over words: state, then the covariance's rows.
    fn hash(estimate: &Estimate) -> u32 {
        let (state, rows) = (estimate.state(), estimate.covariance().to_rows());
        let (r, q, v) = (&state.position_m, &state.attitude, &state.velocity_m_s);
        let words = [r.x, r.y, r.z, q.w, q.x, q.y, q.z, v.x, v.y, v.z];
        let all = words.iter().chain(rows.as_flattened());
        all.fold(0x811c_9dc5_u32, |hash, word| (hash ^ word.to_bits()).wrapping_mul(0x0100_0193))
    }

    /// Out of line, so that both loops are the same one, with the same padding before it.
    #[inline(never)]
    fn spin(rounds: u32) {
        cortex_m::asm::delay(rounds);
    }

    fn read(file: &mut File) -> Option<[f32; 9]> {
        let mut bytes = [[0_u8; 4]; 9];
        let flat = bytes.as_flattened_mut();
        let whole = flat.len();
        (file.read(flat) == whole).then(|| bytes.map(f32::from_le_bytes))
    }

    fn write<const N: usize>(file: &mut File, words: [u32; N]) -> Option<()> {
        file.write(words.map(u32::to_le_bytes).as_flattened()).then_some(())
    }
}

/// On a desk there is nothing to run: `quatrack measure` builds the image and starts it.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is an image for an emulated STM32F405; run it with `quatrack measure`");
}
