//! The core in an RTIC application of one's own: a control task of 500 Hz beside the board's other tasks.
//!
//! `cargo build --package quatrack-firmware --example rtic_task --target thumbv7em-none-eabihf --profile firmware`
//!
//! The estimate comes from a task that is not shown here; the step's forces go to motors that are not shown either. The
//! panic handler is that of this package: the image links only if nothing in it can panic.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
use quatrack_firmware as _;

#[cfg(target_os = "none")]
#[rtic::app(device = stm32f4::stm32f405, peripherals = true, dispatchers = [CAN2_SCE])]
mod app {
    use cortex_m::peripheral::syst::SystClkSource;
    use quatrack::gains::paper;
    use quatrack::nalgebra::Vector3;
    use quatrack::{
        Actuation, Airframe, Controller, Equilibrium, Limits, Measured, Memory, Rate, Reference, RigidState,
    };
    use quatrack::{MotorForces, State, Target};

    /// After a reset the processor runs from its own oscillator of 16 MHz.
    const CORE_HZ: u32 = 16_000_000;
    const CONTROL_HZ: u32 = 500;

    const AIRFRAME: Airframe = Airframe::CRAZYFLIE_2_1;
    const RATE: Rate = match Rate::from_hz(CONTROL_HZ) {
        Some(rate) => rate,
        None => panic!("the core does not step at this rate"),
    };
    static ACTUATION: Actuation = match Actuation::new(&AIRFRAME, RATE) {
        Ok(actuation) => actuation,
        Err(_) => panic!("the motors are too fast for this rate"),
    };

    #[shared]
    struct Shared {
        estimate: RigidState,
        forces_n: MotorForces,
    }

    #[local]
    struct Local {
        controller: Controller<'static>,
        memory: Memory,
        goal: Option<Reference>,
    }

    #[init]
    fn init(mut context: init::Context) -> (Shared, Local) {
        context.core.SYST.set_clock_source(SystClkSource::Core);
        context.core.SYST.set_reload(CORE_HZ / CONTROL_HZ - 1);
        context.core.SYST.enable_counter();
        context.core.SYST.enable_interrupt();
        let (origin, zero) = (Vector3::new(0.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 0.0));
        let estimate = RigidState { state: State::at_rest(origin), body_rates_rad_s: zero };
        let limits = Limits::of(&AIRFRAME, Vector3::new(20.0, 20.0, 10.0));
        let controller = Controller::new(Equilibrium::new(&paper::LYAP_E), limits).with_actuation(&ACTUATION);
        let goal = Reference::hover(Vector3::new(0.0, 0.0, 1.0), 0.0).ok();
        let (shared, memory) = (Shared { estimate, forces_n: [0.0; 4] }, Memory::at_rest());
        (shared, Local { controller, memory, goal })
    }

    #[task(binds = SysTick, priority = 2, local = [controller, memory, goal], shared = [estimate, forces_n])]
    fn control(mut context: control::Context) {
        let estimate = context.shared.estimate.lock(|estimate| *estimate);
        let (controller, memory) = (context.local.controller, context.local.memory);
        let step = context
            .local
            .goal
            .as_ref()
            .and_then(|goal| controller.step_to_motors(memory, Measured::from(&estimate), Target::new(goal)).ok());
        // No answer, no force: the last one is never held.
        let forces_n = step.map_or([0.0; 4], |step| step.forces_n);
        context.shared.forces_n.lock(|driven| *driven = forces_n);
    }
}

/// On a desk there is nothing to run.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is an image for an STM32F405; build it for thumbv7em-none-eabihf");
}
