//! What a setpoint asks for, in SI units: of the horizontal, the vertical and the heading, each in one of the ways that
//! the firmware's commanders know.

use quatrack::Heading;
use quatrack::nalgebra::Vector3;

/// A setpoint taken apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Demand {
    /// Motors off.
    Off,
    /// To be flown.
    Fly(Flight),
}

/// How to fly. The motion that a position or velocity refers to stands beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    /// Along world x and y.
    pub horizontal: Horizontal,
    /// Along world z.
    pub vertical: Vertical,
    /// About the vertical.
    pub turn: Turn,
}

/// How to move over the ground.
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

/// How to move up and down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Vertical {
    /// Along the motion.
    Position,
    /// With the motion's velocity.
    Velocity,
    /// With this thrust, N.
    Thrust(f32),
}

/// How to turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Turn {
    /// At a heading.
    Heading {
        /// Which.
        heading: Heading,
        /// Its rate, rad/s.
        rate_rad_s: f32,
    },
    /// At a rate of the heading, from wherever it is; rad/s.
    Rate(f32),
}

impl Flight {
    /// Level and slowly down where it is: what is flown instead of a setpoint that makes no sense.
    pub const DESCENT: Self = Self {
        horizontal: Horizontal::Tilt(Vector3::new(0.0, 0.0, 1.0)),
        vertical: Vertical::Velocity,
        turn: Turn::Rate(0.0),
    };

    /// Whether it goes along the motion in all directions, at a heading: what a trajectory asks for.
    pub fn is_along(&self) -> bool {
        matches!(
            self,
            Self { horizontal: Horizontal::Position, vertical: Vertical::Position, turn: Turn::Heading { .. } }
        )
    }

    /// Whether both are the same but for their figures.
    pub fn is_like(&self, other: &Self) -> bool {
        use core::mem::discriminant;
        discriminant(&self.horizontal) == discriminant(&other.horizontal)
            && discriminant(&self.vertical) == discriminant(&other.vertical)
            && discriminant(&self.turn) == discriminant(&other.turn)
    }
}

/// Position and its derivatives at one time, world frame.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// m.
    pub position_m: Vector3<f32>,
    /// m/s.
    pub velocity_m_s: Vector3<f32>,
    /// m/s^2.
    pub acceleration_m_s2: Vector3<f32>,
    /// m/s^3.
    pub jerk_m_s3: Vector3<f32>,
}

impl Motion {
    /// At rest at the origin.
    pub const ZERO: Self = Self {
        position_m: Vector3::new(0.0, 0.0, 0.0),
        velocity_m_s: Vector3::new(0.0, 0.0, 0.0),
        acceleration_m_s2: Vector3::new(0.0, 0.0, 0.0),
        jerk_m_s3: Vector3::new(0.0, 0.0, 0.0),
    };
}

impl PartialEq for Motion {
    // Derived, it would be a call.
    #[inline(always)]
    fn eq(&self, other: &Self) -> bool {
        let same = |a: &Vector3<f32>, b: &Vector3<f32>| a.x == b.x && a.y == b.y && a.z == b.z;
        same(&self.position_m, &other.position_m)
            && same(&self.velocity_m_s, &other.velocity_m_s)
            && same(&self.acceleration_m_s2, &other.acceleration_m_s2)
            && same(&self.jerk_m_s3, &other.jerk_m_s3)
    }
}
