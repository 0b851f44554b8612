//! The inbox: owns the newest setpoint as the firmware has it, and names the change. Below it there is no C struct.

mod clock;
mod comparison;
mod parsing;

use quatrack::Heading;

use self::clock::Clock;
use self::parsing::Parsed;
use crate::abi;
use crate::motion::Motion;
use crate::request::Request;
use crate::units;

/// The change since the inbox was last looked into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum News {
    /// Nothing.
    Nothing,
    /// Motion and heading alone, of a request that goes along them: [`Inbox::newest`] has them.
    Motion,
    /// Something else, which is to be taken.
    Other,
}

/// The request of a setpoint that was taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// To be flown.
    Request(Request),
    /// Motors off.
    Off,
    /// The setpoint makes no sense.
    Bad,
}

/// The newest setpoint's motion and heading.
#[derive(Clone, Copy, Debug)]
pub struct Newest {
    /// Its motion.
    pub motion: Motion,
    /// Its heading, where it has one.
    pub heading: Heading,
    /// The heading's rate as it was sent, rad/s.
    pub heading_rate_rad_s: f32,
    /// Whether the heading was given as an angle of yaw.
    pub is_by_yaw: bool,
    /// The step at which it was sent.
    pub date_ms: u32,
}

/// The inbox.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Inbox {
    /// The newest one, but for the fields that are never compared.
    kept: abi::Setpoint,
    newest: Newest,
    /// Whether it asks for a motion along setpoints at a heading.
    is_along: bool,
    clock: Clock,
    /// The stamp that was seen last, and at which step first.
    stamp_ms: u32,
    seen_ms: u32,
}

impl Inbox {
    /// With motors off.
    #[allow(clippy::new_without_default, reason = "a default is not const")]
    pub const fn new() -> Self {
        Self {
            kept: abi::Setpoint::OFF,
            newest: Newest {
                motion: Motion::ZERO,
                heading: Heading::ZERO,
                heading_rate_rad_s: 0.0,
                is_by_yaw: false,
                date_ms: 0,
            },
            is_along: false,
            clock: Clock::new(),
            stamp_ms: 0,
            seen_ms: 0,
        }
    }

    /// The newest setpoint's motion and heading.
    #[inline(always)]
    pub const fn newest(&self) -> &Newest {
        &self.newest
    }

    /// At every call: remembers when a stamp was first seen, which dates a setpoint that has to wait.
    #[inline(always)]
    pub fn note(&mut self, setpoint: &abi::Setpoint, now_ms: u32) {
        if setpoint.timestamp != self.stamp_ms || setpoint.timestamp == 0 {
            (self.stamp_ms, self.seen_ms) = (setpoint.timestamp, now_ms);
        }
    }

    /// At a control step: whether a setpoint of another kind has come, which cannot wait for the next call.
    #[inline(always)]
    pub fn is_urgent(&mut self, setpoint: &abi::Setpoint, now_ms: u32) -> bool {
        self.note(setpoint, now_ms);
        comparison::is_another_kind(&self.kept, setpoint)
    }

    /// At a call between that has time: everything. A motion is taken.
    #[inline(always)]
    pub fn look(&mut self, setpoint: &abi::Setpoint) -> News {
        if comparison::is_same(&self.kept, setpoint) {
            News::Nothing
        } else if self.is_along && self.goes_on(setpoint) {
            News::Motion
        } else {
            News::Other
        }
    }

    /// Takes a setpoint of any kind.
    #[inline(never)]
    pub fn take(&mut self, setpoint: &abi::Setpoint) -> Change {
        self.kept = *setpoint;
        self.is_along = false;
        match parsing::parse(setpoint) {
            Parsed::Off => Change::Off,
            Parsed::Bad => Change::Bad,
            Parsed::Fly(request) => {
                self.newest.motion = units::motion(setpoint);
                if let Some(headed) = parsing::headed(setpoint) {
                    self.turn_to(headed, setpoint);
                }
                self.newest.date_ms = self.clock.date_ms(setpoint.timestamp, self.seen_ms);
                self.is_along = request.is_along();
                Change::Request(request)
            }
        }
    }

    /// Takes one more setpoint of a flight along a trajectory, of which only figures are new; whether it is one.
    #[inline(always)]
    fn goes_on(&mut self, setpoint: &abi::Setpoint) -> bool {
        if comparison::is_another_kind(&self.kept, setpoint) || !parsing::has_sound_figures(setpoint) {
            return false;
        }
        let is_turned = setpoint.attitude.yaw.to_bits() != self.kept.attitude.yaw.to_bits()
            || !parsing::is_by_yaw(setpoint)
            || setpoint.attitude_rate.yaw != 0.0
            || self.newest.heading_rate_rad_s != 0.0;
        // Most flights do not turn.
        if is_turned {
            let Some(headed) = parsing::headed(setpoint) else { return false };
            self.turn_to(headed, setpoint);
        }
        self.newest.motion = units::motion(setpoint);
        if setpoint.timestamp != self.kept.timestamp || setpoint.timestamp == 0 {
            self.newest.date_ms = self.clock.date_ms(setpoint.timestamp, self.seen_ms);
        }
        let kept = &mut self.kept;
        (kept.timestamp, kept.position, kept.velocity) = (setpoint.timestamp, setpoint.position, setpoint.velocity);
        (kept.attitude, kept.attitude_rate.yaw, kept.thrust) =
            (setpoint.attitude, setpoint.attitude_rate.yaw, setpoint.thrust);
        if setpoint.timestamp == 0 {
            self.kept = *setpoint;
        }
        true
    }

