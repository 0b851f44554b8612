//! The simulation's f64 laws against the f32 core over a box of states and references at any heading: 24 dimensions.

use nalgebra::Vector4;
use quatrack::gains::paper;
use quatrack::{Controller, Equilibrium, ErrorForm, FeedForward, FlatOutput, Law as CoreLaw, Limits, State, StepError};
use quatrack_design::model::flat::reference_point;
use quatrack_design::model::{ATTITUDE, POSITION, StateVector, VELOCITY};
use quatrack_simulation::flight::core_loop;
use quatrack_simulation::flight::law::{Feedback, Law};
use quatrack_tests::cases::{self, Case};
use quatrack_tests::core_step::step;
use quatrack_tests::quantile;

const CASES: u32 = 4000;

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
        let Case { sample, reference, state } = cases::case(case, heading_max_rad);
        let target = reference_point(&quatrack_design::model::flat::FlatSample {
            position_m: sample.position_m.map(f64::from),
            velocity_m_s: sample.velocity_m_s.map(f64::from),
            acceleration_m_s2: sample.acceleration_m_s2.map(f64::from),
            jerk_m_s3: sample.jerk_m_s3.map(f64::from),
            heading_rad: f64::from(sample.heading_rad),
            heading_rate_rad_s: f64::from(sample.heading_rate_rad_s),
        });
        let q = state.attitude;
        let mut wide = StateVector::zeros();
        wide.fixed_rows_mut::<3>(POSITION).copy_from(&state.position_m.map(f64::from));
        wide.fixed_rows_mut::<4>(ATTITUDE).copy_from(&Vector4::new(q.w, q.x, q.y, q.z).map(f64::from));
        wide.fixed_rows_mut::<3>(VELOCITY).copy_from(&state.velocity_m_s.map(f64::from));
        let exact = feedback.input(&quatrack_design::model::normalised(&wide), &target);
        for attitude in [q, -q] {
            let found = step(&controller, &State { attitude, ..state }, &reference);
            // The flat map has no answer where a height far below is to be reached.
            if exact.iter().any(|u| !u.is_finite()) {
                assert_eq!(found, Err(StepError::Singular), "case {case}");
                continue;
            }
            let found = core_loop::input(&found.unwrap().command);
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
                // The reference's attitude, the measured one and its norm's inverse are each rounded to 2^-24; nine products of
                // errors below 1.5 with gains up to 100 are summed.
                assert!(quantile(errors.clone(), 0.5) < 1.5e-7);
                assert!(quantile(errors.clone(), 0.99) < 6e-7);
                assert!(quantile(errors, 1.0) < 1.5e-6);
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
            assert!(quantile(errors.clone(), 0.5) < 1.5e-7);
            assert!(quantile(errors.clone(), 0.99) < 1e-6);
            assert!(quantile(errors, 1.0) < 5e-5);
        }
    }
}
