//! The checks before a craft is armed: its state, limits and law in; nothing, or the first reason that forbids it, by
//! name, out.

use core::fmt;

use nalgebra::Vector3;

use super::mode::Fault;
use super::monitor::{Monitor, MonitorConfig, Sample, Soundness};
use crate::clock::Tick;
use crate::command::Limits;
use crate::flatness::GRAVITY_M_S2;
use crate::state::State;

/// Longest age of a state and silence of a link that a flight may be told to tolerate, ticks.
pub(super) const AGE_MAX_TICKS: Tick = 500;
/// Cosine of the largest tilt that is armed: 25 degrees.
const UPRIGHT_LEAST: f32 = 0.906;
/// Voltage of a charged cell, V.
const CELL_V: [f32; 2] = [3.0, 4.35];
/// Room that limits of the thrust have to leave above and below the weight, as a share of it.
const HOVER_ROOM: f32 = 0.1;

/// The range that a law's certificate covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coverage {
    /// Shortest and longest lag of the motors that its certificate covers, s.
    pub lag_s: [f32; 2],
    /// Least and largest mass, kg.
    pub mass_kg: [f32; 2],
    /// Steps a second.
    pub rate_hz: u32,
}

/// A law's certificate as it is known before a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Certified {
    /// Certified for this range.
    For(Coverage),
    /// Not certified for motors that lag.
    ForNone,
    /// It gives commands alone, which somebody else's loop follows.
    NoMotors,
}

/// The inputs of the checks.
#[derive(Clone, Copy, Debug)]
pub struct Preflight {
    /// A fault that only a restart mends.
    pub fault: Option<Fault>,
    /// Ticks since the last accepted frame; none if there never was one.
    pub link_silence_ticks: Option<Tick>,
    /// Longest silence and oldest state that the flight is told to tolerate, ticks.
    pub tolerated_ticks: [Tick; 2],
    /// The newest state, if one has come that is not too old.
    pub state: Option<State>,
    /// Where the reference begins, m; nothing where there is none yet.
    pub reference_m: Option<Vector3<f32>>,
    /// Farthest start from it, m.
    pub start_max_m: f32,
    /// The law's certified range.
    pub law: Certified,
    /// The motors' lag, s.
    pub lag_s: f32,
    /// The craft's mass, kg.
    pub mass_kg: f32,
    /// Control steps a second.
    pub rate_hz: u32,
    /// The limits of commands.
    pub limits: Limits,
    /// Voltage of a cell, V.
    pub battery_v: f32,
}

/// Why an arm request is refused; the motors have not turned.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ArmError {
    /// A fault that only a restart mends.
    Faulted(Fault),
    /// The link has been silent for too long; the request that came over it is too old.
    LinkSilent,
    /// The flight is told to tolerate a state older, or a link silent for longer, than half a second.
    Tolerance {
        /// Ticks.
        ticks: Tick,
    },
    /// No state, or one that cannot be flown on.
    NoState,
    /// The craft is tilted.
    Tilted {
        /// Cosine of the tilt.
        upright: f32,
    },
    /// The reference begins too far from the craft.
    TooFar {
        /// Distance, m.
        distance_m: f32,
        /// The most that the law can bridge, m.
        most_m: f32,
    },
    /// No certificate says that the law flies motors that lag.
    NotCertified,
    /// The law's certificate does not cover the motors' lag.
    Lag {
        /// The craft's, s.
        lag_s: f32,
        /// The longest that is covered, s.
        most_s: f32,
    },
    /// The law's certificate does not cover the mass.
    Mass {
        /// The craft's, kg.
        mass_kg: f32,
        /// The nearest that is covered, kg.
        covered_kg: f32,
    },
    /// The law is for another rate.
    Rate {
        /// The craft's, Hz.
        rate_hz: u32,
        /// The law's, Hz.
        law_hz: u32,
    },
    /// The limits of the thrust leave no hover.
    NoHover {
        /// The bound that is in the way, m/s^2.
        thrust_m_s2: f32,
    },
    /// A voltage that is no charged cell's.
    Battery {
        /// V.
        volts: f32,
    },
}

impl Preflight {
    /// Looks at all of it.
    ///
    /// # Errors
    /// [`ArmError`]: the first in its order.
    #[cold]
    pub fn check(&self) -> Result<(), ArmError> {
        self.check_link()?;
        let [silence, age] = self.tolerated_ticks;
        if let Some(ticks) = [silence, age].into_iter().find(|ticks| *ticks > AGE_MAX_TICKS) {
            return Err(ArmError::Tolerance { ticks });
        }
        self.check_start()?;
        self.check_law()?;
        let (least, most) = (self.limits.thrust_min_m_s2(), self.limits.thrust_max_m_s2());
        if least > (1.0 - HOVER_ROOM) * GRAVITY_M_S2 {
            return Err(ArmError::NoHover { thrust_m_s2: least });
        }
        if most < (1.0 + HOVER_ROOM) * GRAVITY_M_S2 {
            return Err(ArmError::NoHover { thrust_m_s2: most });
        }
        let [empty, full] = CELL_V;
        if !(self.battery_v >= empty && self.battery_v <= full) {
            return Err(ArmError::Battery { volts: self.battery_v });
        }
        Ok(())
    }

