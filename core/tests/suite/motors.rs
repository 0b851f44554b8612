//! The way to the motors against its f64 twin: rate loop and mixer, the actuator-aware law; the memory, and
//! refusals.

use nalgebra::{Rotation3, SMatrix, SVector, Vector4};
use quatrack::gains::paper;
use quatrack::nalgebra::Vector3;
use quatrack::{
    Actuation, ActuatorAware, ActuatorAwareGain, Airframe, Controller, Equilibrium, FeedForward, FifthOrderSample,
    FlatOutput, FlatSample, IntegralAction, Law, Limits, Measured, Memory, MotorLimited, MotorReference, Output, Rate,
    Reference, RigidState, State, StateError, StepError, Target,
};
use quatrack_tests::cases::{case, spread};
use quatrack_tests::halton;

use crate::twin::{self, craft, goal};

const AIRFRAMES: [Airframe; 3] =
    [Airframe::CRAZYFLIE_2_1, Airframe::CRAZYFLIE_2_1_UPGRADE_KIT, Airframe::CRAZYFLIE_2_1_BRUSHLESS];
const PERIOD_S: f64 = 0.002;

fn rate() -> Rate {
    Rate::from_hz(500).unwrap()
}

/// Forces after a period under held commands, from the exact solution of `f' = (u - f) / tau`.
fn behind_lag(forces_n: [f32; 4], commands_n: [f32; 4], lag_s: f32) -> Vector4<f64> {
    let (f, u) = (Vector4::from(forces_n).map(f64::from), Vector4::from(commands_n).map(f64::from));
    u + (f - u) * (-PERIOD_S / f64::from(lag_s)).exp()
}

fn forces(forces_n: [f32; 4]) -> Vector4<f64> {
    Vector4::from(forces_n).map(f64::from)
}

#[test]
fn a_command_comes_out_as_the_forces_whose_wrench_it_asks_for() {
    let mut within = 0;
    for airframe in AIRFRAMES {
        let figures = airframe.figures();
        let actuation = Actuation::new(&airframe, rate()).unwrap();
        let controller = Controller::new(Equilibrium::new(&paper::LQR_E), Limits::NONE).with_actuation(&actuation);
        let mixing = twin::wrench_of_forces(figures);
        let inverse = mixing.try_inverse().unwrap();
        for index in 0..1000 {
            let u = halton::<7>(index);
            let case = case(index, 3.0);
            let vector =
                |at: usize, size| Vector3::new(spread(u[at], size), spread(u[at + 1], size), spread(u[at + 2], size));
            let (asked, rates) = (vector(0, 2.0), vector(3, 2.0));
            let command = quatrack::Command { thrust_m_s2: 9.81 + spread(u[6], 2.0), body_rates_rad_s: asked };
            let step = quatrack::Step { command, limited: quatrack::Limited::from_bits(0b0101) };
            // The fastest loop behind the lag: 1 / (2 tau).
            let bandwidth = 0.5 / f64::from(figures.motor_lag_s);
            let torque = twin::torque(figures, bandwidth, &twin::wide(&asked), &twin::wide(&rates));
            let thrust = f64::from(figures.mass_kg) * f64::from(command.thrust_m_s2);
            let exact = inverse * Vector4::new(thrust, torque.x, torque.y, torque.z);

            let before = [0.05, 0.06, 0.07, 0.08];
            let mut memory = Memory::new(before).unwrap();
            let measured = Measured::new(&case.state).with_body_rates(&rates);
            let found = controller.carry(&mut memory, &Output::Command(step), measured).unwrap();
            assert_eq!(found.limited.command().bits(), 0b0101, "an earlier cut is reported");
            let (min, max) = (f64::from(figures.force_min_n), f64::from(figures.force_max_n));
            if exact.iter().all(|force| (min..=max).contains(force)) {
                within += 1;
                // A dozen roundings of forces up to 0.2 N.
                assert!((forces(found.forces_n) - exact).amax() < 2e-7, "{found:?}, not {exact}");
                assert_eq!(found.limited, MotorLimited::of_command(step.limited));
                let wrench = actuation.wrench(&command, &rates).unwrap();
                assert!((twin::wide(&wrench.torque_n_m) - torque).amax() < 1e-9);
                let back = airframe.wrench(&found.forces_n);
                let exact = mixing * forces(found.forces_n);
                let back = [back.thrust_n, back.torque_n_m.x, back.torque_n_m.y, back.torque_n_m.z];
                assert!((Vector4::from(back).map(f64::from) - exact).amax() < 1e-7);
            }
            let lagged = behind_lag(before, found.forces_n, figures.motor_lag_s);
            assert!((forces(memory.forces_n()) - lagged).amax() < 4e-8, "the motors are predicted");
        }
    }
    assert!(within > 1000, "{within} of 3000 within the motors' range");
}

