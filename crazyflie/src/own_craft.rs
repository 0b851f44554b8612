//! A craft of the owner's: its figures and its table in, as `quatrack gains craft` writes them into the app's `quatrack_craft.h` or
//! into a file to be sent; the craft and its table, or the reason why it does not fly, out.

use core::ffi::CStr;

use quatrack::checksum::{Crc32c, crc32c};
use quatrack::gains::table::{CascadeTable, GainTable};
use quatrack::{Airframe, AirframeFigures};

use crate::craft::{Craft, Known, OWN, Platform, RATE, is_near};

/// Bytes of a table of the cascade.
pub const TABLE_BYTES: usize = 326;

/// Figures of a craft beside its table.
const FIGURES: usize = 15;

/// How a craft begins as a file: by its magic and the version of its form.
pub const MAGIC: [u8; 6] = *b"QTCR\x01\0";

/// Bytes of a craft as a file and over the app channel: the magic, the figures in the order of [`OwnCraft`], f32 each, the
/// table, and the CRC-32C of all that. Little-endian.
pub const CRAFT_BYTES: usize = MAGIC.len() + 4 * FIGURES + TABLE_BYTES + 4;

/// A craft with its table, in SI: `quatrackCraft_t`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnCraft {
    /// Mass ready to fly, kg.
    pub mass_kg: f32,
    /// Inertia xx, xy, xz, yy, yz, zz, kg m^2.
    pub inertia_kg_m2: [f32; 6],
    /// Centre to rotor, m.
    pub arm_m: f32,
    /// Least and most force of a motor, N.
    pub force_n: [f32; 2],
    /// Torque about the vertical over the force of a motor, m.
    pub torque_per_thrust_m: f32,
    /// Time constant of the motors from command to force, s.
    pub motor_lag_s: f32,
    /// Largest body rates that are commanded, rad/s.
    pub body_rates_rad_s: [f32; 3],
    /// The table, byte by byte.
    pub table: [u8; TABLE_BYTES],
}

/// Why a craft of the owner's does not fly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OwnCraftError {
    /// Its table is not sound, or none of the cascade for the rate of the control steps.
    Table,
    /// Its table was made for other figures.
    Figures,
    /// Its figures are those of no craft.
    NoCraft,
    /// Its motors' lag is not among those that the table is certified for.
    MotorLag,
    /// The firmware was built for another arm.
    Arm,
    /// The firmware was built for another largest force of a motor.
    ForceMax,
    /// The firmware was built for another torque per thrust.
    TorquePerThrust,
}

impl OwnCraftError {
    /// In words, with the remedy.
    pub const fn words(self) -> &'static CStr {
        match self {
            Self::Table => c"quatrack_craft.h has no sound table of the cascade at 500 Hz: make it again",
            Self::Figures => c"the table in quatrack_craft.h is for other figures: make it again",
            Self::NoCraft => c"the figures in quatrack_craft.h are those of no craft: make it again",
            Self::MotorLag => c"the craft's motor lag is outside its table's certificate: widen the design's region",
            Self::Arm => c"the firmware's ARM_LENGTH is not the craft's arm: set it with EXTRA_CFLAGS",
            Self::ForceMax => {
                c"the firmware's THRUST_MAX is not the craft's largest force of a motor: mend the vehicle file"
            }
            Self::TorquePerThrust => {
                c"the firmware's THRUST2TORQUE is not the craft's torque per thrust: mend the vehicle file"
            }
        }
    }
}

