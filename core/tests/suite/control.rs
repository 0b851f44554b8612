//! The control layer by itself: the leash, the handover, inputs and outputs.

use std::error::Error;

use quatrack::gains::paper;
use quatrack::law::{GainSchedule, ScheduleError};
use quatrack::nalgebra::Vector3;
use quatrack::{
    Controller, ControllerError, Equilibrium, Handover, Leash, Limits, Measured, Memory, MotorLimited, MotorStep,
    Output, Reference, State, Target,
};

#[test]
fn a_goal_is_drawn_along_the_straight_line_to_it() {
    let measured =
        State { velocity_m_s: Vector3::new(0.5, -0.25, 0.75), ..State::at_rest(Vector3::new(1.0, -2.0, 3.0)) };
    let leash = Leash { length_m: 2.5 };
    // 2, 4 and 4 m, 1, 4 and 8.5 m/s away: the squares are 36 and 89.25, so 11.19 in all.
    let (offset, change) = (Vector3::new(2.0, -4.0, 4.0), Vector3::new(-1.0, 4.0, 8.5));
    let (mut position, mut velocity) = (measured.position_m + offset, measured.velocity_m_s + change);
    leash.draw(&mut position, &mut velocity, &measured);
    let share = 2.5 / 125.25_f32.sqrt();
    assert!((position - measured.position_m - offset * share).amax() < 1e-6, "{position}");
    assert!((velocity - measured.velocity_m_s - change * share).amax() < 1e-6, "{velocity}");
    // Each alone reaches to the end of the leash and no further.
    for axis in 0..6 {
        for (length, drawn) in [(2.4_f32, false), (2.6, true), (-2.6, true)] {
            let (mut offset, mut change) = (Vector3::zeros(), Vector3::zeros());
            if axis < 3 {
                offset[axis] = length;
            } else {
                change[axis - 3] = length;
            }
            let goal = (measured.position_m + offset, measured.velocity_m_s + change);
            let (mut position, mut velocity) = goal;
            leash.draw(&mut position, &mut velocity, &measured);
            assert_eq!((position, velocity) != goal, drawn, "axis {axis}, {length}");
            let distance = (position - measured.position_m).norm() + (velocity - measured.velocity_m_s).norm();
            assert!((distance - length.abs().min(2.5)).abs() < 1e-6, "axis {axis}: {distance}");
        }
    }
}

#[test]
fn cuts_of_either_law_on_the_way_are_told() {
    let reference = Reference::hover(Vector3::zeros(), 0.0).unwrap();
    let target = Target::new(&reference);
    let wide = Limits::new(1.8, 16.5, Vector3::new(20.0, 20.0, 5.0)).unwrap();
    let narrow = Limits::new(9.0, 10.0, Vector3::new(20.0, 20.0, 5.0)).unwrap();
    let law = Equilibrium::new(&paper::LQR_E);
    let [wide, narrow] = [wide, narrow].map(|limits| Controller::new(law, limits));
    // 2 cm too low asks for 2 m/s^2 more: beyond the narrow limits alone. 10 cm: beyond both.
    for (height_m, old, new, thrust_cut) in [
        (-0.02, &wide, &narrow, true),
        (-0.02, &narrow, &wide, true),
        (-0.02, &wide, &wide, false),
        (-0.1, &wide, &narrow, true),
        (-0.1, &narrow, &narrow, true),
    ] {
        let state = State::at_rest(Vector3::new(0.0, 0.0, height_m));
        let mut way = Handover::of_commands(4);
        assert!(!way.is_over());
        let output = way.step((old, new), &mut Memory::at_rest(), (&state).into(), target).unwrap();
        assert_eq!(output.limited().command().thrust(), thrust_cut, "at {height_m} m");
        assert_eq!(output.limited().command().bits() & !1, 0, "nothing else");
    }
    assert!(Handover::OVER.is_over());
}

