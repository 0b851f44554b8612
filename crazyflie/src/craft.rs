//! The crafts that there are tables for: the figures that the firmware was built with in, the craft out.

use quatrack::gains::cascade as tables;
use quatrack::gains::table::{BuiltInCascade, Vehicle};
use quatrack::{Actuation, Air, Airframe, AirframeFigures, BodyRateLoop, Rate};

/// Control steps a second: every other one of the firmware's.
pub const CONTROL_HZ: u32 = 500;

/// The firmware's steps between two control steps.
pub const DECIMATION: u32 = 2;

/// The period of the control steps, s.
pub const PERIOD_S: f32 = 1.0 / CONTROL_HZ as f32;

/// The rate of the control steps.
pub const RATE: Rate = match Rate::from_hz(CONTROL_HZ) {
    Some(rate) => rate,
    None => panic!("the control rate is no rate"),
};

/// The firmware's figures of the craft: `platform_defaults.h`, passed by the app.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Platform {
    /// `CF_MASS`, kg.
    pub mass_kg: f32,
    /// `ARM_LENGTH`, centre to rotor, m.
    pub arm_m: f32,
    /// `THRUST_MAX` of one motor, N.
    pub thrust_max_n: f32,
    /// `THRUST2TORQUE`, m.
    pub torque_per_thrust_m: f32,
}

/// A craft, with the figures that the steps need.
#[derive(Clone, Copy, Debug)]
pub struct Craft {
    /// Its way to the motors, with the lag that is published.
    pub actuation: Actuation,
    /// Its name and id for a gain table.
    pub vehicle: Vehicle,
    /// Which of [`KNOWN`] it is; [`OWN`] for none of them.
    pub index: usize,
    /// Time constant of its motors as far as it is known, s.
    pub motor_lag_s: f32,
    /// The same where its owner has stated it, s.
    pub stated_lag_s: Option<f32>,
    /// One over the largest force of a motor, 1/N.
    pub per_force_max_1_n: f32,
    /// Largest thrust of all motors over the mass, m/s^2.
    pub thrust_max_m_s2: f32,
    /// The air that it is told where its owner says nothing.
    pub air: Air,
}

/// A craft that the controller knows.
#[derive(Clone, Copy, Debug)]
pub struct Known {
    /// Its figures.
    pub airframe: Airframe,
    /// Its name and id.
    pub vehicle: Vehicle,
    /// The air that it is told where its owner says nothing.
    pub air: Air,
}

/// The crafts that the controller knows.
pub const KNOWN: [Known; 3] = [
    known(tables::CRAZYFLIE_2_1_DEFAULT, Airframe::CRAZYFLIE_2_1),
    known(tables::UPGRADE_KIT_DEFAULT, Airframe::CRAZYFLIE_2_1_UPGRADE_KIT),
    known(tables::BRUSHLESS_DEFAULT, Airframe::CRAZYFLIE_2_1_BRUSHLESS),
];

const fn known(table: BuiltInCascade, airframe: Airframe) -> Known {
    Known { airframe, vehicle: table.vehicle, air: table.table.air }
}

/// The place of a craft of the owner's, behind those that are known.
pub const OWN: usize = KNOWN.len();

/// Largest relative difference of a figure from the one that the tables were made for: the rounding of the firmware's
/// figures.
const TOLERANCE: f32 = 2e-3;

/// Largest relative difference of a stated mass from the craft's own: the inertia, which goes on being the craft's own, is then
/// within the tables' certified range.
const MASS_TOLERANCE: f32 = 0.2;

/// Whether a figure that the firmware was built with is the craft's.
pub(crate) fn is_near(found: f32, known: f32) -> bool {
    is_within(found, known, TOLERANCE)
}

fn is_within(found: f32, known: f32, tolerance: f32) -> bool {
    (found - known).abs() <= tolerance * known
}

impl Craft {
    /// The craft that the firmware was built for; nothing where no table is for it.
    pub fn of(platform: &Platform) -> Option<Self> {
        let root_2 = core::f32::consts::SQRT_2;
        let (index, known) = KNOWN.iter().enumerate().find(|(_, known)| {
            let figures = known.airframe.figures();
            is_within(platform.mass_kg, figures.mass_kg, MASS_TOLERANCE)
                && is_near(platform.arm_m, figures.lever_arm_m * root_2)
                && is_near(platform.thrust_max_n, figures.force_max_n)
                && is_near(platform.torque_per_thrust_m, figures.torque_per_thrust_m)
        })?;
        // The mass as the owner has set it: the weight is fed forward.
        let figures = AirframeFigures { mass_kg: platform.mass_kg, ..*known.airframe.figures() };
        let airframe = Airframe::new(figures).ok()?;
        Self::with(airframe, known, index)
    }

    /// A known craft with an airframe of its own; nothing where its motors are faster than two control periods.
    #[inline(never)]
    pub const fn with(airframe: Airframe, known: &Known, index: usize) -> Option<Self> {
        let figures = airframe.figures();
        let Ok(actuation) = Actuation::new(&airframe, RATE) else { return None };
        Some(Self {
            actuation,
            vehicle: known.vehicle,
            index,
            motor_lag_s: figures.motor_lag_s,
            stated_lag_s: None,
            per_force_max_1_n: 1.0 / figures.force_max_n,
            thrust_max_m_s2: 4.0 * figures.force_max_n / figures.mass_kg,
            air: known.air,
        })
    }

    /// Its figures, checked.
    pub const fn airframe(&self) -> &Airframe {
        self.actuation.airframe()
    }

    /// The same whose owner knows the time constant of the motors; 0 for the longest that is published.
    pub fn with_motor_lag(&self, motor_lag_s: f32) -> Self {
        let stated_lag_s = Some(motor_lag_s).filter(|lag_s| *lag_s > 0.0);
        let motor_lag_s = stated_lag_s.unwrap_or(self.airframe().figures().motor_lag_s);
        match self.airframe().with_motor_lag(motor_lag_s) {
            Ok(airframe) => {
                let actuation = self.actuation.with_body_rates(BodyRateLoop::behind_lag(&airframe));
                Self { actuation, motor_lag_s, stated_lag_s, ..*self }
            }
            Err(_) => *self,
        }
    }
}
