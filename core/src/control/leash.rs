//! The leash: a goal's position and velocity (world frame, m, m/s) in; the same, no farther from the measured ones than
//! its length, out.

use nalgebra::Vector3;

use crate::math::sqrt;
use crate::reference::Reference;
use crate::state::State;

/// Farthest that a position is asked for from the measured one, m, and a velocity, m/s: one length for both.
///
/// The laws are linear, and would turn the craft over for a goal metres away, or for a stop in full flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leash {
    /// Its length, m and m/s.
    pub length_m: f32,
}

impl Leash {
    /// A metre, and a metre a second.
    pub const STANDARD: Self = Self { length_m: 1.0 };

    /// The shortest that an owner may set, m: on a shorter one a flight does not get anywhere.
    pub const SHORTEST_M: f32 = 0.1;

    /// The longest that an owner may set, m: in a room it is as good as none.
    pub const LONGEST_M: f32 = 10.0;

    /// None: the laws as they are in the paper.
    pub const NONE: Self = Self { length_m: f32::INFINITY };

    /// Draws a reference whose position and velocity are too far away towards the craft. Its attitude, thrust and body rates
    /// come of its acceleration and jerk, and stay.
    #[inline]
    pub fn hold(&self, reference: &mut Reference, measured: &State) {
        self.draw(&mut reference.state.position_m, &mut reference.state.velocity_m_s, measured);
    }

    /// Draws a position and a velocity that are too far away towards the craft, a metre a second counting like a metre.
    #[inline]
    pub fn draw(&self, position_m: &mut Vector3<f32>, velocity_m_s: &mut Vector3<f32>, measured: &State) {
        let (r, w) = (&measured.position_m, &measured.velocity_m_s);
        let (p, v) = (&*position_m, &*velocity_m_s);
        let (dx, dy, dz) = (p.x - r.x, p.y - r.y, p.z - r.z);
        let (ex, ey, ez) = (v.x - w.x, v.y - w.y, v.z - w.z);
        let squared = (dx * dx + dy * dy + dz * dz) + (ex * ex + ey * ey + ez * ez);
        if squared > self.length_m * self.length_m {
            let share = self.length_m / sqrt(squared);
            *position_m = Vector3::new(r.x + dx * share, r.y + dy * share, r.z + dz * share);
            *velocity_m_s = Vector3::new(w.x + ex * share, w.y + ey * share, w.z + ez * share);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::FlatSample;

    #[test]
    fn a_goal_beyond_the_leash_comes_to_its_end_and_one_within_stays() {
        let measured =
            State { velocity_m_s: Vector3::new(0.0, 0.5, 0.0), ..State::at_rest(Vector3::new(1.0, 2.0, 3.0)) };
        let leash = Leash { length_m: 1.0 };
        let (mut position, mut velocity) = (Vector3::new(4.0, 2.0, 3.0), Vector3::new(0.0, 4.5, 0.0));
        leash.draw(&mut position, &mut velocity, &measured);
        // 3 m and 4 m/s away: five leashes, so a fifth of the way.
        assert!((position - Vector3::new(1.6, 2.0, 3.0)).norm() < 1e-6, "{position}");
        assert!((velocity - Vector3::new(0.0, 1.3, 0.0)).norm() < 1e-6, "{velocity}");
        let (near, slow) = (Vector3::new(1.5, 2.0, 3.0), Vector3::new(0.0, 1.0, 0.0));
        let (mut position, mut velocity) = (near, slow);
        leash.draw(&mut position, &mut velocity, &measured);
        assert_eq!((position, velocity), (near, slow));
    }

    #[test]
    fn a_reference_is_drawn_in_place_and_goes_on_asking_for_its_attitude() {
        let measured = State::at_rest(Vector3::new(0.0, 0.0, 1.0));
        let flat = FlatSample {
            acceleration_m_s2: Vector3::new(2.0, 0.0, 0.0),
            ..FlatSample::at_rest(Vector3::new(5.0, 0.0, 1.0), 0.5)
        };
        let far = Reference::from_flat(&flat).unwrap();
        let mut drawn = far;
        Leash::STANDARD.hold(&mut drawn, &measured);
        let at_its_end = State { position_m: Vector3::new(1.0, 0.0, 1.0), ..*far.state() };
        assert_eq!((drawn.state(), drawn.input()), (&at_its_end, far.input()));
        Leash::NONE.hold(&mut drawn, &State::at_rest(Vector3::new(1e9, 0.0, 0.0)));
        assert_eq!(drawn.state(), &at_its_end);
    }
}
