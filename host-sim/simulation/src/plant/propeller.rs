//! A propeller on its motor: thrust in; speed, reaction torque and angular momentum out.

/// The same on every motor. Thrust and torque are `linear W + quadratic W^2` of the speed `W` in rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Propeller {
    /// Thrust, N per rad/s and N per (rad/s)^2.
    pub thrust: [f64; 2],
    /// Torque of the air, N m per rad/s and per (rad/s)^2; absent: the motor's own torque per thrust.
    pub torque: Option<[f64; 2]>,
    /// Moment of inertia about the axis of all that turns, kg m^2.
    pub inertia_kg_m2: f64,
    /// How the speed follows its command; absent: the thrust follows with the motor's own lags.
    pub response: Option<SpeedResponse>,
}

/// `W' = a (W_c - W) + b (W_c^2 - W^2)`, in a form that RotorPy (b = 0) and crazyflow share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedResponse {
    /// While it grows: a, 1/s, and b, 1/rad.
    pub rise: [f64; 2],
    /// While it falls.
    pub fall: [f64; 2],
}

/// Speed below which a rotor is taken to idle, rad/s: hundredths of the speed that lifts a small craft. Its momentum
/// stays the same there, since its rate by thrust has no bound at rest.
const IDLE_RAD_S: f64 = 10.0;

impl Propeller {
    /// Thrust that is the square of the speed times a coefficient, N per (rad/s)^2.
    pub fn quadratic(thrust_n_s2: f64, inertia_kg_m2: f64) -> Self {
        Self { thrust: [0.0, thrust_n_s2], torque: None, inertia_kg_m2, response: None }
    }

    /// Speed at a thrust, rad/s, at least idling.
    pub fn speed_rad_s(&self, thrust_n: f64) -> f64 {
        let [linear, quadratic] = self.thrust;
        let root = (linear * linear + 4.0 * quadratic * thrust_n).max(0.0).sqrt();
        (0.5 * (root - linear) / quadratic).max(IDLE_RAD_S)
    }

    /// Torque of the air at a speed, N m.
    pub(super) fn torque_n_m(&self, speed_rad_s: f64) -> Option<f64> {
        self.torque.map(|[linear, quadratic]| (linear + quadratic * speed_rad_s) * speed_rad_s)
    }

    /// Rate of the speed, rad/s^2, where the thrust changes at a rate, N/s.
    pub(super) fn speed_rate_rad_s2(&self, speed_rad_s: f64, thrust_rate_n_s: f64) -> f64 {
        if speed_rad_s > IDLE_RAD_S { thrust_rate_n_s / self.slope_n_s(speed_rad_s) } else { 0.0 }
    }

    /// Rate of the thrust under a commanded one, N/s, where the speed has a response of its own.
    pub(super) fn thrust_rate_n_s(&self, thrust_n: f64, command_n: f64) -> Option<f64> {
        let SpeedResponse { rise, fall } = self.response?;
        let (speed, goal) = (self.speed_rad_s(thrust_n), self.speed_rad_s(command_n));
        let [linear, quadratic] = if goal > speed { rise } else { fall };
        Some(self.slope_n_s(speed) * (linear + quadratic * (goal + speed)) * (goal - speed))
    }

    fn slope_n_s(&self, speed_rad_s: f64) -> f64 {
        self.thrust[0] + 2.0 * self.thrust[1] * speed_rad_s
    }
}
