//! The core's laws past the paper's: integral action and gains along a trajectory, against f64, by hand, in a wind.

use std::sync::LazyLock;

use nalgebra::{SMatrix, SVector};
use quatrack::gains::paper;
use quatrack::gains::table::{
    Certificate, GainTable, Hash, Margins, Name, ScheduleRows, TABLE_BYTES_MAX, TableHead, Vehicle,
};
use quatrack::law::{EquilibriumGain, IntegralGain};
use quatrack::nalgebra::Vector3;
use quatrack::{
    AlongTrajectory, Command, Controller, Equilibrium, FeedForward, Handover, IntegralAction, Law, Limits, Memory,
    Progress, Quaternion, Rate, Reference, State, StepError, Target,
};
use quatrack_design::design::integral::{IntegralWeights, sampled_lqi};
use quatrack_design::design::sampled::{Sampling, shaped};
use quatrack_design::design::synthesis::EquilibriumWeights;
use quatrack_design::model::{InputVector, StateVector, VELOCITY, dynamics, normalised, position, velocity};
use quatrack_tests::cases::{self, spread};
use quatrack_tests::core_step::{command, step, step_on};
use quatrack_tests::halton;

use crate::twin;

fn rate(hz: u32) -> Rate {
    Rate::from_hz(hz).unwrap()
}

/// LQI for a rate, with weight 50 on each integral.
fn lqi_rows(hz: u32) -> [[f32; 12]; 4] {
    let weights = IntegralWeights { equilibrium: EquilibriumWeights::paper(), integral: [50.0; 3] };
    let gain: SMatrix<f64, 4, 12> = shaped(&sampled_lqi(&weights, &Sampling::at_rate(hz)).unwrap().gain).unwrap();
    std::array::from_fn(|row| std::array::from_fn(|column| gain[(row, column)] as f32))
}

fn lqi(hz: u32) -> IntegralGain {
    IntegralGain::new(lqi_rows(hz)).unwrap()
}

fn turned(psi_rad: f32, v: Vector3<f32>) -> Vector3<f32> {
    let (s, c) = psi_rad.sin_cos();
    Vector3::new(c * v.x - s * v.y, s * v.x + c * v.y, v.z)
}

/// A reference in motion and a state off it.
fn case(index: u32) -> (Reference, State) {
    let case = cases::case(index, 3.0);
    (case.reference, case.state)
}

fn array(command: &Command) -> [f32; 4] {
    let rates = &command.body_rates_rad_s;
    [command.thrust_m_s2, rates.x, rates.y, rates.z]
}

fn bits(command: &Command) -> [u32; 4] {
    array(command).map(f32::to_bits)
}

/// The command after half a second at a displacement: a controller of 1 Hz whose law is flown one step.
fn memory_of(sum: Vector3<f32>) -> Memory {
    static GAIN: LazyLock<IntegralGain> = LazyLock::new(|| lqi(1));
    let controller = Controller::new(IntegralAction::new(&GAIN, rate(1), FeedForward::Without), Limits::NONE);
    let mut memory = Memory::at_rest();
    step_on(&controller, &mut memory, &State::at_rest(sum), Target::new(&hover(0.0))).unwrap();
    assert_eq!(memory.integral_m_s(), sum);
    memory
}

/// A level state at a displacement from a hover at the origin.
fn displaced(dx: f32, dy: f32, dz: f32) -> State {
    State::at_rest(Vector3::new(dx, dy, dz))
}

fn hover(heading_rad: f32) -> Reference {
    Reference::hover(Vector3::zeros(), heading_rad).unwrap()
}