    #[inline(always)]
    fn turn_to(&mut self, (heading, rate_rad_s): parsing::Headed, setpoint: &abi::Setpoint) {
        (self.newest.heading, self.newest.heading_rate_rad_s) = (heading, rate_rad_s);
        self.newest.is_by_yaw = parsing::is_by_yaw(setpoint);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::abi::{Mode, Modes, Setpoint};
    use crate::request::{Horizontal, Turn, Vertical};

    fn along(stamp: u32, x: f32, yaw: f32) -> Setpoint {
        let on = Mode::ABSOLUTE;
        let mut setpoint = Setpoint { timestamp: stamp, ..Setpoint::OFF };
        setpoint.mode = Modes { x: on, y: on, z: on, yaw: on, ..Setpoint::OFF.mode };
        (setpoint.position.x, setpoint.attitude.yaw) = (x, yaw);
        setpoint
    }

    const ALONG: Change = Change::Request(Request {
        horizontal: Horizontal::Position,
        vertical: Vertical::Position,
        turn: Turn::Heading,
    });

    fn look(inbox: &mut Inbox, setpoint: &Setpoint, now_ms: u32) -> News {
        inbox.note(setpoint, now_ms);
        inbox.look(setpoint)
    }

    #[test]
    fn it_names_the_change() {
        let mut inbox = Inbox::new();
        assert!(inbox.is_urgent(&along(5, 1.0, 0.0), 105), "another kind cannot wait");
        assert_eq!(inbox.take(&along(5, 1.0, 0.0)), ALONG);
        assert_eq!(look(&mut inbox, &along(5, 1.0, 0.0), 106), News::Nothing);
        assert!(!inbox.is_urgent(&along(15, 1.1, 90.0), 115), "one more of them can");
        assert_eq!(look(&mut inbox, &along(15, 1.1, 90.0), 116), News::Motion);
        let newest = inbox.newest();
        assert_eq!((newest.motion.position_m.x, newest.date_ms), (1.1, 115), "dated by when it was first seen");
        assert!((newest.heading.cos_sin().1 - 1.0).abs() < 1e-6);
        let mut moved = along(15, 1.1, 90.0);
        moved.velocity.x = 0.5;
        assert_eq!(look(&mut inbox, &moved, 118), News::Motion, "collision avoidance changes a stamped setpoint");
        assert_eq!(inbox.newest().date_ms, 115);
        assert!(inbox.is_urgent(&Setpoint { timestamp: 20, ..Setpoint::OFF }, 120));
        assert_eq!(inbox.take(&Setpoint::OFF), Change::Off);
    }

    #[test]
    fn a_nan_is_bad_in_any_field() {
        let bad = |change: fn(&mut Setpoint)| {
            let mut inbox = Inbox::new();
            inbox.is_urgent(&along(5, 1.0, 0.0), 105);
            inbox.take(&along(5, 1.0, 0.0));
            let mut setpoint = along(15, 1.0, 0.0);
            change(&mut setpoint);
            match look(&mut inbox, &setpoint, 115) {
                News::Other => inbox.take(&setpoint) == Change::Bad,
                _ => false,
            }
        };
        assert!(bad(|s| s.position.z = f32::NAN));
        assert!(bad(|s| s.jerk.y = f32::INFINITY));
        assert!(bad(|s| s.attitude.yaw = f32::NAN));
        assert!(bad(|s| s.attitude_rate.yaw = f32::NAN));
        assert!(bad(|s| s.acceleration.x = 3e38));
        assert!(bad(|s| s.mode.z = Mode(7)));
        // Turned 300 times.
        assert!(!bad(|s| s.attitude.yaw = 108_000.0));
    }

    #[test]
    fn without_a_stamp_all_of_it_is_compared() {
        let mut inbox = Inbox::new();
        inbox.is_urgent(&along(0, 1.0, 0.0), 100);
        inbox.take(&along(0, 1.0, 0.0));
        assert_eq!(look(&mut inbox, &along(0, 1.0, 0.0), 101), News::Nothing);
        let mut other = along(0, 1.0, 0.0);
        other.jerk.x = 1.0;
        assert_eq!(look(&mut inbox, &other, 103), News::Motion);
        assert_eq!(inbox.newest().date_ms, 103);
        assert_eq!(look(&mut inbox, &other, 105), News::Nothing);
    }
}
