//! The core's cascade under the core's supervisor, as a product of the core has it: the inputs of a step in, motor forces
//! out.

use nalgebra::{Vector3, Vector4};
use quatrack::cascade::Cascade;
use quatrack::mixer::MotorLimited;
use quatrack::supervisor::{Asked, Circumstances, Config, Guard, Mode, MonitorConfig, Order, ReferenceReport, Sample};
use quatrack::{
    Controller, FifthOrderSample, FlatSample, Heading, Limits, Measured, Memory, MotorForces, Reference, Target, Tick,
};

use super::signals::{Signals, UnderTest};

/// The cascade of the core under its supervisor.
pub(super) struct UnderGuard<'a> {
    cascade: &'a Cascade,
    guard: Guard,
    memory: Memory,
    limited: MotorLimited,
    /// The last step was flown on a bridged state.
    bridged: bool,
}

impl<'a> UnderGuard<'a> {
    /// In flight as soon as there is a state.
    pub(super) fn armed(cascade: &'a Cascade) -> Self {
        let mut guard = Guard::new();
        guard.arm(0);
        let memory = Memory::hovering(cascade.airframe());
        Self { cascade, guard, memory, limited: MotorLimited::NOTHING, bridged: false }
    }

    fn forces_n(&mut self, now: Tick, signals: &Signals<'_>) -> Option<MotorForces> {
        const CONFIGS: (&Config, &MonitorConfig) = (&Config::STANDARD, &MonitorConfig::STANDARD);
        let [heading_rad, heading_rate_rad_s] = signals.heading;
        let flat = signals.asked.map(|[position_m, velocity_m_s, acceleration_m_s2]| FlatSample {
            position_m,
            velocity_m_s,
            acceleration_m_s2,
            jerk_m_s3: Vector3::zeros(),
            heading_rad,
            heading_rate_rad_s,
        });
        let reference = match &flat {
            None => ReferenceReport::Missing,
            Some(flat) if Reference::from_flat(flat).is_ok() => ReferenceReport::Sound,
            Some(_) => ReferenceReport::Bad,
        };
        let mass_kg = self.cascade.airframe().figures().mass_kg;
        let sample = Sample {
            now,
            state: signals.state.as_ref(),
            body_rates_rad_s: Some(&signals.body_rates),
            specific_force_m_s2: signals.felt.as_ref(),
            thrust_m_s2: self.memory.forces_n().iter().sum::<f32>() / mass_kg,
        };
        let around = Circumstances {
            link_silence_ticks: Some(signals.silence),
            asked: Asked::Places,
            reference,
            limited: self.limited,
            levels: true,
            starts_near: true,
            battery_v: Some(signals.battery_v),
            overrun: signals.overrun,
            fault: None,
        };
        let (looked, target, heading) = match self.guard.order(CONFIGS, &sample, &around) {
            Order::Off => {
                self.memory.run_down(0.9);
                return None;
            }
            Order::Fly(looked) => (looked, &FifthOrderSample::of_jerk(flat?), Heading::from_angle(heading_rad)),
            Order::Brake(looked, target, heading) => (looked, target, heading),
            Order::Level(levelled) => {
                let (forces, limited) = self.memory.level(self.cascade, &levelled)?;
                self.limited = limited;
                return Some(forces);
            }
        };
        self.bridged = looked.soundness != quatrack::supervisor::Soundness::Sound;
        let measured = Measured::new(looked.state).with_body_rates(looked.body_rates_rad_s);
        let measured = match &signals.felt {
            Some(felt) => measured.with_specific_force(felt),
            None => measured,
        };
        let controller = Controller::new(self.cascade, Limits::NONE);
        match controller.step_to_motors(&mut self.memory, measured, Target::with_sample(target, heading)) {
            Ok(step) => {
                self.limited = step.limited;
                Some(step.forces_n)
            }
            Err(_) => {
                let levelled = self.guard.step_failed(now, CONFIGS.1.tick_s, &around)?;
                self.memory.level(self.cascade, &levelled).map(|(forces, _)| forces)
            }
        }
    }
}

impl UnderTest for UnderGuard<'_> {
    fn step(&mut self, now: Tick, signals: &Signals<'_>) -> Option<Vector4<f64>> {
        self.forces_n(now, signals).map(|forces| Vector4::from(forces.map(f64::from)))
    }

    fn mode(&self) -> Mode {
        self.guard.mode()
    }

    fn is_bridging(&self) -> bool {
        self.bridged
    }
}
