//! Setpoint shaping: makes a motion to follow of a request that is none. Velocities, tilts and turns in; a motion with
//! heading out.
//!
//! The axes that a request leaves free are taken from the measured state, so that the laws see no error there: at a tilt,
//! position and velocity over the ground; under manual thrust, height and climb. A velocity setpoint becomes a position
//! that moves with it, speeding up no faster than [`Bounds`] allow, and never far from where the craft is.

use quatrack::flatness::GRAVITY_M_S2;
use quatrack::math::sqrt;
use quatrack::nalgebra::Vector3;
use quatrack::{FifthOrderSample, Heading, Leash, State};

use crate::heading::HeadingStream;
use crate::request::{Horizontal, Request, Turn, Vertical};
use crate::stream::Stream;
use crate::units;

/// Bounds of shaped motions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Largest speed of a velocity setpoint, m/s, over the ground and up or down.
    pub speed_m_s: f32,
    /// Largest acceleration of a velocity setpoint, m/s^2.
    pub acceleration_m_s2: f32,
    /// Farthest that a position or a velocity is asked for from the measured one, of a law without limits of its own.
    pub leash: Leash,
}

/// How fast a velocity setpoint is taken up, 1/s.
const VELOCITY_BANDWIDTH_1_S: f32 = 6.0;

/// How far the position of a velocity setpoint may run ahead of the craft along each axis, m.
const LEAD_MAX_M: f32 = 0.25;

/// The integrated state: the point that a velocity setpoint moves, the heading that a turn rate moves.
#[derive(Clone, Copy, Debug)]
pub struct Shaping {
    position_m: Vector3<f32>,
    velocity_m_s: Vector3<f32>,
    heading_rad: f32,
    period_s: f32,
    /// It begins where the craft is at the next step.
    is_new: bool,
}

/// The inputs of a step of shaping.
#[derive(Clone, Copy, Debug)]
pub struct Shaped<'a> {
    /// The request.
    pub request: &'a Request,
    /// Motions.
    pub stream: &'a Stream,
    /// Headings.
    pub headings: &'a HeadingStream,
    /// The time, ms.
    pub now_ms: u32,
    /// Whether the law looks beyond the jerk.
    pub beyond_jerk: bool,
    /// Of all motors together over the mass, m/s^2.
    pub thrust_max_m_s2: f32,
}

impl Shaping {
    /// To begin where the craft is.
    pub const fn new(period_s: f32) -> Self {
        let zero = Vector3::new(0.0, 0.0, 0.0);
        Self { position_m: zero, velocity_m_s: zero, heading_rad: 0.0, period_s, is_new: true }
    }

    /// Starts a flight of another kind from where the craft is at the next step.
    pub fn begin(&mut self) {
        self.is_new = true;
    }

    #[cold]
    #[inline(never)]
    fn begin_at(&mut self, state: &State) {
        let heading_rad = units::heading_rad(&state.attitude);
        let (position_m, velocity_m_s) = (state.position_m, state.velocity_m_s);
        *self = Self { position_m, velocity_m_s, heading_rad, is_new: false, ..*self };
    }

    /// The motion to follow at this step: it goes into `sample`, whose angle of heading is not used, and the heading. Not
    /// for a horizontal that asks for body rates, which no flat sample has.
    #[inline(never)]
    pub fn put(
        &mut self,
        shaped: &Shaped<'_>,
        state: &State,
        bounds: &Bounds,
        sample: &mut FifthOrderSample,
    ) -> Heading {
        if self.is_new {
            self.begin_at(state);
        }
        let request = shaped.request;
        shaped.stream.at(shaped.now_ms, shaped.beyond_jerk, sample);
        let heading = match request.turn {
            Turn::Heading => shaped.headings.at(shaped.now_ms, sample),
            Turn::Rate(rate_rad_s) => self.turn(sample, rate_rad_s),
        };
        if !matches!((&request.horizontal, &request.vertical), (Horizontal::Position, Vertical::Position)) {
            self.fill(sample, &heading, shaped, state, bounds);
        }
        heading
    }

    /// A heading that turns from where it is.
    #[inline(never)]
    fn turn(&mut self, sample: &mut FifthOrderSample, rate_rad_s: f32) -> Heading {
        const TURN: f32 = core::f32::consts::TAU;
        self.heading_rad += rate_rad_s * self.period_s;
        // Two turns give the same quaternion, one its negative, which is the same attitude.
        if self.heading_rad.abs() > 2.0 * TURN {
            self.heading_rad -= if self.heading_rad > 0.0 { 2.0 * TURN } else { -2.0 * TURN };
        }
        sample.flat.heading_rate_rad_s = rate_rad_s;
        (sample.heading_acceleration_rad_s2, sample.heading_jerk_rad_s3) = (0.0, 0.0);
        Heading::from_angle(self.heading_rad)
    }