#[test]
fn integral_action_adds_the_answer_to_its_sum_in_the_heading_frame() {
    let (gain, rows) = (lqi(100), lqi_rows(100));
    for feed_forward in [FeedForward::Without, FeedForward::With] {
        let without =
            Controller::new(Equilibrium { feed_forward, ..Equilibrium::new(gain.equilibrium()) }, Limits::NONE);
        let with = Controller::new(IntegralAction::new(&gain, rate(100), feed_forward), Limits::NONE);
        for index in 0..2000 {
            let (reference, state) = case(index);
            let u = halton::<3>(index + 7);
            let sum = Vector3::new(spread(u[0], 0.5), spread(u[1], 0.5), spread(u[2], 0.5));
            let (cos, sin) = reference.heading().cos_sin();
            let (cos, sin) = (f64::from(cos), f64::from(sin));
            let i = sum.map(f64::from);
            let i = [cos * i.x + sin * i.y, cos * i.y - sin * i.x, i.z];
            let base = step(&without, &state, &reference).unwrap().command;
            let found = step_on(&with, &mut memory_of(sum), &state, Target::new(&reference)).unwrap().command;
            for ((row, base), found) in rows.iter().zip(array(&base)).zip(array(&found)) {
                let asked: f64 = row[9..].iter().zip(i).map(|(k, i)| f64::from(*k) * i).sum();
                let expected = f64::from(base) - asked;
                // Three products of up to 51 * 0.7 and a sum of up to 200: each rounded to 6e-8.
                assert!((f64::from(found) - expected).abs() < 5e-5, "case {index}: {found}, not {expected}");
            }
        }
    }
}

#[test]
fn the_sum_is_that_of_the_steps_before_and_stays_in_the_world_frame() {
    let gain = lqi(100);
    let controller = Controller::new(IntegralAction::new(&gain, rate(100), FeedForward::Without), Limits::NONE);
    let plain = Controller::new(Equilibrium::new(gain.equilibrium()), Limits::NONE);
    let state = displaced(0.5, -0.25, 0.125);
    let mut memory = Memory::at_rest();
    for (count, heading_rad) in (1_u8..).zip([0.0, 1.0, -2.5, 3.0]) {
        let reference = hover(heading_rad);
        let with = step_on(&controller, &mut memory, &state, Target::new(&reference)).unwrap();
        if count == 1 {
            let without = step(&plain, &state, &reference).unwrap();
            assert_eq!(with, without, "nothing has been summed before the first step");
        }
        let sum = memory.integral_m_s();
        let expected = Vector3::new(0.5, -0.25, 0.125) * (0.01 * f32::from(count));
        // The period, 0.01 s, and each sum are rounded.
        assert!((sum - expected).amax() < 4.0 * f32::EPSILON, "after {count} steps: {sum}");
    }
}

#[test]
fn the_sum_holds_while_the_command_that_answers_to_it_is_cut() {
    let gain = lqi(100);
    let limits = Limits::new(2.0, 17.0, Vector3::new(5.0, 5.0, 1.0)).unwrap();
    let controller = Controller::new(IntegralAction::new(&gain, rate(100), FeedForward::Without), limits);
    let yaw = |angle_rad: f32| Quaternion::new((0.5 * angle_rad).cos(), 0.0, 0.0, (0.5 * angle_rad).sin());
    // The cuts, of T p q r, and whether x, y, z of the sum go on.
    let cases = [
        (displaced(0.1, 0.1, 0.02), 0b0000, [true, true, true]),
        (displaced(0.1, 0.1, -1.0), 0b0001, [true, true, false]),
        (displaced(0.1, 1.0, 0.02), 0b0010, [false, false, true]),
        (displaced(1.0, 0.1, 0.02), 0b0100, [false, false, true]),
        (State { attitude: yaw(1.0), ..displaced(0.1, 0.1, 0.02) }, 0b1000, [true, true, true]),
        (displaced(1.0, 1.0, -1.0), 0b0111, [false, false, false]),
    ];
    for heading_rad in [0.0, 1.5] {
        for (state, cut, goes_on) in cases {
            let state = State {
                position_m: turned(heading_rad, state.position_m),
                attitude: yaw(heading_rad) * state.attitude,
                ..state
            };
            let before = Vector3::new(0.01, 0.02, 0.03);
            let mut memory = memory_of(before);
            let step = step_on(&controller, &mut memory, &state, Target::new(&hover(heading_rad))).unwrap();
            assert_eq!(step.limited.bits(), cut);
            let change = memory.integral_m_s() - before;
            let moved = [change.x, change.y, change.z].map(|change| change != 0.0);
            assert_eq!(moved, goes_on, "{cut:04b} cut at heading {heading_rad}");
        }
    }
}

