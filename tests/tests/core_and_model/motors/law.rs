//! The actuator-aware law by itself: its formula in f64, its two forms of the gain, its memory, its refusals.

use nalgebra::{DMatrix, DVector, Vector4};
use quatrack::error::{Field, StateError, StepError};
use quatrack::nalgebra::Vector3;
use quatrack::{
    Actuation, ActuatorAware, ActuatorAwareGain, Airframe, Controller, Limits, Memory, MotorReference, MotorStep,
    Quaternion, Rate, RigidState,
};
use quatrack_design::design::actuator_aware::{ActuatorAwareWeights, actuator_aware};
use quatrack_design::design::codegen::rounded;
use quatrack_simulation::vehicles;

use super::{CRAFT, Eight, measured, on};

pub(crate) const RATE_HZ: u32 = 500;

/// The gain for a vehicle whose motors have a lag, as the core flies it.
pub(crate) fn designed(name: &str, lag_s: f64) -> ActuatorAwareGain {
    let vehicle = vehicles::by_name(name).unwrap();
    let design = actuator_aware(&vehicle, lag_s, &ActuatorAwareWeights::STANDARD, 1.0 / f64::from(RATE_HZ)).unwrap();
    ActuatorAwareGain::new(rounded(&design.gain.fixed_resize::<4, 19>(0.0))).unwrap()
}

pub(crate) fn actuation(airframe: &Airframe) -> Actuation {
    Actuation::new(airframe, Rate::from_hz(RATE_HZ).unwrap()).unwrap()
}

pub(crate) fn controller<'a>(gain: &'a ActuatorAwareGain, actuation: &'a Actuation) -> Controller<'a> {
    Controller::new(ActuatorAware::new(gain, actuation), Limits::NONE)
}

/// A gain without any structure: every entry moved a little, each by another amount.
fn without_structure(gain: &ActuatorAwareGain) -> ActuatorAwareGain {
    let mut rows = *gain.gain().rows();
    for (k, entry) in rows.as_flattened_mut().iter_mut().enumerate() {
        *entry += 1e-3 * (k as f32 * 0.7).sin();
    }
    ActuatorAwareGain::new(rows).unwrap()
}

/// The law in f64, before saturation.
fn formula(gain: &ActuatorAwareGain, memory: &Memory, x: &RigidState, reference: &MotorReference) -> Vector4<f64> {
    let goal = on(reference);
    let to_f64 = |v: Vector3<f32>| v.map(f64::from);
    let (sin, cos) = {
        let (cos, sin) = reference.reference().heading().cos_sin();
        (f64::from(sin), f64::from(cos))
    };
    let turned = |v: Vector3<f64>| Vector3::new(cos * v.x + sin * v.y, cos * v.y - sin * v.x, v.z);
    let q = x.state.attitude;
    let [w, i, j, k] = [q.w, q.x, q.y, q.z].map(f64::from);
    let attitude = goal.attitude.inverse().into_inner() * nalgebra::Quaternion::new(w, i, j, k);
    let rotation = attitude.imag() * (2.0 * attitude.w.signum());
    let forces = Vector4::from(memory.forces_n()).map(f64::from);
    let mut e = DVector::zeros(19);
    e.rows_mut(0, 3).copy_from(&turned(to_f64(x.state.position_m) - goal.position_m));
    e.rows_mut(3, 3).copy_from(&turned(to_f64(x.state.velocity_m_s) - goal.velocity_m_s));
    e.rows_mut(6, 3).copy_from(&rotation);
    e.rows_mut(9, 3).copy_from(&(to_f64(x.body_rates_rad_s) - goal.body_rates_rad_s));
    e.rows_mut(12, 4).copy_from(&(forces - goal.thrusts_n));
    e.rows_mut(16, 3).copy_from(&turned(to_f64(memory.integral_m_s())));
    let k = DMatrix::from_fn(4, 19, |row, column| f64::from(gain.gain().rows()[row][column]));
    Vector4::from(reference.commands_n()).map(f64::from) - (k * e).fixed_rows::<4>(0)
}

/// States near a reference: no motor is cut.
fn near(reference: &MotorReference, case: u32) -> RigidState {
    let u = quatrack_tests::halton::<12>(case).map(|v| (2.0 * v - 1.0) as f32);
    let mut x = measured(&on(reference));
    x.state.position_m += Vector3::new(u[0], u[1], u[2]) * 0.01;
    x.state.velocity_m_s += Vector3::new(u[3], u[4], u[5]) * 0.02;
    x.body_rates_rad_s += Vector3::new(u[6], u[7], u[8]) * 0.1;
    let tilt = Quaternion::new(1.0, 0.01 * u[9], 0.01 * u[10], 0.01 * u[11]);
    x.state.attitude = x.state.attitude * tilt;
    x
}

#[test]
fn designed_gains_fall_apart_for_every_craft() {
    for (name, airframe) in CRAFT {
        let lag_s = f64::from(airframe.figures().motor_lag_s);
        let gain = designed(name, lag_s);
        assert!(gain.is_decoupled(), "{name}");
        assert!(!without_structure(&gain).is_decoupled());
        // One entry out of its pattern is enough, wherever it is.
        for k in (0..76).step_by(5) {
            let mut rows = *gain.gain().rows();
            rows[k / 19][k % 19] += 1e-3;
            assert!(!ActuatorAwareGain::new(rows).unwrap().is_decoupled(), "{name}: entry {k}");
        }
    }
}

