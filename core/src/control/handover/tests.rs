//! The handover against analytic mixtures: no jump at its ends, equal parts between, the memory of both laws.

use super::*;
use crate::clock::Rate;
use crate::command::Limits;
use crate::gains::paper;
use crate::law::{ActuatorAware, ActuatorAwareGain, FeedForward, IntegralAction, IntegralGain};
use crate::motor_reference::MotorReference;
use crate::reference::Reference;
use crate::state::State;
use crate::{Airframe, Equilibrium, FlatOutput};

fn limits() -> Limits {
    Limits::new(1.8, 16.5, Vector3::new(20.0, 20.0, 5.0)).unwrap()
}

fn rate() -> Rate {
    Rate::from_hz(500).unwrap()
}

fn over(steps: u16) -> Handover {
    let law = Equilibrium::new(&paper::LQR_E).into();
    Handover::begin(steps, &law, &law, &mut Memory::at_rest())
}

fn alone(controller: &Controller<'_>, state: &State, reference: &Reference) -> Result<Output, StepError> {
    controller.step(&mut Memory::at_rest(), state.into(), reference.into())
}

fn next(
    way: &mut Handover,
    old: &Controller<'_>,
    new: &Controller<'_>,
    state: &State,
    reference: &Reference,
) -> Result<Output, StepError> {
    way.step((old, new), &mut Memory::at_rest(), state.into(), reference.into())
}

fn thrust(output: Result<Output, StepError>) -> f32 {
    output.unwrap().command().expect("both laws give commands").command.thrust_m_s2
}

#[test]
fn a_jump_comes_in_equal_parts_and_ends_with_the_new_law() {
    let old = Controller::new(Equilibrium::new(&paper::LYAP_E), limits());
    let new = Controller::new(Equilibrium::new(&paper::LQR_E), limits());
    let state = State::at_rest(Vector3::new(0.0, 0.0, 0.99));
    let reference = Reference::hover(Vector3::new(0.0, 0.0, 1.0), 0.0).unwrap();
    let (from, to) = (thrust(alone(&old, &state, &reference)), thrust(alone(&new, &state, &reference)));
    let mut way = over(8);
    for part in 1..=8_u8 {
        assert!(!way.is_over());
        let found = thrust(next(&mut way, &old, &new, &state, &reference));
        let expected = from + (to - from) * f32::from(part) / 8.0;
        assert!((found - expected).abs() <= 2e-6, "part {part}: {found}, not {expected}");
    }
    assert!(way.is_over());
    assert_eq!(next(&mut way, &old, &new, &state, &reference), alone(&new, &state, &reference));
    for steps in [0, 1] {
        assert_eq!(next(&mut over(steps), &old, &new, &state, &reference), alone(&new, &state, &reference));
    }
}

#[test]
fn an_old_law_without_an_answer_does_not_hold_the_new_one_up() {
    let old = Controller::new(FlatOutput::new(&paper::LQR_F), limits());
    let new = Controller::new(Equilibrium::new(&paper::LQR_E), limits());
    // Half a metre too high: 22 m/s^2 down, which has no upright attitude.
    let state = State::at_rest(Vector3::new(0.0, 0.0, 1.5));
    let reference = Reference::hover(Vector3::new(0.0, 0.0, 1.0), 0.0).unwrap();
    assert_eq!(alone(&old, &state, &reference), Err(StepError::Singular));
    let mut way = over(9);
    assert_eq!(next(&mut way, &old, &new, &state, &reference), alone(&new, &state, &reference));
    assert!(way.is_over());
    assert_eq!(next(&mut over(9), &new, &old, &state, &reference), Err(StepError::Singular));
}

#[test]
fn a_mix_of_commands_on_a_limit_stays_on_it() {
    let step = |thrust_m_s2| Step {
        command: Command { thrust_m_s2, body_rates_rad_s: Vector3::new(0.0, 0.0, 0.0) },
        limited: Limited::NOTHING,
    };
    let mut share = 0_u16;
    for (from, to) in [(1.8_f32, 16.5), (16.5, 1.8), (16.5, 16.499_998), (0.1, 16.5), (16.5, 16.5)] {
        for _ in 0..2000 {
            share = share.wrapping_add(4099).max(1);
            let share = f32::from(share) / 65536.0;
            let mixed = between_commands(&step(from), &step(to), share).command.thrust_m_s2;
            assert!((from.min(to)..=from.max(to)).contains(&mixed), "{mixed} from {from} to {to}");
        }
    }
}