#[test]
fn forces_of_both_laws_on_the_way_tell_the_cuts_of_both() {
    use quatrack::{Actuation, Airframe, Rate};
    let airframe = Airframe::CRAZYFLIE_2_1;
    let actuation = Actuation::new(&airframe, Rate::from_hz(500).unwrap()).unwrap();
    let (state, still) = (State::at_rest(Vector3::zeros()), Vector3::zeros());
    let measured = Measured::new(&state).with_body_rates(&still);
    let forces =
        |force, bits| Output::Forces(MotorStep { forces_n: [force; 4], limited: MotorLimited::from_bits(bits) });
    for (from, to) in [(8, 8), (8, 0), (0, 8), (0x0108, 0x0201), (0, 0)] {
        let mut way = Handover::of_commands(2);
        let mut memory = Memory::hovering(&airframe);
        let output = way
            .step_with(
                &mut memory,
                Some(&actuation),
                measured,
                |_| Ok::<_, ()>(forces(0.09, to)),
                |_| Ok(forces(0.05, from)),
            )
            .unwrap();
        // Half of the way after one of two steps.
        assert!(matches!(output, Output::Forces(step) if step.forces_n.iter().all(|f| (f - 0.07).abs() < 1e-8)));
        assert_eq!(output.limited().bits(), from | to);
        assert_eq!(output.command(), None);
    }
}

#[test]
fn measurements_are_handed_on_as_they_are() {
    let (state, rates) = (State::at_rest(Vector3::new(1.0, 2.0, 3.0)), Vector3::new(0.1, 0.2, 0.3));
    assert_eq!((Measured::new(&state).state(), Measured::new(&state).body_rates_rad_s()), (&state, None));
    let rigid = quatrack::RigidState { state, body_rates_rad_s: rates };
    for measured in [Measured::new(&state).with_body_rates(&rates), (&rigid).into()] {
        assert_eq!((measured.state(), measured.body_rates_rad_s()), (&state, Some(&rates)));
    }
    let limits = Limits::new(1.8, 16.5, Vector3::new(20.0, 20.0, 5.0)).unwrap();
    let controller = Controller::new(Equilibrium::new(&paper::LQR_E), limits);
    assert_eq!(controller.limits(), &limits);
}

#[test]
fn gains_over_time_are_refused_by_name_and_read_back() {
    let gains: [[[f32; 9]; 4]; 2] = [*paper::LQR_E.gain().rows(), *paper::LYAP_E.gain().rows()];
    let knots = gains.map(|rows| GainSchedule::knot(&rows));
    let schedule = GainSchedule::new(&knots, 25, 77).unwrap();
    assert_eq!((schedule.knots(), schedule.steps_per_knot(), schedule.trajectory()), (2, 25, 77));
    assert_eq!([0, 1, 2].map(|knot| schedule.gain(knot)), [Some(gains[0]), Some(gains[1]), None]);

    let empty = GainSchedule::new(&[], 25, 77).unwrap_err();
    assert_eq!((empty, empty.to_string()), (ScheduleError::Empty, "gains over time: no knots".into()));
    let spacing = GainSchedule::new(&knots, 0, 77).unwrap_err();
    assert_eq!(spacing, ScheduleError::NoSpacing);
    assert!(spacing.to_string().contains("at least 1") && spacing.source().is_none());
    let mut rows = gains[1];
    rows[3][5] = f32::NAN;
    let broken = [knots[0], GainSchedule::knot(&rows)];
    let refused = GainSchedule::new(&broken, 25, 77).unwrap_err();
    assert!(matches!(refused, ScheduleError::Knot { knot: 1, .. }));
    assert!(refused.to_string().starts_with("gains over time: knot 1: gain"), "{refused}");
    assert!(refused.source().is_some());
}

#[test]
fn a_table_that_becomes_no_controller_says_why() {
    let lag = ControllerError::MotorLag { table_s: 0.126, actuation_s: 0.09 }.to_string();
    assert!(lag.contains("0.126 s") && lag.contains("0.09 s"), "{lag}");
}
