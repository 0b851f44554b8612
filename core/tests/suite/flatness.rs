//! The core's flat map against itself and against the f64 one: round trips, both charts, the singularities.

use proptest::prelude::*;
use quatrack::error::ReferenceError;
use quatrack::flatness::{phi, phi_at_heading, phi_inverse};
use quatrack::gains::paper;
use quatrack::nalgebra::Vector3;
use quatrack::{
    Airframe, Controller, Equilibrium, FifthOrderSample, FlatOutput, FlatSample, Heading, Limits, MotorReference,
    Reference, State,
};
use quatrack_design::model::flat::reference_point;
use quatrack_tests::core_step::step;

/// Accelerations with a tilt of at most about 80 degrees and a thrust from a third of hover on.
fn acceleration() -> impl Strategy<Value = Vector3<f32>> {
    (-15.0_f32..15.0, -15.0_f32..15.0, -6.0_f32..10.0).prop_map(|(x, y, z)| Vector3::new(x, y, z))
}

fn jerk() -> impl Strategy<Value = Vector3<f32>> {
    (-40.0_f32..40.0, -40.0_f32..40.0, -40.0_f32..40.0).prop_map(|(x, y, z)| Vector3::new(x, y, z))
}

/// f32 rounding through some twenty operations on numbers of the size of `scale`.
fn close(a: f32, b: f32, scale: f32) -> bool {
    (a - b).abs() <= 40.0 * f32::EPSILON * scale
}

proptest! {
    #[test]
    fn the_inverse_of_phi_undoes_it(a in acceleration(), j in jerk(), share in -0.9_f32..0.9, q3_rate in -5.0_f32..5.0) {
        let thrust = (a + Vector3::new(0.0, 0.0, 9.81)).norm();
        let n = (a + Vector3::new(0.0, 0.0, 9.81)) / thrust;
        let q3 = share * (0.5 * (1.0 + n.z)).sqrt();
        let mapped = phi(a, j, q3, q3_rate).unwrap();
        prop_assert!(close(mapped.attitude.dot(mapped.attitude), 1.0, 1.0));
        let back = phi_inverse(mapped.attitude, &mapped.input, n.dot(&j));
        prop_assert!((back.acceleration_m_s2 - a).amax() <= 40.0 * f32::EPSILON * thrust.max(9.81));
        prop_assert!(close(back.q3, q3, 1.0));
        // The rates are divided by thrust and by q0 > 0.1 on the way.
        let scale = 10.0 * (j.norm() + q3_rate.abs() * thrust) / thrust.min(1.0);
        prop_assert!((back.jerk_m_s3 - j).amax() <= 40.0 * f32::EPSILON * scale);
        prop_assert!(close(back.q3_rate_1_s, q3_rate, scale));
    }

    #[test]
    fn both_charts_give_the_same_attitude_and_rates(a in acceleration(), j in jerk(), psi in -2.5_f32..2.5, rate in -3.0_f32..3.0) {
        let by_heading = phi_at_heading(a, j, Heading::from_angle(psi), rate).unwrap();
        let thrust = by_heading.input.thrust_m_s2;
        let n = by_heading.attitude.thrust_axis();
        let n_rate = (j - n * n.dot(&j)) / thrust;
        let root = (0.5 * (1.0 + n.z)).sqrt();
        // q3 = sqrt(s) sin(psi/2) and its time derivative, s' = n_z' / 2.
        let q3 = root * (0.5 * psi).sin();
        let q3_rate = n_rate.z / (4.0 * root) * (0.5 * psi).sin() + 0.5 * root * (0.5 * psi).cos() * rate;
        let by_q3 = phi(a, j, q3, q3_rate).unwrap();
        // Near psi = 2.5 rad q0 is 0.3 of its largest; the chart divides by it.
        prop_assert!((by_heading.attitude.dot(by_q3.attitude) - 1.0).abs() <= 1e-4);
        let difference = by_heading.input.body_rates_rad_s - by_q3.input.body_rates_rad_s;
        prop_assert!(difference.amax() <= 2e-4 * (1.0 + n_rate.norm() + rate.abs()), "{difference}");
    }

    #[test]
    fn the_reference_agrees_with_the_f64_flat_map(a in acceleration(), j in jerk(), psi in -9.0_f32..9.0, rate in -3.0_f32..3.0) {
        let sample = FlatSample {
            acceleration_m_s2: a,
            jerk_m_s3: j,
            heading_rate_rad_s: rate,
            ..FlatSample::at_rest(Vector3::new(0.1, -0.2, 0.3), psi)
        };
        let core = Reference::from_flat(&sample).unwrap();
        let model = reference_point(&quatrack_design::model::flat::FlatSample {
            position_m: sample.position_m.map(f64::from),
            velocity_m_s: sample.velocity_m_s.map(f64::from),
            acceleration_m_s2: a.map(f64::from),
            jerk_m_s3: j.map(f64::from),
            heading_rad: f64::from(psi),
            heading_rate_rad_s: f64::from(rate),
        });
        let q = core.state().attitude;
        for (found, exact) in [q.w, q.x, q.y, q.z].into_iter().zip(model.state.fixed_rows::<4>(3).iter()) {
            prop_assert!((f64::from(found) - exact).abs() <= 2e-6, "same sign, same attitude: {q:?}");
        }
        let thrust = f64::from(core.input().thrust_m_s2);
        prop_assert!((thrust - model.input[0]).abs() <= 1e-6 * model.input[0]);
        // Rates are of the size of jerk over thrust.
        let scale = 1.0 + f64::from(j.norm()) / thrust + f64::from(rate.abs());
        for (found, exact) in core.input().body_rates_rad_s.iter().zip(model.input.fixed_rows::<3>(1).iter()) {
            prop_assert!((f64::from(*found) - exact).abs() <= 5e-6 * scale);
        }
    }
}