/// An answer to every error, by the parts of the four forces that a hovering X separates into.
fn decoupled() -> ActuatorAwareGain {
    const SIGNS: [[f32; 4]; 4] = [[1.0; 4], [-1.0, -1.0, 1.0, 1.0], [-1.0, 1.0, 1.0, -1.0], [-1.0, 1.0, -1.0, 1.0]];
    let [thrust, roll, pitch, yaw] = SIGNS;
    ActuatorAwareGain::new(std::array::from_fn(|m| {
        let between = |n: usize| {
            SIGNS.iter().zip([0.1, 0.08, 0.07, 0.05]).fold(0.0, |sum, (signs, size)| sum + signs[m] * signs[n] * size)
        };
        let (t, r, p, y) = (thrust[m], roll[m], pitch[m], yaw[m]);
        [
            0.11 * p,
            -0.12 * r,
            0.4 * t,
            0.13 * p,
            -0.14 * r,
            0.2 * t,
            0.15 * r,
            0.16 * p,
            0.02 * y,
            0.011 * r,
            0.012 * p,
            0.013 * y,
            between(0),
            between(1),
            between(2),
            between(3),
            0.2 * p,
            -0.21 * r,
            0.3 * t,
        ]
    }))
    .unwrap()
}

/// Every entry moved by another amount.
fn without_structure() -> ActuatorAwareGain {
    let mut rows = *decoupled().gain().rows();
    for (k, entry) in rows.as_flattened_mut().iter_mut().enumerate() {
        *entry += spread(halton::<1>(k as u32)[0], 0.01);
    }
    ActuatorAwareGain::new(rows).unwrap()
}

#[test]
fn only_a_gain_of_four_separate_parts_is_flown_as_one() {
    assert!(decoupled().is_decoupled());
    assert!(!without_structure().is_decoupled());
    for k in 0..76 {
        let mut rows = *decoupled().gain().rows();
        rows[k / 19][k % 19] += 1e-3;
        assert!(!ActuatorAwareGain::new(rows).unwrap().is_decoupled(), "entry {k}");
    }
}

#[test]
fn the_actuator_aware_law_is_its_formula_in_both_forms() {
    let airframe = Airframe::CRAZYFLIE_2_1;
    let figures = airframe.figures();
    let actuation = Actuation::new(&airframe, rate()).unwrap();
    let (min, max) = (f64::from(figures.force_min_n), f64::from(figures.force_max_n));
    let (mut cuts, mut free) = (0, 0);
    for gain in [decoupled(), without_structure()] {
        let k = twin::matrix(gain.gain().rows());
        let controller = Controller::new(ActuatorAware::new(&gain, &actuation), Limits::NONE);
        let mut memory = Memory::hovering(&airframe);
        let mut sum = Vector3::zeros();
        for index in 0..500 {
            let case = case(index, 3.0);
            let sample = FlatSample {
                acceleration_m_s2: case.sample.acceleration_m_s2 * 0.25,
                jerk_m_s3: case.sample.jerk_m_s3 * 0.05,
                heading_rate_rad_s: case.sample.heading_rate_rad_s * 0.25,
                ..case.sample
            };
            let reference = MotorReference::from_flat(&FifthOrderSample::of_jerk(sample), &airframe).unwrap();
            let (target, u) = (reference.reference(), halton::<12>(index));
            // A tenth of the case's deviation, and body rates 0.5 rad/s off.
            let deviation = (case.state.position_m - case.sample.position_m) * 0.1;
            let state = State {
                position_m: sample.position_m + deviation,
                velocity_m_s: sample.velocity_m_s + (case.state.velocity_m_s - case.sample.velocity_m_s) * 0.1,
                attitude: {
                    let turn = [9, 10, 11].map(|i| spread(u[i], 0.05));
                    let q = target.state().attitude * quatrack::Quaternion::new(1.0, turn[0], turn[1], turn[2]);
                    let q = craft(&State { attitude: q, ..case.state }).attitude.into_inner();
                    let sign = if index % 2 == 0 { 1.0 } else { -1.0 };
                    let [w, x, y, z] = [q.w, q.i, q.j, q.k].map(|q| (sign * q) as f32);
                    quatrack::Quaternion::new(w, x, y, z)
                },
            };
            let off = Vector3::new(spread(u[6], 0.5), spread(u[7], 0.5), spread(u[8], 0.5));
            let x = RigidState { state, body_rates_rad_s: target.input().body_rates_rad_s + off };

            let on = goal(&sample);
            let e = twin::heading_error(&craft(&state), &on);
            let to_heading = Rotation3::from_axis_angle(&Vector3::z_axis(), -on.heading_rad);
            let rates = twin::wide(&x.body_rates_rad_s) - on.input.fixed_rows::<3>(1);
            let motors = forces(memory.forces_n()) - forces(reference.forces_n());
            let i = to_heading * sum;
            let mut errors = SVector::<f64, 19>::zeros();
            errors.fixed_rows_mut::<3>(0).copy_from(&e.fixed_rows::<3>(0));
            errors.fixed_rows_mut::<3>(3).copy_from(&e.fixed_rows::<3>(6));
            // The rotation vector of a small turn is twice the vector part of its quaternion.
            errors.fixed_rows_mut::<3>(6).copy_from(&(e.fixed_rows::<3>(3) * 2.0));
            errors.fixed_rows_mut::<3>(9).copy_from(&rates);
            errors.fixed_rows_mut::<4>(12).copy_from(&motors);
            errors.fixed_rows_mut::<3>(16).copy_from(&i);
            let k: &SMatrix<f64, 4, 19> = &k;
            let asked = forces(reference.commands_n()) - k * errors;

            let before = memory.forces_n();
            let step = controller.step_to_motors(&mut memory, (&x).into(), (&reference).into()).unwrap();
            // Nineteen products of up to 0.1 N, each rounded to 6e-8 of itself; attitudes to 2e-6 at most, of 0.3 N.
            let error = (forces(step.forces_n) - asked.map(|u| u.clamp(min, max))).amax();
            assert!(error < 1e-6, "case {index}: {error} N");
            let cut = asked.iter().any(|u| !(min..=max).contains(u));
            assert_eq!((step.limited.motors(), step.limited.any()), (cut, cut));
            let lagged = behind_lag(before, step.forces_n, figures.motor_lag_s);
            assert!((forces(memory.forces_n()) - lagged).amax() < 4e-8);
            if cut {
                cuts += 1;
            } else {
                free += 1;
                sum += (twin::wide(&state.position_m) - twin::wide(&sample.position_m)) * PERIOD_S;
            }
            // Each addition is rounded to 6e-8 of some millimetre seconds.
            assert!((twin::wide(&memory.integral_m_s()) - sum).amax() < 1e-7, "it holds while a motor is cut");
        }
    }
    assert!(cuts > 50 && free > 500, "{cuts} steps with a cut, {free} without");
}

