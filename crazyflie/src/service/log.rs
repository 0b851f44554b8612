//! From the controller into the log, in the stabilizer's task, between control steps.

use core::sync::atomic::Ordering::Relaxed;

use quatrack::nalgebra::Vector3;

use crate::abi;
use crate::control::Controller;
use crate::output::Output;
use crate::shared::Shared;
use crate::units;

/// How far the last control step was off, into the log.
#[inline(never)]
pub fn log_errors(shared: &Shared, controller: &Controller, state: &abi::State) {
    let log = &shared.log;
    // A conversion from a float cuts to the range, and takes NaN for 0.
    let thousandths = |v: &Vector3<f32>| [(v.x * 1e3) as i16, (v.y * 1e3) as i16, (v.z * 1e3) as i16];
    let outcome = controller.outcome();
    log.error_mm.iter().zip(thousandths(&outcome.error_m)).for_each(|(to, value)| to.store(value, Relaxed));
    let rotation = thousandths(&controller.rotation_error_rad(units::state(state).attitude));
    log.rotation_mrad.iter().zip(rotation).for_each(|(to, value)| to.store(value, Relaxed));
}

/// Its outputs, limits and counts into the log.
#[inline(never)]
pub fn log_counters(shared: &Shared, controller: &Controller) {
    let (log, outcome) = (&shared.log, controller.outcome());
    let scale = 1e3 / controller.craft().airframe().figures().force_max_n;
    let forces = match &outcome.output {
        Output::Forces(forces) => *forces,
        Output::Wrench(_) => [0.0; 4],
    };
    log.forces.iter().zip(forces).for_each(|(to, force)| to.store((force * scale) as u16, Relaxed));
    log.limited.store(outcome.limited.bits(), Relaxed);
    log.mode.store(controller.mode() as u8, Relaxed);
    let counters = controller.counters();
    log.reason.store(controller.why() as u16, Relaxed);
    log.bad_states.store(counters.bad_states, Relaxed);
    log.bad_setpoints.store(counters.bad_setpoints, Relaxed);
    log.limited_steps.store(counters.limited_steps, Relaxed);
    log.jumps.store(counters.jumps, Relaxed);
}

/// The figures that the cascade has learned into the log.
#[inline(never)]
pub fn log_learned(shared: &Shared, controller: &Controller) {
    let Some((drag_per_s, moment_n_s, memory)) = controller.learned() else { return };
    let learned = &shared.learned;
    learned.drag_per_s.set(drag_per_s);
    learned.moment_n_s.iter().zip(moment_n_s).for_each(|(to, moment)| to.set(moment));
    learned.motor_share.set(memory.motor_share());
    let v = memory.disturbance_m_s2();
    learned.disturbance_m_s2.iter().zip([v.x, v.y, v.z]).for_each(|(to, part)| to.set(part));
    learned.stands.set(if memory.stands() { 1.0 } else { 0.0 });
}