    /// Everything but a position along all axes.
    #[inline(never)]
    fn fill(
        &mut self,
        sample: &mut FifthOrderSample,
        heading: &Heading,
        shaped: &Shaped<'_>,
        state: &State,
        bounds: &Bounds,
    ) {
        let request = shaped.request;
        // As it was sent: a velocity holds until another one comes.
        let asked = shaped.stream.newest().velocity_m_s;
        let zero = Vector3::new(0.0, 0.0, 0.0);
        // Derivatives of a motion along some axes only, or of none.
        (sample.flat.jerk_m_s3, sample.snap_m_s4, sample.crackle_m_s5) = (zero, zero, zero);
        let a = &mut sample.flat.acceleration_m_s2;
        match request.horizontal {
            Horizontal::Position => {}
            Horizontal::Velocity { in_heading_frame } => {
                let (cos, sin) = heading.cos_sin();
                let (vx, vy) = if in_heading_frame {
                    (cos * asked.x - sin * asked.y, sin * asked.x + cos * asked.y)
                } else {
                    (asked.x, asked.y)
                };
                let speed = sqrt(vx * vx + vy * vy);
                let share = if speed > bounds.speed_m_s { bounds.speed_m_s / speed } else { 1.0 };
                let (ax, ay) = self.approach([vx * share, vy * share], bounds.acceleration_m_s2);
                (a.x, a.y) = (ax, ay);
                let lead = |position: f32, velocity: f32, measured: f32| {
                    within(position + velocity * self.period_s, measured - LEAD_MAX_M, measured + LEAD_MAX_M)
                };
                self.position_m.x = lead(self.position_m.x, self.velocity_m_s.x, state.position_m.x);
                self.position_m.y = lead(self.position_m.y, self.velocity_m_s.y, state.position_m.y);
                (sample.flat.position_m.x, sample.flat.position_m.y) = (self.position_m.x, self.position_m.y);
                (sample.flat.velocity_m_s.x, sample.flat.velocity_m_s.y) = (self.velocity_m_s.x, self.velocity_m_s.y);
            }
            Horizontal::Tilt(_) | Horizontal::Rates(_) => {
                (sample.flat.position_m.x, sample.flat.position_m.y) = (state.position_m.x, state.position_m.y);
                (sample.flat.velocity_m_s.x, sample.flat.velocity_m_s.y) = (state.velocity_m_s.x, state.velocity_m_s.y);
            }
        }
        match request.vertical {
            Vertical::Position => {}
            Vertical::Velocity => {
                let (limit, v) = (bounds.speed_m_s, self.velocity_m_s.z);
                let acceleration = VELOCITY_BANDWIDTH_1_S * (within(asked.z, -limit, limit) - v);
                a.z = within(acceleration, -bounds.acceleration_m_s2, bounds.acceleration_m_s2);
                self.velocity_m_s.z = v + a.z * self.period_s;
                let (next, z) = (self.position_m.z + self.velocity_m_s.z * self.period_s, state.position_m.z);
                self.position_m.z = within(next, z - LEAD_MAX_M, z + LEAD_MAX_M);
                sample.flat.position_m.z = self.position_m.z;
                sample.flat.velocity_m_s.z = self.velocity_m_s.z;
            }
            Vertical::Thrust(share) => {
                sample.flat.position_m.z = state.position_m.z;
                sample.flat.velocity_m_s.z = state.velocity_m_s.z;
                a.z = share * shaped.thrust_max_m_s2 - GRAVITY_M_S2;
            }
        }
        if let Horizontal::Tilt(axis) = request.horizontal {
            let (cos, sin) = heading.cos_sin();
            let world = Vector3::new(cos * axis.x - sin * axis.y, sin * axis.x + cos * axis.y, axis.z);
            // Under manual thrust its direction is turned; at a height its vertical part is kept.
            let along = match request.vertical {
                Vertical::Thrust(share) => share * shaped.thrust_max_m_s2,
                _ => (a.z + GRAVITY_M_S2) / if world.z > 0.5 { world.z } else { 0.5 },
            };
            *a = Vector3::new(world.x * along, world.y * along, world.z * along - GRAVITY_M_S2);
        }
    }

    /// Moves the velocity over the ground towards the asked one and returns its acceleration.
    fn approach(&mut self, asked: [f32; 2], acceleration_max: f32) -> (f32, f32) {
        let (ax, ay) = (
            VELOCITY_BANDWIDTH_1_S * (asked[0] - self.velocity_m_s.x),
            VELOCITY_BANDWIDTH_1_S * (asked[1] - self.velocity_m_s.y),
        );
        let size = sqrt(ax * ax + ay * ay);
        let share = if size > acceleration_max { acceleration_max / size } else { 1.0 };
        let (ax, ay) = (ax * share, ay * share);
        self.velocity_m_s.x += ax * self.period_s;
        self.velocity_m_s.y += ay * self.period_s;
        (ax, ay)
    }
}

fn within(value: f32, min: f32, max: f32) -> f32 {
    if value > max {
        max
    } else if value < min {
        min
    } else {
        value
    }
}