#[test]
fn a_law_without_an_input_is_refused_by_its_name_and_remembers_nothing_of_it() {
    let airframe = Airframe::CRAZYFLIE_2_1;
    let actuation = Actuation::new(&airframe, rate()).unwrap();
    let gain = decoupled();
    let (state, still) = (State::at_rest(Vector3::new(0.01, 0.0, 1.0)), Vector3::zeros());
    let (bare, whole) = (Measured::new(&state), Measured::new(&state).with_body_rates(&still));
    let motors = MotorReference::hover(Vector3::new(0.0, 0.0, 1.0), 0.0, &airframe).unwrap();
    let reference = *motors.reference();
    let to_forces = Controller::new(ActuatorAware::new(&gain, &actuation), Limits::NONE);
    let to_rates = Controller::new(Equilibrium::new(&paper::LQR_E), Limits::NONE);
    let carried = to_rates.with_actuation(&actuation);
    let cases = [
        (&to_forces, bare, Target::with_forces(&motors), StepError::NoBodyRates),
        (&to_forces, whole, Target::new(&reference), StepError::NoForces),
        (&to_rates, whole, Target::new(&reference), StepError::NoActuation),
        (&carried, bare, Target::new(&reference), StepError::NoBodyRates),
    ];
    let before = Memory::hovering(&airframe);
    for (controller, measured, target, error) in cases {
        let mut memory = before;
        assert_eq!(controller.step_to_motors(&mut memory, measured, target), Err(error));
        assert_eq!(memory, before);
    }
    // A rate that is NaN is named on either way; one so large that the torque is none is told as that.
    for controller in [&to_forces, &carried] {
        let turned = Vector3::new(0.0, f32::NAN, 0.0);
        let measured = Measured::new(&state).with_body_rates(&turned);
        let mut memory = before;
        let refused = controller.step_to_motors(&mut memory, measured, Target::with_forces(&motors));
        assert!(matches!(refused, Err(StepError::State(StateError::NonFinite { .. }))), "{refused:?}");
        assert_eq!(memory, before);
    }
    let command = quatrack::Command { thrust_m_s2: 9.81, body_rates_rad_s: Vector3::zeros() };
    let spinning = Vector3::new(1e30, 1e30, 0.0);
    assert_eq!(actuation.wrench(&command, &spinning), Err(StepError::Singular));
    assert!(matches!(actuation.wrench(&command, &Vector3::new(0.0, 0.0, f32::NAN)), Err(StepError::State(_))));
}