proptest! {
    #[test]
    fn a_known_heading_gives_the_same_reference(a in acceleration(), j in jerk(), psi in -9.0_f32..9.0, rate in -3.0_f32..3.0) {
        let flat = FlatSample {
            acceleration_m_s2: a,
            jerk_m_s3: j,
            heading_rate_rad_s: rate,
            ..FlatSample::at_rest(Vector3::new(0.1, -0.2, 0.3), psi)
        };
        let unknown = FlatSample { heading_rad: 0.0, ..flat };
        let heading = Heading::from_angle(psi);
        let wanted = Reference::from_flat(&flat).unwrap();
        prop_assert_eq!(Reference::from_flat_at(&unknown, heading).unwrap(), wanted);
        let mut moved = Reference::hover(Vector3::zeros(), 1.0).unwrap();
        moved.move_to_finite_flat(&unknown, heading).unwrap();
        prop_assert_eq!(moved, wanted);
        let fifth = |flat| FifthOrderSample { snap_m_s4: j * 3.0, crackle_m_s5: a * 9.0, ..FifthOrderSample::of_jerk(flat) };
        let craft = Airframe::CRAZYFLIE_2_1;
        let wanted = MotorReference::from_flat(&fifth(flat), &craft).unwrap();
        prop_assert_eq!(MotorReference::from_flat_at(&fifth(unknown), heading, &craft).unwrap(), wanted);
    }
}

