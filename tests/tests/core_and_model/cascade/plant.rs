//! A craft in air, f64: rigid body, motors with lag and delay, drag, the air's moment; for flights of the cascade.

use nalgebra::{UnitQuaternion, Vector3};

pub(crate) const GRAVITY: f64 = 9.81;
/// Step of the integration, s.
pub(crate) const STEP_S: f64 = 0.0005;

/// The true figures of a craft.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Craft {
    pub(crate) mass_kg: f64,
    pub(crate) inertia: [f64; 3],
    pub(crate) lever_m: f64,
    pub(crate) torque_per_thrust_m: f64,
    pub(crate) force_max_n: f64,
    /// Time constants of a rising and a falling force, s.
    pub(crate) lag_s: [f64; 2],
    pub(crate) delay_s: f64,
    /// Linear drag over mass, body frame, 1/s.
    pub(crate) drag: [f64; 3],
    /// Moment per velocity, N s.
    pub(crate) moment: [f64; 2],
    /// Force of each motor over its command.
    pub(crate) motors: [f64; 4],
    /// Torque that is not the motors', N m.
    pub(crate) torque_bias: [f64; 3],
}

/// Where it is.
#[derive(Clone, Debug)]
pub(crate) struct Plant {
    pub(crate) craft: Craft,
    pub(crate) p: Vector3<f64>,
    pub(crate) v: Vector3<f64>,
    pub(crate) q: UnitQuaternion<f64>,
    pub(crate) w: Vector3<f64>,
    pub(crate) forces: [f64; 4],
    /// Specific force in the body frame, m/s^2.
    pub(crate) felt: Vector3<f64>,
    waiting: std::collections::VecDeque<[f64; 4]>,
    pub(crate) on_ground: bool,
}

impl Plant {
    pub(crate) fn at(craft: Craft, p: Vector3<f64>, flying: bool) -> Self {
        let hover = if flying { craft.mass_kg * GRAVITY / 4.0 } else { 0.0 };
        let waiting = vec![[hover / craft.motors[0]; 4]; (craft.delay_s / STEP_S).round() as usize].into();
        Self {
            craft,
            p,
            v: Vector3::zeros(),
            q: UnitQuaternion::identity(),
            w: Vector3::zeros(),
            forces: [hover; 4],
            felt: Vector3::new(0.0, 0.0, GRAVITY),
            waiting,
            on_ground: !flying,
        }
    }

    /// Moves on by a step of the integration, in a wind and with a force over mass from outside.
    pub(crate) fn step(&mut self, commands: &[f64; 4], wind: &Vector3<f64>, push: &Vector3<f64>) {
        self.waiting.push_back(*commands);
        let commands = self.waiting.pop_front().unwrap_or(*commands);
        let c = self.craft;
        let before = self.forces;
        for (force, (command, share)) in self.forces.iter_mut().zip(commands.iter().zip(c.motors)) {
            let wanted = (share * command).clamp(0.0, c.force_max_n);
            let lag = if wanted > *force { c.lag_s[0] } else { c.lag_s[1] };
            *force = wanted + (*force - wanted) * (-STEP_S / lag).exp();
        }
        let f: Vec<f64> = (0..4).map(|i| 0.5 * (before[i] + self.forces[i])).collect();
        let thrust = f.iter().sum::<f64>() / c.mass_kg;
        let motors = Vector3::new(
            c.lever_m * (-f[0] - f[1] + f[2] + f[3]),
            c.lever_m * (-f[0] + f[1] + f[2] - f[3]),
            c.torque_per_thrust_m * (-f[0] + f[1] - f[2] + f[3]),
        ) + Vector3::from(c.torque_bias);
        let inertia = Vector3::from(c.inertia);
        let rates = |v: &Vector3<f64>, q: &UnitQuaternion<f64>, w: &Vector3<f64>| {
            let air = q.inverse() * (v - wind);
            let drag = Vector3::from(c.drag).component_mul(&air);
            let felt = Vector3::new(0.0, 0.0, thrust) - drag;
            let acceleration = q * felt - Vector3::new(0.0, 0.0, GRAVITY) + push;
            let torque = motors + Vector3::new(c.moment[0] * air.y, -c.moment[1] * air.x, 0.0);
            let turning = (torque - w.cross(&inertia.component_mul(w))).component_div(&inertia);
            (acceleration, turning, felt)
        };
        let turned = |q: &UnitQuaternion<f64>, w: &Vector3<f64>, h: f64| q * UnitQuaternion::from_scaled_axis(w * h);
        // Midpoint rule: at half a millisecond the error is far below all that is asserted.
        let (a, b, _) = rates(&self.v, &self.q, &self.w);
        let h = 0.5 * STEP_S;
        let (v, w, q) = (self.v + a * h, self.w + b * h, turned(&self.q, &self.w, h));
        let (a, b, felt) = rates(&v, &q, &w);
        self.p += v * STEP_S;
        self.v += a * STEP_S;
        self.q = UnitQuaternion::new_normalize(*turned(&self.q, &w, STEP_S));
        self.w += b * STEP_S;
        self.felt = felt;
        if self.on_ground && self.p.z <= 0.0 && self.v.z <= 0.0 {
            self.p.z = 0.0;
            self.v.z = 0.0;
            // Rubber feet: it tilts and slides as little as friction allows.
            let slide = (self.v.x.powi(2) + self.v.y.powi(2)).sqrt();
            let grip = 0.5 * (GRAVITY - thrust).max(0.0) * STEP_S;
            self.v *= if slide > grip { 1.0 - grip / slide } else { 0.0 };
            self.w = Vector3::zeros();
            self.q = UnitQuaternion::identity();
            self.felt = Vector3::new(0.0, 0.0, thrust.max(GRAVITY));
        }
    }
}