#[test]
fn both_forms_of_the_gain_compute_the_formula() {
    let airframe = Airframe::CRAZYFLIE_2_1;
    let decoupled = designed("crazyflie-2.1", 0.126);
    for gain in [decoupled, without_structure(&decoupled)] {
        let actuation = actuation(&airframe);
        let controller = controller(&gain, &actuation);
        let mut memory = Memory::hovering(&airframe);
        for case in 0..500 {
            let reference = Eight::TURNING.reference(0.02 * f64::from(case), &airframe);
            let x = near(&reference, case);
            let exact = formula(&gain, &memory, &x, &reference);
            let MotorStep { forces_n, .. } =
                controller.step_to_motors(&mut memory, (&x).into(), (&reference).into()).unwrap();
            let cut = exact.map(|u| u.max(f64::from(0.012_817_578_f32)).min(f64::from(0.12_f32)));
            // Nineteen products of up to 0.1 N, each rounded; positions and reference are given to 6e-8 of 1 m.
            let error = (Vector4::from(forces_n).map(f64::from) - cut).amax();
            assert!(error < 4e-7, "case {case}: {error} N");
        }
        // The flight was not one of cuts alone, nor of none.
        assert!(memory.integral_m_s().norm() > 0.0);
    }
}

#[test]
fn memory_predicts_the_motors_and_the_integral_holds_while_one_is_cut() {
    let airframe = Airframe::CRAZYFLIE_2_1;
    let gain = designed("crazyflie-2.1", 0.126);
    let actuation = actuation(&airframe);
    let controller = controller(&gain, &actuation);
    let reference = MotorReference::hover(Vector3::new(0.0, 0.0, 1.0), 0.5, &airframe).unwrap();
    let mut memory = Memory::hovering(&airframe);
    let mut x = measured(&on(&reference));
    x.state.position_m += Vector3::new(1e-3, -2e-3, 3e-3);
    let before = memory;
    let step = controller.step_to_motors(&mut memory, (&x).into(), (&reference).into()).unwrap();
    assert!(!step.limited.any());
    // i+ = i + h r, in the world frame.
    assert!((memory.integral_m_s() - Vector3::new(2e-6, -4e-6, 6e-6)).amax() < 1e-9);
    let decay = (-0.002_f64 / 0.126).exp();
    for ((after, before), u) in memory.forces_n().iter().zip(before.forces_n()).zip(step.forces_n) {
        let exact = f64::from(u) + (f64::from(before) - f64::from(u)) * decay;
        assert!((f64::from(*after) - exact).abs() < 1e-8, "{after} {exact}");
    }
    x.state.position_m.x += 1.0;
    let held = memory;
    let step = controller.step_to_motors(&mut memory, (&x).into(), (&reference).into()).unwrap();
    assert!(step.limited.motors());
    let ends = [airframe.figures().force_min_n, airframe.figures().force_max_n];
    assert!(step.forces_n.iter().any(|force| ends.contains(force)), "{:?}", step.forces_n);
    assert_eq!(memory.integral_m_s(), held.integral_m_s());
    assert_ne!(memory.forces_n(), held.forces_n());
}

#[test]
fn either_sign_of_the_quaternion_gives_the_same_forces() {
    let airframe = Airframe::CRAZYFLIE_2_1;
    let gain = designed("crazyflie-2.1", 0.126);
    let actuation = actuation(&airframe);
    let controller = controller(&gain, &actuation);
    for case in 0..200 {
        let reference = Eight::TURNING.reference(0.05 * f64::from(case), &airframe);
        let x = near(&reference, case);
        let mut flipped = x;
        flipped.state.attitude = -x.state.attitude;
        let memory = Memory::hovering(&airframe);
        let (mut a, mut b) = (memory, memory);
        assert_eq!(
            controller.step_to_motors(&mut a, (&x).into(), (&reference).into()),
            controller.step_to_motors(&mut b, (&flipped).into(), (&reference).into())
        );
        assert_eq!(a, b);
    }
}

#[test]
fn inputs_that_are_not_finite_are_refused_by_name_and_leave_the_memory_alone() {
    let airframe = Airframe::CRAZYFLIE_2_1;
    let decoupled = designed("crazyflie-2.1", 0.126);
    let reference = MotorReference::hover(Vector3::new(0.0, 0.0, 1.0), 0.5, &airframe).unwrap();
    for gain in [decoupled, without_structure(&decoupled)] {
        let actuation = actuation(&airframe);
        let controller = controller(&gain, &actuation);
        for bad in [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for i in 0..13 {
                let mut x = measured(&on(&reference));
                let field = match i {
                    0..3 => {
                        x.state.position_m[i] = bad;
                        Field::Position
                    }
                    3..6 => {
                        x.state.velocity_m_s[i - 3] = bad;
                        Field::Velocity
                    }
                    6..9 => {
                        x.body_rates_rad_s[i - 6] = bad;
                        Field::BodyRates
                    }
                    _ => {
                        let q = &mut x.state.attitude;
                        *[&mut q.w, &mut q.x, &mut q.y, &mut q.z][i - 9] = bad;
                        Field::Attitude
                    }
                };
                let mut memory = Memory::hovering(&airframe);
                let refused = controller.step_to_motors(&mut memory, (&x).into(), (&reference).into()).unwrap_err();
                let StepError::State(StateError::NonFinite { field: found, value }) = refused else {
                    panic!("{refused:?}")
                };
                assert_eq!((found, value.to_bits()), (field, bad.to_bits()), "input {i}");
                assert_eq!(memory, Memory::hovering(&airframe));
            }
        }
        let mut x = measured(&on(&reference));
        x.state.attitude = Quaternion::new(1.1, 0.0, 0.0, 0.0);
        let mut memory = Memory::hovering(&airframe);
        let refused = controller.step_to_motors(&mut memory, (&x).into(), (&reference).into());
        assert!(matches!(refused, Err(StepError::State(StateError::QuaternionNorm { .. }))));
    }
}