#[test]
fn a_step_without_a_command_leaves_the_memory() {
    let gain = lqi(100);
    let controller = Controller::new(IntegralAction::new(&gain, rate(100), FeedForward::Without), Limits::NONE);
    let before = memory_of(Vector3::new(0.1, 0.2, 0.3));
    for bad in [f32::NAN, f32::INFINITY, 3e38] {
        for component in 0..3 {
            let mut state = displaced(0.0, 0.0, 0.0);
            state.position_m[component] = bad;
            let mut memory = before;
            let refused = step_on(&controller, &mut memory, &state, Target::new(&hover(0.0)));
            assert!(matches!(refused, Err(StepError::State(_) | StepError::Singular)), "{bad} in {component}");
            assert_eq!(memory, before);
        }
    }
}

/// The plant (1) in a steady wind, which pushes by an acceleration, under held commands; the position error at the end.
fn position_in_a_wind(law: Law<'_>, wind_m_s2: Vector3<f64>, heading_rad: f32, duration_s: u32) -> Vector3<f64> {
    let limits = Limits::new(2.0, 17.0, Vector3::new(20.0, 20.0, 5.0)).unwrap();
    let controller = Controller::new(law, limits);
    let reference = hover(heading_rad);
    let attitude = reference.state().attitude;
    let mut x = StateVector::zeros();
    x.fixed_rows_mut::<4>(3)
        .copy_from(&nalgebra::Vector4::new(attitude.w, attitude.x, attitude.y, attitude.z).map(f64::from));
    let mut memory = Memory::at_rest();
    for _ in 0..duration_s * 100 {
        let q = quatrack_design::model::attitude(&x).normalize().map(|q| q as f32);
        let state = State {
            position_m: position(&x).map(|r| r as f32),
            attitude: Quaternion::new(q[0], q[1], q[2], q[3]),
            velocity_m_s: velocity(&x).map(|v| v as f32),
        };
        let step = step_on(&controller, &mut memory, &state, Target::new(&reference)).unwrap();
        let input: InputVector = twin::input(&step.command);
        for _ in 0..10 {
            let mut rate_of_change = dynamics(&x, &input);
            let mut blown = rate_of_change.fixed_rows_mut::<3>(VELOCITY);
            blown += wind_m_s2;
            x += rate_of_change * 0.001;
            x = normalised(&x);
        }
    }
    x.fixed_rows::<3>(0).into_owned()
}

#[test]
fn a_steady_wind_leaves_no_offset_at_any_heading() {
    let gain = lqi(100);
    let wind = Vector3::new(0.6, -0.3, -0.5);
    for heading_rad in [0.0_f32, 1.2, -2.6] {
        let law = IntegralAction::new(&gain, rate(100), FeedForward::Without);
        let with = position_in_a_wind(law.into(), wind, heading_rad, 20);
        // The slow poles of the design are at -0.7 1/s: exp(-14) of centimetres.
        assert!(with.amax() < 1e-5, "heading {heading_rad}: {with}");
        let without = position_in_a_wind(Equilibrium::new(&paper::LQR_E).into(), wind, heading_rad, 20);
        // The thrust leans against wind and weight, T = |g e3 - w|, and a height answers to it: k_z z = g - T.
        let horizontal = wind.xy().norm();
        let thrust = horizontal.hypot(9.81 - wind.z);
        assert!((without.z - (9.81 - thrust) / 100.0).abs() < 1e-5, "{without}");
        // Sideways the tilt keeps the pitch rate at zero: k_x x = k_q sin(tilt / 2).
        let tilt = horizontal.atan2(9.81 - wind.z);
        let offset = 45.7951 / 31.622776 * (0.5 * tilt).sin();
        assert!((without.xy().norm() / offset - 1.0).abs() < 0.01, "{} {offset}", without.xy().norm());
    }
}

/// The height over time, from 0 at rest, of a point mass that is pushed down by 8 m/s^2 for 2 s, while no more than
/// 7.2 m/s^2 upwards are to be had: its largest value, the last one, and the sum at the end.
fn pushed_down(controller: &Controller<'_>, duration_s: u32) -> (f32, f32, f32) {
    let reference = hover(0.0);
    let (mut z, mut vz, mut memory, mut highest) = (0.0_f32, 0.0_f32, Memory::at_rest(), 0.0_f32);
    for tick in 0..100 * duration_s {
        let state = State { velocity_m_s: Vector3::new(0.0, 0.0, vz), ..displaced(0.0, 0.0, z) };
        let thrust = step_on(controller, &mut memory, &state, Target::new(&reference)).unwrap().command.thrust_m_s2;
        let push = if tick < 200 { 8.0 } else { 0.0 };
        vz += (thrust.clamp(2.0, 17.0) - 9.81 - push) * 0.01;
        z += vz * 0.01;
        highest = highest.max(z);
    }
    (highest, z, memory.integral_m_s().z)
}