impl OwnCraft {
    /// The craft on a firmware, with its table.
    ///
    /// # Errors
    /// [`OwnCraftError`].
    pub fn on(&self, platform: &Platform) -> Result<(Craft, CascadeTable), OwnCraftError> {
        let table = GainTable::from_bytes(&self.table).map_err(|_| OwnCraftError::Table)?;
        let vehicle = table.head().vehicle;
        table.accept_for(&vehicle, RATE).map_err(|_| OwnCraftError::Table)?;
        let cascade = *table.cascade().ok_or(OwnCraftError::Table)?;
        if self.id(vehicle.name.as_str()) != vehicle.id {
            return Err(OwnCraftError::Figures);
        }
        if !cascade.certified.holds_lag(self.motor_lag_s) {
            return Err(OwnCraftError::MotorLag);
        }
        let [force_min_n, force_max_n] = self.force_n;
        for (built_for, own, error) in [
            (platform.arm_m, self.arm_m, OwnCraftError::Arm),
            (platform.thrust_max_n, force_max_n, OwnCraftError::ForceMax),
            (platform.torque_per_thrust_m, self.torque_per_thrust_m, OwnCraftError::TorquePerThrust),
        ] {
            if !is_near(built_for, own) {
                return Err(error);
            }
        }
        let [ix, _, _, iy, _, iz] = self.inertia_kg_m2;
        let airframe = Airframe::new(AirframeFigures {
            mass_kg: self.mass_kg,
            inertia_kg_m2: [ix, iy, iz],
            lever_arm_m: self.arm_m * core::f32::consts::FRAC_1_SQRT_2,
            torque_per_thrust_m: self.torque_per_thrust_m,
            force_min_n,
            force_max_n,
            motor_lag_s: self.motor_lag_s,
        })
        .map_err(|_| OwnCraftError::NoCraft)?;
        let known = Known { airframe, vehicle, air: cascade.air };
        let craft = Craft::with(airframe, &known, OWN).ok_or(OwnCraftError::NoCraft)?;
        Ok((craft, cascade))
    }

    /// The craft as a file ([`CRAFT_BYTES`]).
    pub fn to_bytes(&self) -> [u8; CRAFT_BYTES] {
        let mut bytes = [0; CRAFT_BYTES];
        let (body, checksum) = bytes.split_at_mut(CRAFT_BYTES - 4);
        let figures = self.figures();
        let parts = MAGIC.into_iter().chain(figures.into_iter().flat_map(f32::to_le_bytes)).chain(self.table);
        body.iter_mut().zip(parts).for_each(|(to, byte)| *to = byte);
        checksum.copy_from_slice(&crc32c(body).to_le_bytes());
        bytes
    }

    /// The craft of a file; nothing where it is none, or damaged.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let (body, checksum) = bytes.split_last_chunk()?;
        if crc32c(body) != u32::from_le_bytes(*checksum) {
            return None;
        }
        let (figures, table) = body.strip_prefix(&MAGIC)?.split_first_chunk::<{ 4 * FIGURES }>()?;
        let mut figures = figures.as_chunks().0.iter().map(|figure| f32::from_le_bytes(*figure));
        let mut next = || figures.next();
        Some(Self {
            mass_kg: next()?,
            inertia_kg_m2: [next()?, next()?, next()?, next()?, next()?, next()?],
            arm_m: next()?,
            force_n: [next()?, next()?],
            torque_per_thrust_m: next()?,
            motor_lag_s: next()?,
            body_rates_rad_s: [next()?, next()?, next()?],
            table: table.try_into().ok()?,
        })
    }

    /// The number by which a table names the vehicle that it is for: CRC-32C of its name and figures.
    fn id(&self, name: &str) -> u32 {
        let mut sum = Crc32c::new();
        name.bytes().chain(self.figures().into_iter().flat_map(f32::to_le_bytes)).for_each(|byte| sum.update(byte));
        sum.value()
    }

    /// All but the table, in order.
    const fn figures(&self) -> [f32; FIGURES] {
        let Self { mass_kg, inertia_kg_m2, arm_m, force_n, torque_per_thrust_m, motor_lag_s, body_rates_rad_s, .. } =
            self;
        let [xx, xy, xz, yy, yz, zz] = *inertia_kg_m2;
        let ([least, most], [p, q, r]) = (*force_n, *body_rates_rad_s);
        [*mass_kg, xx, xy, xz, yy, yz, zz, *arm_m, least, most, *torque_per_thrust_m, *motor_lag_s, p, q, r]
    }
}
