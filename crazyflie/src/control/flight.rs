//! The state of a flight: off, along a stream of setpoints, guided by a request, or at body rates by hand. One enum, so
//! that no two hold at once.

use quatrack::Followed;
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::Asked;

use crate::craft::Craft;
use crate::request::{Horizontal, Request, Turn, Vertical};

/// The state of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Flight {
    /// Motors off until the app has said which craft this is.
    NoCraft,
    /// Motors off.
    Off,
    /// In the air, with nothing that could be followed yet.
    Unknown,
    /// Along the motion of its setpoints, at their heading.
    Stream,
    /// Along the motion that setpoint shaping makes of a request.
    Guided(Request),
    /// By hand, at body rates (rad/s) under a thrust over mass (m/s^2).
    Rates { body_rates_rad_s: Vector3<f32>, thrust_m_s2: f32 },
}

impl Flight {
    /// The state of flight that flies a request.
    pub(super) fn of(request: &Request, craft: &Craft) -> Self {
        let Horizontal::Rates([p, q]) = request.horizontal else {
            return if request.is_along() { Self::Stream } else { Self::Guided(*request) };
        };
        let r = match request.turn {
            Turn::Rate(rate) => rate,
            Turn::Heading => 0.0,
        };
        let thrust_m_s2 = match request.vertical {
            Vertical::Thrust(share) => share * craft.thrust_max_m_s2,
            // A height that is held while the craft turns over is nothing that anybody asks for.
            _ => quatrack::flatness::GRAVITY_M_S2,
        };
        Self::Rates { body_rates_rad_s: Vector3::new(p, q, r), thrust_m_s2 }
    }

    /// The kind of flight for the supervisor: by hand at rates or tilts, or along a motion.
    #[inline(always)]
    pub(super) const fn asked(&self) -> Asked {
        match self {
            Self::Rates { .. } => Asked::Rates,
            Self::Guided(Request { horizontal: Horizontal::Tilt(_), .. }) => Asked::Tilts,
            _ => Asked::Places,
        }
    }

    /// Whether one goes on as the other, but for its figures.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Guided(a), Self::Guided(b)) => a.is_like(b),
            _ => core::mem::discriminant(self) == core::mem::discriminant(other),
        }
    }

    /// Whether the motors turn.
    pub(super) const fn is_on(&self) -> bool {
        !matches!(self, Self::NoCraft | Self::Off)
    }

    /// Which directions of the sample a law follows.
    #[inline(always)]
    pub(super) fn followed(&self) -> Followed {
        match self {
            Self::Guided(request) => Followed {
                across: !matches!(request.horizontal, Horizontal::Tilt(_)),
                height: !matches!(request.vertical, Vertical::Thrust(_)),
            },
            _ => Followed::ALL,
        }
    }
}
