//! The request of a setpoint, for the horizontal, the vertical and the heading, each in one of the ways that the
//! firmware's commanders know.

use quatrack::nalgebra::Vector3;

/// The request for each direction. The motion that a position or velocity refers to, and the heading, are beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Along world x and y.
    pub horizontal: Horizontal,
    /// Along world z.
    pub vertical: Vertical,
    /// About the vertical.
    pub turn: Turn,
}

/// The request for the horizontal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Horizontal {
    /// Along the motion.
    Position,
    /// With the motion's velocity.
    Velocity {
        /// Whether it is given in the heading frame, not the world's.
        in_heading_frame: bool,
    },
    /// At a tilt: the direction of the thrust in the heading frame, of norm 1.
    Tilt(Vector3<f32>),
    /// Turning about body x and y, rad/s.
    Rates([f32; 2]),
}

/// The request for the vertical.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Vertical {
    /// Along the motion.
    Position,
    /// With the motion's velocity.
    Velocity,
    /// With this share of the most thrust.
    Thrust(f32),
}

/// The request for the heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Turn {
    /// At the setpoint's heading.
    Heading,
    /// At a rate of the heading, from wherever it is; rad/s.
    Rate(f32),
}

impl Request {
    /// Whether it goes along the motion in all directions, at a heading, as a trajectory asks.
    pub fn is_along(&self) -> bool {
        matches!(self, Self { horizontal: Horizontal::Position, vertical: Vertical::Position, turn: Turn::Heading })
    }

    /// Whether both are the same but for their figures.
    pub fn is_like(&self, other: &Self) -> bool {
        use core::mem::discriminant;
        discriminant(&self.horizontal) == discriminant(&other.horizontal)
            && discriminant(&self.vertical) == discriminant(&other.vertical)
            && discriminant(&self.turn) == discriminant(&other.turn)
    }
}
