//! Around the controller: which craft, parameters and sent tables in; log variables and the gains in use out.

use core::sync::atomic::Ordering::Relaxed;

use quatrack::FeedForward;
use quatrack::gains::table::AcceptedTable;
use quatrack::nalgebra::Vector3;

use crate::abi;
use crate::control::{Controller, Mode, Output, Settings};
use crate::craft::{Craft, DECIMATION};
use crate::guide::Bounds;
use crate::shared::{AtomicF32, Shared};
use crate::tables::{Refusal, Scales, Table};

/// The controller of the firmware's stabilizer task, once it knows its craft.
pub struct Service {
    controller: Option<Controller>,
    uploaded: Option<AcceptedTable>,
    uploads: u8,
    asked: Asked,
}

/// What the owner last asked to be flown.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Asked {
    table: u8,
    scales: Scales,
    motor_lag_s: f32,
    /// Which of the sent tables, counted.
    upload: u8,
}

impl Asked {
    /// The craft's own table as it is, until the parameters are looked at.
    const NOTHING: Self = Self { table: 0, scales: Scales::ONE, motor_lag_s: 0.0, upload: 0 };

    fn of(shared: &Shared, upload: u8) -> Self {
        let parameters = &shared.parameters;
        Self {
            table: parameters.table.load(Relaxed),
            scales: Scales { position: parameters.position_scale.get(), yaw: parameters.yaw_scale.get() },
            motor_lag_s: parameters.motor_lag_s.get(),
            upload,
        }
    }
}

impl Service {
    /// Without a craft: motors off.
    pub const fn new() -> Self {
        Self { controller: None, uploaded: None, uploads: 0, asked: Asked::NOTHING }
    }

    /// Starts for a craft, as if switched on.
    pub fn start(&mut self, craft: &Craft, shared: &Shared) {
        *self = Self::new();
        if let Ok(table) = Table::actuator_aware(craft) {
            show_table(shared, &table);
            self.controller = Some(Controller::new(*craft, table, settings(shared)));
        }
    }

    /// The next control step starts afresh: another controller has been flying.
    pub fn restart(&mut self) {
        if let Some(controller) = &mut self.controller {
            controller.forget();
        }
    }

    /// Takes a table that has been sent; it is flown once the parameter asks for the uploaded one.
    pub fn upload(&mut self, table: &AcceptedTable) {
        self.uploaded = Some(*table);
        self.uploads = self.uploads.wrapping_add(1);
    }

    /// One of the firmware's steps.
    #[inline]
    pub fn step(
        &mut self,
        shared: &Shared,
        setpoint: &abi::Setpoint,
        sensors: &abi::SensorData,
        state: &abi::State,
        step: u32,
    ) -> Option<abi::Control> {
        let Some(controller) = &mut self.controller else {
            shared.log.mode.store(Mode::NoCraft as u8, Relaxed);
            return Some(abi::Control { payload: [0.0; 4], control_mode: abi::Control::FORCE });
        };
        if step % DECIMATION == 0 {
            return controller.step(setpoint, sensors, state, step);
        }
        self.keep_house(shared);
        None
    }

    /// What need not be done in the control step itself.
    #[inline(never)]
    fn keep_house(&mut self, shared: &Shared) {
        let Some(controller) = &mut self.controller else { return };
        controller.set(&settings(shared));
        let asked = Asked::of(shared, self.uploads);
        if asked != self.asked {
            self.asked = asked;
            change_table(controller, shared, &asked, self.uploaded.as_ref());
        }
        show(shared, controller);
    }
}

/// Flies what has been asked for, or says why not and flies on.
#[cold]
#[inline(never)]
fn change_table(controller: &mut Controller, shared: &Shared, asked: &Asked, uploaded: Option<&AcceptedTable>) {
    let craft = controller.craft();
    match Table::choose(asked.table, craft, uploaded).map(|table| table.scaled(&asked.scales)) {
        Ok(table) if table != *controller.table() => {
            controller.change_table(&table);
            show_table(shared, &table);
        }
        Ok(_) => {}
        Err(refusal) => refuse(shared, refusal),
    }
}

/// Says that a table is not flown.
pub fn refuse(shared: &Shared, refusal: Refusal) {
    shared.log.refused_tables.fetch_add(1, Relaxed);
    shared.log.refusal.store(refusal as u16, Relaxed);
}

/// The parameters, each within what makes sense; what is not a number counts as the least.
fn settings(shared: &Shared) -> Settings {
    let parameters = &shared.parameters;
    let within = |value: &AtomicF32, least: f32, most: f32| {
        let value = value.get();
        if value >= most {
            most
        } else if value >= least {
            value
        } else {
            least
        }
    };
    Settings {
        bounds: Bounds {
            leash_m: within(&parameters.leash_m, 0.1, 10.0),
            speed_m_s: within(&parameters.speed_m_s, 0.1, 5.0),
            acceleration_m_s2: within(&parameters.acceleration_m_s2, 0.5, 10.0),
        },
        body_rates_rad_s: [
            within(&parameters.roll_pitch_rate_rad_s, 0.5, 100.0),
            within(&parameters.yaw_rate_rad_s, 0.5, 100.0),
        ],
        motor_lag_s: within(&parameters.motor_lag_s, 0.0, 1.0),
        feed_forward: if parameters.feed_forward.load(Relaxed) == 0 { FeedForward::Without } else { FeedForward::With },
    }
}

/// What the last control step did, into the log.
fn show(shared: &Shared, controller: &Controller) {
    let log = &shared.log;
    let thousandths = |v: Vector3<f32>| [(v.x * 1e3) as i16, (v.y * 1e3) as i16, (v.z * 1e3) as i16];
    // A conversion from a float cuts to the range, and takes NaN for 0.
    log.error_mm.iter().zip(thousandths(controller.error_m())).for_each(|(to, value)| to.store(value, Relaxed));
    let rotation = thousandths(controller.rotation_error_rad());
    log.rotation_mrad.iter().zip(rotation).for_each(|(to, value)| to.store(value, Relaxed));
    let scale = 1e3 / controller.craft().airframe.figures().force_max_n;
    let forces = match controller.output() {
        Output::Forces(forces) => *forces,
        Output::Wrench(_) => [0.0; 4],
    };
    log.forces.iter().zip(forces).for_each(|(to, force)| to.store((force * scale) as u16, Relaxed));
    log.limited.store(controller.limited().bits(), Relaxed);
    log.mode.store(controller.mode() as u8, Relaxed);
    let counters = controller.counters();
    log.bad_states.store(counters.bad_states, Relaxed);
    log.bad_setpoints.store(counters.bad_setpoints, Relaxed);
    log.limited_steps.store(counters.limited_steps, Relaxed);
    log.jumps.store(counters.jumps, Relaxed);
}

/// The table in use, its margin and its gain.
fn show_table(shared: &Shared, table: &Table) {
    shared.log.table.store(table.id as u8, Relaxed);
    shared.gains.scale_min.set(1.0 / table.margin);
    shared.gains.scale_max.set(table.margin);
    let shown = table.gains.shown();
    shared.gains.entries.iter().zip(shown).for_each(|(to, entry)| to.set(entry));
}