#[test]
fn a_command_that_is_cut_for_long_is_not_paid_for_later() {
    let gain = lqi(100);
    let law = IntegralAction::new(&gain, rate(100), FeedForward::Without);
    let limits = Limits::new(2.0, 17.0, Vector3::new(20.0, 20.0, 5.0)).unwrap();
    let (overshoot, end, sum) = pushed_down(&Controller::new(law, limits), 14);
    // Cut by the world alone, which the law does not see: its sum goes on.
    let (windup, ..) = pushed_down(&Controller::new(law, Limits::NONE), 14);
    println!("overshoot {overshoot} m, with a sum that goes on {windup} m");
    assert!(windup > 1.0 && overshoot < 0.25 * windup, "{overshoot} {windup}");
    // The slow poles are at -0.93 and -1.07 1/s: nothing of metres is left after twelve seconds.
    assert!(end.abs() < 1e-3 && sum.abs() < 1e-3, "at {end} m, {sum} m s");
}

/// Three gains that differ in every entry.
fn knots() -> Vec<[[f32; 9]; 4]> {
    (0..3)
        .map(|knot| {
            std::array::from_fn(|row| {
                std::array::from_fn(|column| {
                    let u = halton::<2>(1 + knot * 36 + row as u32 * 9 + column as u32);
                    paper::LQR_E.gain().rows()[row][column] * (0.8 + 0.4 * u[0] as f32) + spread(u[1], 0.5)
                })
            })
        })
        .collect()
}

fn head(rate: Rate) -> TableHead {
    let margins = Margins { gain_factor: 2.0, phase_rad: 0.75 };
    TableHead {
        name: Name::literal("along"),
        vehicle: Vehicle { name: Name::literal("craft"), id: 1 },
        rate,
        limits: Limits::new(1.75, 16.5, Vector3::new(20.0, 20.0, 5.0)).unwrap(),
        design_hash: Hash([1; 32]),
        certificate: Certificate {
            hash: Hash([2; 32]),
            one_channel: margins,
            all_channels: margins,
            delay_max_s: 0.05,
            motor_lag_max_s: 0.025,
            f32_distance: 1e-8,
        },
    }
}

const STEPS_PER_KNOT: u16 = 20;
const TRAJECTORY: u32 = 77;

/// The law with the gains of [`knots`] at 100 Hz, 0.2 s apart.
fn along(buffer: &mut [u8; TABLE_BYTES_MAX], player_hz: u32, feed_forward: FeedForward) -> AlongTrajectory<'_> {
    let rows = ScheduleRows { trajectory: TRAJECTORY, steps_per_knot: STEPS_PER_KNOT, gains: &knots() };
    let table = GainTable::along(buffer, &head(rate(100)), &rows).unwrap();
    AlongTrajectory::new(table.schedule().unwrap(), rate(100), rate(player_hz), feed_forward)
}

fn at(tick: u32) -> Option<Progress> {
    Some(Progress { trajectory: TRAJECTORY, tick })
}

#[test]
fn at_a_knot_the_law_is_that_of_its_gain_to_the_bit() {
    let gains: Vec<EquilibriumGain> = knots().into_iter().map(|rows| EquilibriumGain::new(rows).unwrap()).collect();
    let mut buffer = [0; TABLE_BYTES_MAX];
    for feed_forward in [FeedForward::Without, FeedForward::With] {
        for player_hz in [100, 500, 1000] {
            let along = Controller::new(along(&mut buffer, player_hz, feed_forward), Limits::NONE);
            let ticks_per_knot = u32::from(STEPS_PER_KNOT) * player_hz / 100;
            let elsewhere = Some(Progress { trajectory: TRAJECTORY + 1, tick: 0 });
            // Behind the last knot, on another trajectory and on none: the last knot's gain.
            let cases = [
                (at(0), 0),
                (at(ticks_per_knot), 1),
                (at(2 * ticks_per_knot), 2),
                (at(2 * ticks_per_knot + 1), 2),
                (at(u32::MAX), 2),
                (elsewhere, 2),
                (None, 2),
            ];
            for (progress, knot) in cases {
                let fixed = Equilibrium { feed_forward, ..Equilibrium::new(&gains[knot]) };
                let fixed = Controller::new(fixed, Limits::NONE);
                for index in 0..200 {
                    let (reference, state) = case(index);
                    let expected = step(&fixed, &state, &reference).unwrap().command;
                    let target = Target::new(&reference).at(progress);
                    let found = step_on(&along, &mut Memory::at_rest(), &state, target).unwrap().command;
                    assert_eq!(bits(&found), bits(&expected), "knot {knot}, {progress:?}, case {index}");
                }
            }
        }
    }
}