#[test]
fn a_reference_that_cannot_move_stays_and_one_that_is_not_finite_gives_no_command() {
    let hover = Reference::hover(Vector3::zeros(), 0.3).unwrap();
    let rest = FlatSample::at_rest(Vector3::zeros(), 0.0);
    let falling = FlatSample { acceleration_m_s2: Vector3::new(0.0, 0.0, -9.81), ..rest };
    let jerked = FlatSample { jerk_m_s3: Vector3::new(f32::INFINITY, 0.0, 0.0), ..rest };
    for bad in [falling, jerked] {
        let mut moved = hover;
        assert_eq!(moved.move_to_finite_flat(&bad, Heading::ZERO), Reference::from_flat(&bad).map(|_| ()));
        assert_eq!(moved, hover);
    }
    let state =
        State { position_m: Vector3::zeros(), attitude: hover.state().attitude, velocity_m_s: Vector3::zeros() };
    let laws = [
        Controller::new(Equilibrium::new(&paper::LQR_E), Limits::NONE),
        Controller::new(FlatOutput::new(&paper::LQR_F), Limits::NONE),
    ];
    for axis in 0..3 {
        for value in [f32::NAN, f32::INFINITY] {
            let mut far = rest;
            far.position_m[axis] = value;
            let mut fast = rest;
            fast.velocity_m_s[axis] = value;
            for (sample, law) in [far, fast].iter().flat_map(|sample| laws.iter().map(move |law| (sample, law))) {
                let mut moved = hover;
                moved.move_to_finite_flat(sample, Heading::ZERO).unwrap();
                assert!(step(law, &state, &moved).is_err(), "{sample:?}");
            }
        }
    }
}

#[test]
fn the_singularities_are_refused_by_name() {
    let at = |z: f32| FlatSample {
        acceleration_m_s2: Vector3::new(0.0, 0.0, z),
        ..FlatSample::at_rest(Vector3::zeros(), 0.0)
    };
    assert!(matches!(Reference::from_flat(&at(-9.81)), Err(ReferenceError::NoThrust { .. })));
    assert!(matches!(Reference::from_flat(&at(-9.75)), Err(ReferenceError::NoThrust { .. })));
    assert!(matches!(Reference::from_flat(&at(-20.0)), Err(ReferenceError::Inverted { .. })));
    let level = Vector3::zeros();
    assert!(matches!(phi(level, level, 1.0, 0.0), Err(ReferenceError::HeadingInfeasible { .. })));
    assert!(matches!(phi(level, level, 1.1, 0.0), Err(ReferenceError::HeadingInfeasible { .. })));
    for bad in [f32::NAN, f32::INFINITY] {
        let sample = FlatSample { heading_rate_rad_s: bad, ..at(0.0) };
        assert!(matches!(Reference::from_flat(&sample), Err(ReferenceError::NonFinite { .. })));
        let sample = FlatSample { velocity_m_s: Vector3::new(0.0, bad, 0.0), ..at(0.0) };
        assert!(matches!(Reference::from_flat(&sample), Err(ReferenceError::NonFinite { .. })));
        assert!(Reference::hover(Vector3::new(0.0, 0.0, bad), 0.0).is_err());
        assert!(Reference::hover(Vector3::zeros(), bad).is_err());
        assert!(Reference::from_flat(&at(bad)).is_err());
    }
}

#[test]
fn a_large_jerk_is_mapped_as_long_as_its_rates_are_numbers() {
    // Rates of 1e24 rad/s: their product is beyond f32, they are not.
    let jerk = Vector3::new(1e25, 1e25, 0.0);
    assert!(phi_at_heading(Vector3::zeros(), jerk, Heading::ZERO, 0.0).is_ok());
    for axis in 0..2 {
        let mut jerk = Vector3::zeros();
        jerk[axis] = f32::INFINITY;
        let refused = phi_at_heading(Vector3::zeros(), jerk, Heading::ZERO, 0.0);
        assert!(matches!(refused, Err(ReferenceError::NonFinite { .. })), "{refused:?}");
    }
    // The chart refuses the same inputs as the heading, and by the same name.
    let falling = Vector3::new(0.0, 0.0, -9.81);
    assert!(matches!(phi(falling, Vector3::zeros(), 0.0, 0.0), Err(ReferenceError::NoThrust { .. })));
    let inverted = phi_at_heading(Vector3::new(0.0, 0.0, -20.0), Vector3::zeros(), Heading::ZERO, 0.0);
    assert!(matches!(inverted, Err(ReferenceError::Inverted { .. })));
}