#[test]
fn a_law_of_forces_keeps_its_own_actuation_and_each_law_tells_its_output() {
    let [own, other] = AIRFRAMES.map(|airframe| Actuation::new(&airframe, rate()).unwrap())[..2] else {
        unreachable!("there are three")
    };
    let gain = decoupled();
    let to_forces = Controller::new(ActuatorAware::new(&gain, &own), Limits::NONE);
    assert_eq!(to_forces.with_actuation(&other).actuation(), Some(&own));
    let to_rates = Controller::new(Equilibrium::new(&paper::LQR_E), Limits::NONE);
    assert_eq!(to_rates.actuation(), None);
    assert_eq!(to_rates.with_actuation(&own).with_actuation(&other).actuation(), Some(&other));

    let mut rows = [[0.0; 12]; 4];
    for (row, gains) in rows.iter_mut().zip(paper::LQR_E.gain().rows()) {
        row[..9].copy_from_slice(gains);
        row[9..].fill(1.0);
    }
    let integral = quatrack::law::IntegralGain::new(rows).unwrap();
    let laws: [(Law<'_>, bool, bool); 4] = [
        (Equilibrium::new(&paper::LQR_E).into(), false, false),
        (FlatOutput::new(&paper::LQR_F).into(), false, false),
        (IntegralAction::new(&integral, rate(), FeedForward::Without).into(), false, true),
        (ActuatorAware::new(&gain, &own).into(), true, true),
    ];
    for (law, follows_forces, integrates) in laws {
        assert_eq!((law.follows_forces(), law.integrates()), (follows_forces, integrates), "{law:?}");
    }
}

#[test]
fn remembered_motor_forces_are_as_told() {
    let airframe = Airframe::CRAZYFLIE_2_1;
    for bad in [f32::NAN, f32::INFINITY] {
        for motor in 0..4 {
            let mut forces_n = [0.05; 4];
            forces_n[motor] = bad;
            assert_eq!(Memory::new(forces_n), None);
        }
    }
    let mut memory = Memory::new([0.01, 0.02, 0.03, 0.04]).unwrap();
    memory.run_down(0.5);
    assert_eq!(memory.forces_n(), [0.005, 0.01, 0.015, 0.02]);
    memory.assume_hovering(&airframe);
    // A quarter of 29 g.
    assert!(memory.forces_n().iter().all(|force| (force - 0.25 * 0.029 * 9.81).abs() < 1e-8));
    assert_eq!(memory, Memory::hovering(&airframe));
    assert_eq!(Memory::default(), Memory::new([0.0; 4]).unwrap());

    // LQI over a step of 2 ms at 1 m.
    let mut rows = [[0.0; 12]; 4];
    for (row, gains) in rows.iter_mut().zip(paper::LQR_E.gain().rows()) {
        row[..9].copy_from_slice(gains);
        row[9..].fill(1.0);
    }
    let gain = quatrack::law::IntegralGain::new(rows).unwrap();
    let lqi = Controller::new(IntegralAction::new(&gain, rate(), FeedForward::Without), Limits::NONE);
    let reference = Reference::hover(Vector3::zeros(), 0.0).unwrap();
    let state = State::at_rest(Vector3::new(1.0, 0.0, 0.0));
    lqi.step(&mut memory, (&state).into(), (&reference).into()).unwrap();
    assert_eq!(memory.integral_m_s(), Vector3::new(0.002, 0.0, 0.0));
    memory.clear_integral();
    assert_eq!(memory, Memory::hovering(&airframe));
}

#[test]
fn every_cut_is_told_apart() {
    type Reader = fn(MotorLimited) -> bool;
    let readers: [(u16, Reader); 4] =
        [(1, MotorLimited::thrust), (2, MotorLimited::attitude), (4, MotorLimited::yaw), (8, MotorLimited::motors)];
    for bits in 0..=u16::MAX {
        let limited = MotorLimited::from(bits);
        assert_eq!(limited.bits(), bits & 0x0F0F, "unknown bits are dropped");
        assert_eq!(u16::from(limited), limited.bits());
        assert_eq!(limited.any(), limited.bits() != 0);
        assert_eq!(u16::from(limited.command().bits()), (bits >> 8) & 15);
        for (bit, reads) in readers {
            assert_eq!(reads(limited), bits & bit != 0);
        }
    }
    let cut = quatrack::Limited::from_bits(0b1010);
    assert_eq!(MotorLimited::of_command(cut).bits(), 0x0A00);
}