#[test]
fn between_knots_the_gain_is_on_the_straight_line() {
    let mut buffer = [0; TABLE_BYTES_MAX];
    let along = Controller::new(along(&mut buffer, 300, FeedForward::Without), Limits::NONE);
    let gains = knots();
    for index in 0..2000 {
        let (_, state) = case(index);
        // A level hover at the state's position and no turn: the error is the velocity and the displacement alone.
        let reference = hover(0.0);
        let state = State { attitude: Quaternion::IDENTITY, ..state };
        // 60 ticks a knot at 300 Hz.
        let tick = index % 121;
        let (knot, share) = ((tick / 60) as usize, f64::from(tick % 60) / 60.0);
        let (before, after) = (gains[knot], gains[(knot + 1).min(2)]);
        let (r, v) = (state.position_m, state.velocity_m_s);
        let error = SVector::<f64, 9>::from([r.x, r.y, r.z, 0.0, 0.0, 0.0, v.x, v.y, v.z].map(f64::from));
        let target = Target::new(&reference).at(at(tick));
        let found = step_on(&along, &mut Memory::at_rest(), &state, target).unwrap().command;
        let hover = [9.81_f64, 0.0, 0.0, 0.0];
        for row in 0..4 {
            let gain = SVector::<f64, 9>::from_fn(|column, _| {
                let (from, to) = (f64::from(before[row][column]), f64::from(after[row][column]));
                from + share * (to - from)
            });
            let expected = hover[row] - gain.dot(&error);
            let found = f64::from(array(&found)[row]);
            // Nine products of up to 100 * 3, each rounded to 6e-8, and a share to 1e-7 of differences as large.
            assert!((found - expected).abs() < 2e-4, "tick {tick}, row {row}: {found}, not {expected}");
        }
    }
}

#[test]
fn a_handover_of_laws_that_remember_ends_at_the_new_one_and_counts_each_step_once() {
    let gain = lqi(100);
    let integral = Controller::new(IntegralAction::new(&gain, rate(100), FeedForward::Without), Limits::NONE);
    let plain = Controller::new(Equilibrium::new(&paper::LQR_E), Limits::NONE);
    let (state, reference) = (displaced(0.1, 0.2, 0.3), hover(0.5));
    for (old, new) in [(&plain, &integral), (&integral, &plain), (&integral, &integral)] {
        let start = memory_of(Vector3::new(0.02, -0.03, 0.04));
        let (mut before, mut memory) = (start, start);
        let mut way = Handover::begin(8, old.law(), new.law(), &mut memory);
        let mut alone = memory;
        for step in 1..=10 {
            let from = step_on(old, &mut before, &state, Target::new(&reference)).unwrap().command;
            let to = step_on(new, &mut alone, &state, Target::new(&reference)).unwrap().command;
            let output = way.step((old, new), &mut memory, (&state).into(), Target::new(&reference));
            let found = command(output.unwrap()).command;
            let share = (f64::from(step) / 8.0).min(1.0);
            for ((from, to), found) in array(&from).into_iter().zip(array(&to)).zip(array(&found)) {
                let expected = f64::from(from) + share * (f64::from(to) - f64::from(from));
                assert!((f64::from(found) - expected).abs() < 1e-5, "step {step}: {found}, not {expected}");
            }
            assert_eq!(memory, alone, "as the new law would have left it");
        }
        assert!(way.is_over());
    }
}

#[test]
fn a_reference_with_the_input_of_one_ahead_is_otherwise_the_same() {
    for index in 0..100 {
        let ((present, _), (ahead, _)) = (case(index), case(index + 1));
        let mixed = present.with_input_of(&ahead);
        assert_eq!((mixed.state(), mixed.heading()), (present.state(), present.heading()));
        assert_eq!(mixed.input(), ahead.input());
        assert_eq!(mixed.with_input_of(&present), present);
    }
}
