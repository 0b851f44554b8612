//! The reference carried to the motors: against differences along curves, against the rigid plant flown open loop, and from
//! stored pieces.

use nalgebra::{Quaternion as Quaternion64, SVector, Vector4};
use quatrack::error::{Field, ReferenceError};
use quatrack::nalgebra::Vector3;
use quatrack::{Airframe, FifthOrderSample, MotorReference, Piece, Player, Rate, Trajectory};
use quatrack_simulation::plant::Craft;
use quatrack_simulation::vehicles;

use super::{CRAFT, Eight, on};

/// Derivative of a curve by the five-point rule; its error is `d^4 / 30` of the fifth derivative.
fn slope<const N: usize>(d: f64, curve: impl Fn(f64) -> SVector<f64, N>) -> SVector<f64, N> {
    ((curve(d) - curve(-d)) * 8.0 - (curve(2.0 * d) - curve(-2.0 * d))) / (12.0 * d)
}

#[test]
fn every_derivative_is_that_of_the_one_before() {
    let airframe = Airframe::CRAZYFLIE_2_1;
    for eight in [Eight::LEVEL, Eight::TURNING] {
        for k in 0..60 {
            let t = 0.17 * f64::from(k);
            let at = |dt: f64| eight.reference(t + dt, &airframe);
            let reference = at(0.0);
            let q = on(&reference).attitude;
            let turn = slope(0.01, |dt| {
                let other = on(&at(dt)).attitude.into_inner();
                // Headings turn by less than half a turn in 20 ms: no change of sign.
                Vector4::new(other.w, other.i, other.j, other.k)
            });
            let rates = (q.inverse().into_inner() * Quaternion64::new(turn[0], turn[1], turn[2], turn[3])).imag() * 2.0;
            let found = reference.body_rates_rad_s().map(f64::from);
            // Fifth derivatives reach 5e3 1/s^5 here: 1e-8 * 5e3 / 30; roundings of f32 over 10 ms are 2e-5.
            assert!((rates - found).amax() < 5e-5, "body rates at {t}: {rates} {found}");
            let acceleration = slope(0.01, |dt| at(dt).body_rates_rad_s().map(f64::from));
            let found = reference.angular_acceleration_rad_s2().map(f64::from);
            // Rates of up to 3 rad/s: the same with ten times the roundings.
            assert!((acceleration - found).amax() < 5e-4, "acceleration at {t}: {acceleration} {found}");
            let force_rates = slope(0.01, |dt| Vector4::from(at(dt).forces_n()).map(f64::from));
            let lag_s = f64::from(airframe.figures().motor_lag_s);
            let ahead = Vector4::from(reference.commands_n()).map(f64::from)
                - Vector4::from(reference.forces_n()).map(f64::from);
            assert!((force_rates - ahead / lag_s).amax() < 2e-5, "force rates at {t}: {force_rates}");
        }
    }
}

#[test]
fn the_commands_fly_the_plant_open_loop() {
    for (name, airframe) in CRAFT {
        let craft = Craft::new(&vehicles::by_name(name).unwrap());
        for eight in [Eight::LEVEL, Eight::TURNING] {
            let step_s = 5e-4;
            let mut x = on(&eight.reference(0.0, &airframe));
            for k in 0..4000 {
                let t = f64::from(k) * step_s;
                let commands = eight.reference(t + 0.5 * step_s, &airframe).commands_n();
                x = craft.hold(&x, &Vector4::from(commands).map(f64::from), t, step_s);
            }
            let goal = on(&eight.reference(2.0, &airframe));
            // Nothing corrects: an angular acceleration wrong by 1e-4 of its 10 rad/s^2 would show as 2 cm after 2 s. Commands
            // rounded to f32 and held at the middle of half a millisecond leave 1e-6 of it.
            assert!(
                (x.position_m - goal.position_m).norm() < 1e-3,
                "{name}: {}",
                (x.position_m - goal.position_m).norm()
            );
            assert!(x.attitude.angle_to(&goal.attitude) < 1e-3, "{name}: {}", x.attitude.angle_to(&goal.attitude));
            assert!((x.thrusts_n - goal.thrusts_n).amax() < 1e-6, "{name}");
        }
    }
}

#[test]
fn hover_is_a_quarter_of_the_weight() {
    let reference = MotorReference::hover(Vector3::new(1.0, 2.0, 3.0), 0.7, &Airframe::CRAZYFLIE_2_1).unwrap();
    let hover = Airframe::CRAZYFLIE_2_1.hover_force_n();
    assert_eq!((reference.forces_n(), reference.commands_n()), ([hover; 4], [hover; 4]));
    assert_eq!(reference.angular_acceleration_rad_s2(), Vector3::zeros());
    assert_eq!(reference.state().position_m, Vector3::new(1.0, 2.0, 3.0));
}