    /// Looks at faults and the link alone: for a craft whose motors do not turn.
    ///
    /// # Errors
    /// [`ArmError::Faulted`], [`ArmError::LinkSilent`].
    #[cold]
    pub fn check_link(&self) -> Result<(), ArmError> {
        if let Some(fault) = self.fault {
            return Err(ArmError::Faulted(fault));
        }
        let [silence, _] = self.tolerated_ticks;
        if self.link_silence_ticks.is_none_or(|ticks| ticks > silence) {
            return Err(ArmError::LinkSilent);
        }
        Ok(())
    }

    fn check_start(&self) -> Result<(), ArmError> {
        let Some(state) = &self.state else { return Err(ArmError::NoState) };
        let sample =
            Sample { now: 0, state: Some(state), body_rates_rad_s: None, specific_force_m_s2: None, thrust_m_s2: 0.0 };
        let mut monitor = Monitor::new();
        let looked = monitor.look(&MonitorConfig::STANDARD, &sample);
        if looked.soundness != Soundness::Sound {
            return Err(ArmError::NoState);
        }
        let q = looked.state.attitude;
        let upright = 1.0 - 2.0 * (q.x * q.x + q.y * q.y) / q.dot(q);
        if upright.is_nan() || upright < UPRIGHT_LEAST {
            return Err(ArmError::Tilted { upright });
        }
        let Some(reference) = self.reference_m else { return Ok(()) };
        let way = reference - state.position_m;
        let distance_m = crate::math::sqrt(way.dot(&way));
        if distance_m <= self.start_max_m {
            Ok(())
        } else {
            Err(ArmError::TooFar { distance_m, most_m: self.start_max_m })
        }
    }

    fn check_law(&self) -> Result<(), ArmError> {
        let Coverage { lag_s: [shortest, longest], mass_kg: [lightest, heaviest], rate_hz } = match self.law {
            Certified::For(coverage) => coverage,
            Certified::ForNone => return Err(ArmError::NotCertified),
            Certified::NoMotors => return Ok(()),
        };
        if !(self.lag_s >= shortest && self.lag_s <= longest) {
            return Err(ArmError::Lag { lag_s: self.lag_s, most_s: longest });
        }
        if !(self.mass_kg >= lightest && self.mass_kg <= heaviest) {
            let covered_kg = if self.mass_kg > heaviest { heaviest } else { lightest };
            return Err(ArmError::Mass { mass_kg: self.mass_kg, covered_kg });
        }
        if self.rate_hz != rate_hz {
            return Err(ArmError::Rate { rate_hz: self.rate_hz, law_hz: rate_hz });
        }
        Ok(())
    }
}

impl fmt::Display for ArmError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("arm: ")?;
        match self {
            Self::Faulted(fault) => write!(f, "{fault} since start-up; restart the board"),
            Self::LinkSilent => f.write_str("the link is silent; send states first"),
            Self::Tolerance { ticks } => {
                write!(f, "a state age or link silence of {ticks} ticks is tolerated; set at most {AGE_MAX_TICKS}")
            }
            Self::NoState => f.write_str("no state that can be flown on; send one first"),
            Self::Tilted { upright } => {
                write!(f, "the craft is tilted (cosine {upright}, at least {UPRIGHT_LEAST}); put it upright")
            }
            Self::TooFar { distance_m, most_m } => write!(
                f,
                "the reference begins {distance_m} m away, the law is good for {most_m} m; begin where the craft is"
            ),
            Self::NotCertified => {
                f.write_str("no certificate says that the law flies motors that lag; select another law")
            }
            Self::Lag { lag_s, most_s } => {
                write!(f, "the motors' lag is {lag_s} s, the law is certified up to {most_s} s; select another law")
            }
            Self::Mass { mass_kg, covered_kg } => {
                write!(f, "the mass is {mass_kg} kg, the law is certified to {covered_kg} kg; select another law")
            }
            Self::Rate { rate_hz, law_hz } => {
                write!(f, "{rate_hz} steps a second, the law is for {law_hz}; set the decimation or select another law")
            }
            Self::NoHover { thrust_m_s2 } => write!(
                f,
                "a bound of the thrust of {thrust_m_s2} m/s^2 leaves no hover; set limits on both sides of 9.81"
            ),
            Self::Battery { volts } => {
                let [empty, full] = CELL_V;
                write!(f, "a battery of {volts} V; a charged cell has {empty} to {full} V")
            }
        }
    }
}

impl core::error::Error for ArmError {}

#[cfg(test)]
mod tests;
