//! The `f32` core down to the motors in the loop: a course and a law in; the craft's commands, step by step, out.
//!
//! As in [`super::core_loop`], states go in rounded, as from an estimator, and commands come out exactly.

use nalgebra::{Quaternion, UnitQuaternion, Vector3, Vector4};
use quatrack::airframe::{AirframeError, AirframeFigures};
use quatrack::{
    Airframe, Controller, FifthOrderSample, FlatSample, Memory, MotorReference, Rate, ReferenceError, State,
};
use quatrack_design::vehicle::Vehicle;
use quatrack_plan::trajectory::fifth_order::FifthOrder;

use super::rigid_loop::MotorCommand;
use crate::plant::RigidState;

/// Control rate of these flights: 500 Hz.
pub const RATE: Rate = Rate::from_hz(500).expect("in range");
/// Control steps in 10 ms at that rate.
pub const STEPS_A_SAMPLE: u32 = 5;
/// Control period at that rate, s.
pub const PERIOD_S: f64 = 0.002;

/// The number of the control step at a time of one, s.
pub fn step_at(time_s: f64) -> usize {
    // By way of u32: the processor has no conversion to an unsigned number of 64 bits.
    (time_s / PERIOD_S + 0.5) as u32 as usize
}

fn vector(v: &Vector3<f64>) -> Vector3<f32> {
    v.map(|value| value as f32)
}

fn wide(v: &Vector3<f32>) -> Vector3<f64> {
    v.map(f64::from)
}

/// A vehicle as the core takes it at [`RATE`], with motors of some lag. Off-diagonal inertia is left out.
///
/// # Errors
/// [`AirframeError`] for figures beyond the core's range.
pub fn airframe(vehicle: &Vehicle, motor_lag_s: f64) -> Result<Airframe, AirframeError> {
    let (inertia, motors) = (vehicle.inertia_kg_m2(), vehicle.motors());
    let airframe = Airframe::new(AirframeFigures {
        mass_kg: vehicle.mass_kg() as f32,
        inertia_kg_m2: [inertia.m11, inertia.m22, inertia.m33].map(|value| value as f32),
        lever_arm_m: motors.half_arm_m() as f32,
        torque_per_thrust_m: motors.torque_per_thrust_m as f32,
        force_min_n: motors.thrust_min_n as f32,
        force_max_n: motors.thrust_max_n as f32,
        motor_lag_s: motor_lag_s as f32,
    })?;
    Ok(airframe.commanded_at(RATE))
}

/// A point of a course as the core takes it.
pub fn sample(point: &FifthOrder) -> FifthOrderSample {
    let [r, v, a, j, snap, crackle] = &point.position;
    let [psi, rate, acceleration, jerk] = point.heading.map(|value| value as f32);
    FifthOrderSample {
        flat: FlatSample {
            position_m: vector(r),
            velocity_m_s: vector(v),
            acceleration_m_s2: vector(a),
            jerk_m_s3: vector(j),
            heading_rad: psi,
            heading_rate_rad_s: rate,
        },
        snap_m_s4: vector(snap),
        crackle_m_s5: vector(crackle),
        heading_acceleration_rad_s2: acceleration,
        heading_jerk_rad_s3: jerk,
    }
}

/// The state that flies a point of a course exactly.
///
/// # Errors
/// [`ReferenceError`] where the flat map has no answer.
pub fn state_on(point: &FifthOrder, airframe: &Airframe) -> Result<RigidState, ReferenceError> {
    let reference = MotorReference::from_flat(&sample(point), airframe)?;
    let q = reference.state().attitude;
    let [w, x, y, z] = [q.w, q.x, q.y, q.z].map(f64::from);
    Ok(RigidState {
        position_m: point.position[0],
        velocity_m_s: point.position[1],
        attitude: UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)),
        body_rates_rad_s: wide(&reference.body_rates_rad_s()),
        thrusts_n: Vector4::from(reference.forces_n().map(f64::from)),
    })
}

/// A controller with its memory.
pub struct MotorLoop<'a> {
    controller: Controller<'a>,
    airframe: Airframe,
    memory: Memory,
}

impl<'a> MotorLoop<'a> {
    /// A loop whose motors start with the given thrusts, N; nothing where one of them is not finite.
    pub fn new(controller: Controller<'a>, airframe: &Airframe, thrusts_n: &Vector4<f64>) -> Option<Self> {
        let memory = Memory::new(std::array::from_fn(|i| thrusts_n[i] as f32))?;
        Some(Self { controller, airframe: *airframe, memory })
    }

    /// One control step towards a point of a course.
    ///
    /// # Errors
    /// The core's own words, where it gives no command.
    pub fn step(&mut self, measured: &RigidState, point: &FifthOrder) -> Result<MotorCommand, String> {
        let reference = MotorReference::from_flat(&sample(point), &self.airframe).map_err(|e| e.to_string())?;
        let q = measured.attitude.quaternion();
        let [w, x, y, z] = [q.w, q.i, q.j, q.k].map(|value| value as f32);
        let state = State {
            position_m: vector(&measured.position_m),
            attitude: quatrack::Quaternion::new(w, x, y, z),
            velocity_m_s: vector(&measured.velocity_m_s),
        };
        let state = quatrack::RigidState { state, body_rates_rad_s: vector(&measured.body_rates_rad_s) };
        let step = self
            .controller
            .step_to_motors(&mut self.memory, (&state).into(), (&reference).into())
            .map_err(|error| error.to_string())?;
        Ok(MotorCommand { forces_n: Vector4::from(step.forces_n.map(f64::from)), limited: step.limited.any() })
    }
}