#[test]
fn the_player_gives_derivatives_of_the_monomials() {
    // x = t^7, y = t^5 - t, z = t^4 / 8, heading = t^3 at t = 1/2, all exact in binary.
    let mut piece = Piece { duration_ns: 1_000_000_000, x: [0.0; 8], y: [0.0; 8], z: [0.0; 8], heading: [0.0; 8] };
    (piece.x[7], piece.y[5], piece.y[1], piece.z[4], piece.heading[3]) = (1.0, 1.0, -1.0, 0.125, 1.0);
    let septic = [piece];
    (piece.x[7], piece.heading[3]) = (0.0, 0.0);
    let quintic = [piece];
    for (pieces, x) in [(&septic, [840.0 / 8.0, 2520.0 / 4.0]), (&quintic, [0.0, 0.0])] {
        let mut player = Player::new(Trajectory::new(pieces).unwrap(), Rate::from_hz(2).unwrap());
        let sample = player.at_fifth_order(1);
        assert_eq!(sample.flat, player.at(1));
        assert_eq!(sample.snap_m_s4, Vector3::new(x[0], 60.0, 3.0));
        assert_eq!(sample.crackle_m_s5, Vector3::new(x[1], 120.0, 0.0));
    }
    let mut player = Player::new(Trajectory::new(&septic).unwrap(), Rate::from_hz(2).unwrap());
    let sample = player.at_fifth_order(1);
    assert_eq!((sample.heading_acceleration_rad_s2, sample.heading_jerk_rad_s3), (3.0, 6.0));
    let airframe = Airframe::CRAZYFLIE_2_1;
    let rest = MotorReference::from_flat(&player.at_fifth_order(2), &airframe).unwrap();
    assert_eq!(rest.forces_n(), [airframe.hover_force_n(); 4]);
}

#[test]
fn the_papers_laws_get_their_own_reference() {
    let airframe = Airframe::CRAZYFLIE_2_1;
    for k in 0..40 {
        let sample = Eight::TURNING.at(0.2 * f64::from(k));
        let full = MotorReference::from_flat(&sample, &airframe).unwrap();
        let plain = quatrack::Reference::from_flat(&sample.flat).unwrap();
        let (a, b) = (full.reference(), &plain);
        // Two orders of the same sums.
        assert!((a.state().attitude.dot(b.state().attitude) - 1.0).abs() < 5e-7);
        assert!((a.input().body_rates_rad_s - b.input().body_rates_rad_s).amax() < 2e-6);
        assert!((a.input().thrust_m_s2 - b.input().thrust_m_s2).abs() < 4e-6);
        assert_eq!(
            (a.acceleration_m_s2(), a.jerk_m_s3(), a.heading()),
            (b.acceleration_m_s2(), b.jerk_m_s3(), b.heading())
        );
    }
}

#[test]
fn references_that_cannot_be_flown_are_named() {
    let airframe = Airframe::CRAZYFLIE_2_1;
    let rest = FifthOrderSample::at_rest(Vector3::new(0.0, 0.0, 1.0), 0.0);
    let refused = |sample: FifthOrderSample| MotorReference::from_flat(&sample, &airframe).unwrap_err();
    let with = |change: &dyn Fn(&mut FifthOrderSample)| {
        let mut sample = rest;
        change(&mut sample);
        refused(sample)
    };
    let infinite = |field| ReferenceError::NonFinite { field, value: f32::INFINITY };
    assert_eq!(with(&|s| s.flat.position_m.x = f32::INFINITY), infinite(Field::Position));
    assert_eq!(with(&|s| s.flat.velocity_m_s.z = f32::INFINITY), infinite(Field::Velocity));
    assert_eq!(with(&|s| s.flat.acceleration_m_s2.y = f32::INFINITY), infinite(Field::Acceleration));
    assert_eq!(with(&|s| s.flat.jerk_m_s3.z = f32::INFINITY), infinite(Field::Jerk));
    assert_eq!(with(&|s| s.snap_m_s4.x = f32::INFINITY), infinite(Field::SnapAndCrackle));
    assert_eq!(with(&|s| s.crackle_m_s5.y = f32::INFINITY), infinite(Field::SnapAndCrackle));
    assert_eq!(with(&|s| s.flat.heading_rate_rad_s = f32::INFINITY), infinite(Field::HeadingRate));
    assert_eq!(with(&|s| s.heading_acceleration_rad_s2 = f32::INFINITY), infinite(Field::HeadingDerivatives));
    assert_eq!(with(&|s| s.heading_jerk_rad_s3 = f32::INFINITY), infinite(Field::HeadingDerivatives));
    assert!(matches!(
        with(&|s| s.flat.heading_rad = f32::NAN),
        ReferenceError::NonFinite { field: Field::Heading, .. }
    ));
    assert!(matches!(with(&|s| s.flat.acceleration_m_s2.z = -9.81), ReferenceError::NoThrust { .. }));
    assert!(matches!(with(&|s| s.flat.acceleration_m_s2.z = -20.0), ReferenceError::Inverted { .. }));
}
