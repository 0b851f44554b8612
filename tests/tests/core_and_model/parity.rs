//! The f32 core against the f64 laws over a box of states and references at any heading.

use quatrack::gains::paper;
use quatrack::nalgebra::Vector3;
use quatrack::{
    Controller, Equilibrium, ErrorForm, FeedForward, FlatOutput, FlatSample, Law as CoreLaw, Limits, Reference,
};
use quatrack_design::model::flat::reference_point;
use quatrack_design::model::{ATTITUDE, StateVector};
use quatrack_simulation::flight::core_loop;
use quatrack_simulation::flight::law::{Feedback, Law};
use quatrack_tests::core_step::step;
use quatrack_tests::{halton, quantile};

const CASES: u32 = 4000;

/// A coordinate of the unit box spread over plus or minus `size`, rounded to f32 so that both sides see one number.
fn spread(unit: f64, size: f64) -> f64 {
    f64::from(((2.0 * unit - 1.0) * size) as f32)
}

fn vector(units: &[f64], size: f64) -> Vector3<f64> {
    Vector3::new(spread(units[0], size), spread(units[1], size), spread(units[2], size))
}

/// Relative errors of the core's commands, in the order of cases, with both signs of the measured quaternion.
fn errors(core: CoreLaw<'_>, law: Law<'_>, heading_max_rad: f64) -> Vec<f64> {
    let feed_forward = match core {
        CoreLaw::Equilibrium(law) => law.feed_forward,
        CoreLaw::FlatOutput(law) => law.feed_forward,
        other => panic!("{other:?} has no counterpart in f64 here"),
    } == FeedForward::With;
    let controller = Controller::new(core, Limits::NONE);
    let feedback = Feedback { law, feed_forward };
    let mut errors = Vec::new();
    for case in 0..CASES {
        let u = halton::<20>(case);
        let sample = quatrack_design::model::flat::FlatSample {
            position_m: vector(&u[0..3], 2.0),
            velocity_m_s: vector(&u[3..6], 2.0),
            acceleration_m_s2: vector(&u[6..9], 4.0),
            jerk_m_s3: vector(&u[9..12], 10.0),
            heading_rad: spread(u[12], heading_max_rad),
            heading_rate_rad_s: spread(u[13], 2.0),
        };
        let target = reference_point(&sample);
        // Half a metre, 1 m/s and about 25 degrees off the reference.
        let mut state = target.state;
        for (i, unit) in u[14..17].iter().enumerate() {
            state[i] = f64::from((state[i] + spread(*unit, 0.5)) as f32);
            state[7 + i] = f64::from((state[7 + i] + spread(u[16 - i], 1.0)) as f32);
        }
        for (i, unit) in u[16..20].iter().enumerate() {
            state[ATTITUDE + i] += spread(*unit, 0.15);
        }
        let norm = state.fixed_rows::<4>(ATTITUDE).norm();
        for i in 0..4 {
            state[ATTITUDE + i] = f64::from((state[ATTITUDE + i] / norm) as f32);
        }
        let exact = feedback.input(&quatrack_design::model::normalised(&state), &target);
        let reference = Reference::from_flat(&FlatSample {
            position_m: sample.position_m.map(|v| v as f32),
            velocity_m_s: sample.velocity_m_s.map(|v| v as f32),
            acceleration_m_s2: sample.acceleration_m_s2.map(|v| v as f32),
            jerk_m_s3: sample.jerk_m_s3.map(|v| v as f32),
            heading_rad: sample.heading_rad as f32,
            heading_rate_rad_s: sample.heading_rate_rad_s as f32,
        })
        .unwrap();
        for sign in [1.0, -1.0] {
            let mut state: StateVector = state;
            state.fixed_rows_mut::<4>(ATTITUDE).scale_mut(sign);
            let found = step(&controller, &core_loop::state(&state), &reference).unwrap();
            let found = core_loop::input(&found.command);
            errors.push((found - exact).amax() / exact.amax().max(9.81));
        }
    }
    errors
}

fn f64_gain<const M: usize, const N: usize>(gain: &quatrack::gain::Gain<M, N>) -> nalgebra::SMatrix<f64, M, N> {
    gain.matrix().map(f64::from)
}

#[test]
fn the_equilibrium_law_agrees_to_f32_rounding() {
    for gain in [&paper::LQR_E, &paper::LYAP_E] {
        let exact = f64_gain(&gain.gain());
        for feed_forward in [FeedForward::Without, FeedForward::With] {
            let heading = Equilibrium { gain, error_form: ErrorForm::HeadingFrame, feed_forward };
            let paper_form = Equilibrium { gain, error_form: ErrorForm::Paper, feed_forward };
            for (core, law, heading_max_rad) in
                [(heading, Law::EquilibriumHeading(&exact), 9.0), (paper_form, Law::EquilibriumPaper(&exact), 1.0)]
            {
                let errors = errors(core.into(), law, heading_max_rad);
                // Nine products of errors below 1 with gains up to 100, summed in f32: 2^-24 of their size each.
                assert!(quantile(errors.clone(), 0.5) < 1e-7);
                assert!(quantile(errors.clone(), 0.99) < 4e-7);
                assert!(quantile(errors, 1.0) < 1e-6);
            }
        }
    }
}

#[test]
fn the_flat_output_law_agrees_to_f32_rounding() {
    for gain in [&paper::LQR_F, &paper::LYAP_F] {
        let exact = f64_gain(&gain.gain());
        for feed_forward in [FeedForward::Without, FeedForward::With] {
            let core = FlatOutput { gain, feed_forward };
            let errors = errors(core.into(), Law::FlatOutput(&exact), 9.0);
            // The flat map divides by thrust and by q0; where the asked acceleration comes near free fall the rates
            // grow, and their error with them.
            assert!(quantile(errors.clone(), 0.5) < 1e-7);
            assert!(quantile(errors.clone(), 0.99) < 5e-7);
            assert!(quantile(errors, 1.0) < 1e-5);
        }
    }
}

#[test]
fn a_bad_state_gives_no_command() {
    let controller = Controller::new(Equilibrium::new(&paper::LQR_E), Limits::NONE);
    let flat = Controller::new(FlatOutput::new(&paper::LQR_F), Limits::NONE);
    let reference = Reference::hover(Vector3::new(0.0, 0.0, 1.0), 0.3).unwrap();
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for component in 0..10 {
            let mut values = [0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
            values[component] = bad;
            let [x, y, z, q0, q1, q2, q3, vx, vy, vz] = values;
            let state = quatrack::State {
                position_m: Vector3::new(x, y, z),
                attitude: quatrack::Quaternion::new(q0, q1, q2, q3),
                velocity_m_s: Vector3::new(vx, vy, vz),
            };
            for law in [&controller, &flat] {
                let refused = step(law, &state, &reference);
                assert!(
                    matches!(refused, Err(quatrack::StepError::State(quatrack::StateError::NonFinite { .. }))),
                    "component {component} = {bad}: {refused:?}"
                );
            }
        }
    }
}