/// Thrust from height, climb and its integral; every other error some answer.
fn to_motors() -> ActuatorAwareGain {
    let row = |roll: f32, pitch: f32, yaw: f32| {
        let [x, y, q1, q2, q3] = [0.1 * pitch, -0.1 * roll, 0.1 * roll, 0.1 * pitch, 0.01 * yaw];
        [x, y, 0.4, x, y, 0.2, q1, q2, q3, 0.01 * roll, 0.01 * pitch, 0.01 * yaw, 0.1, 0.1, 0.1, 0.1, x, y, 0.3]
    };
    ActuatorAwareGain::new([row(-1.0, -1.0, -1.0), row(-1.0, 1.0, 1.0), row(1.0, 1.0, -1.0), row(1.0, -1.0, 1.0)])
        .unwrap()
}

#[test]
fn a_command_and_motor_forces_are_mixed_as_forces_and_both_laws_are_given_the_mixed_ones() {
    let airframe = Airframe::CRAZYFLIE_2_1.commanded_at(rate());
    let actuation = Actuation::new(&airframe, rate()).unwrap();
    let gain = to_motors();
    let rates_law = Controller::new(Equilibrium::new(&paper::LQR_E), limits()).with_actuation(&actuation);
    let forces_law = Controller::new(ActuatorAware::new(&gain, &actuation), limits());
    let (state, still) = (State::at_rest(Vector3::new(0.0, 0.0, 0.995)), Vector3::new(0.0, 0.0, 0.0));
    let measured = Measured::new(&state).with_body_rates(&still);
    let reference = MotorReference::hover(Vector3::new(0.0, 0.0, 1.0), 0.0, &airframe).unwrap();
    let target = Target::with_forces(&reference);
    for (old, new) in [(&rates_law, &forces_law), (&forces_law, &rates_law)] {
        let mut memory = Memory::hovering(&airframe);
        let mut way = Handover::begin(4, old.law(), new.law(), &mut memory);
        for part in 1..4_u8 {
            let before = memory.forces_n();
            let [from, to] = [old, new].map(|controller| {
                // The integral is next to nothing after three steps of 2 ms, 5 mm away.
                controller.step_to_motors(&mut Memory::new(before).unwrap(), measured, target).unwrap().forces_n[0]
            });
            let Ok(Output::Forces(step)) = way.step((old, new), &mut memory, measured, target) else {
                panic!("part {part} gives no forces")
            };
            let expected = from + (to - from) * f32::from(part) / 4.0;
            assert!((step.forces_n[0] - expected).abs() < 2e-5, "part {part}: {}, not {expected}", step.forces_n[0]);
            assert_eq!(memory.forces_n(), actuation.lag().next(&before, &step.forces_n), "the motors follow the mix");
        }
        let alone = new.step(&mut memory.clone(), measured, target);
        assert_eq!(way.step((old, new), &mut memory, measured, target), alone, "the last step is the new law's");
    }
}

#[test]
fn an_integral_goes_on_only_where_it_means_the_same() {
    let mut rows = [[0.0; 12]; 4];
    for (row, (gains, integral)) in rows.iter_mut().zip(paper::LQR_E.gain().rows().iter().zip([
        [0.0, 0.0, 50.0],
        [0.0, -9.0, 0.0],
        [9.0, 0.0, 0.0],
        [0.0; 3],
    ])) {
        row[..9].copy_from_slice(gains);
        row[9..].copy_from_slice(&integral);
    }
    let gain = IntegralGain::new(rows).unwrap();
    let lqi: Law<'_> = IntegralAction::new(&gain, rate(), FeedForward::Without).into();
    let constant: Law<'_> = Equilibrium::new(&paper::LQR_E).into();
    let integrated = Memory { integral_m_s: Vector3::new(0.1, 0.2, 0.3), ..Memory::at_rest() };
    for (old, new, kept) in [(&lqi, &lqi, true), (&constant, &lqi, false), (&lqi, &constant, false)] {
        let mut memory = integrated;
        let way = Handover::begin(5, old, new, &mut memory);
        assert_eq!(memory == integrated, kept);
        assert_eq!(way.memory, integrated, "the old law keeps its own");
    }
}
