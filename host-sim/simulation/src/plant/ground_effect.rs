//! Ground effect, by Cheeseman and Bennett: height of each rotor over the floor in; the additional thrust of each rotor,
//! as force and torque on the craft, out.

use nalgebra::Vector3;

use super::{Load, MotorBank, RigidState, Wrench};

/// Each rotor's thrust at a height `z` over the ground grows by `1 / (1 - (R / 4 z)^2)`: Cheeseman and Bennett, "The effect of
/// the ground on a helicopter rotor in forward flight", ARC R&M 3021 (1955), equation for hover. In forward flight it is less;
/// rotors side by side make it more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundEffect {
    /// Radius of a rotor, m.
    pub radius_m: f64,
    /// Places of the rotors, body frame, m.
    pub rotors_m: [Vector3<f64>; 4],
}

/// Nearest height in radii: below it the formula is not held by its measurements.
const NEAREST: f64 = 0.5;

impl GroundEffect {
    /// The ground effect of a craft's motors.
    pub fn of(motors: &MotorBank, radius_m: f64) -> Self {
        Self { radius_m, rotors_m: motors.motors.map(|motor| motor.position_m) }
    }

    /// Thrust at a height over thrust far above the ground.
    pub fn factor(&self, height_m: f64) -> f64 {
        let ratio = self.radius_m / (4.0 * height_m.max(NEAREST * self.radius_m));
        1.0 / (1.0 - ratio * ratio)
    }
}

impl Load for GroundEffect {
    fn wrench(&self, _time_s: f64, state: &RigidState) -> Wrench {
        let axis = state.thrust_axis();
        let mut whole = Wrench::default();
        for (rotor_m, thrust_n) in self.rotors_m.iter().zip(state.thrusts_n.iter()) {
            let height_m = state.position_m.z + (state.attitude * rotor_m).z;
            let more_n = (self.factor(height_m) - 1.0) * thrust_n;
            whole.force_n += axis * more_n;
            whole.torque_n_m += Vector3::new(rotor_m.y * more_n, -rotor_m.x * more_n, 0.0);
        }
        whole
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vehicles;

    #[test]
    fn it_is_cheeseman_and_bennett_s_and_level_over_level_ground() {
        let vehicle = vehicles::by_name("crazyflie-2.1").expect("built in");
        let effect = GroundEffect::of(&MotorBank::of(&vehicle), 0.0225);
        // At one radius 1 / (1 - 1/16).
        assert!((effect.factor(0.0225) - 16.0 / 15.0).abs() < 1e-12);
        assert!((effect.factor(0.0) - 4.0 / 3.0).abs() < 1e-12);
        let mut state = RigidState::at_rest(Vector3::new(0.0, 0.0, 0.0225), 0.07);
        let level = effect.wrench(0.0, &state);
        assert!((level.force_n - Vector3::new(0.0, 0.0, 4.0 * 0.07 / 15.0)).norm() < 1e-12);
        assert!(level.torque_n_m.norm() < 1e-15);
        // Rolled to the right, the right rotors are nearer to the ground: it is pushed back.
        state.attitude = nalgebra::UnitQuaternion::from_euler_angles(0.2, 0.0, 0.0);
        assert!(effect.wrench(0.0, &state).torque_n_m.x < 0.0);
    }
}
