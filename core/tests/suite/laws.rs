//! Every law of the core against its f64 twin, over a box of states and references at any heading.

use nalgebra::{SMatrix, SVector, Vector4};
use quatrack::gains::paper;
use quatrack::law::{EquilibriumGain, FlatOutputGain, IntegralGain};
use quatrack::nalgebra::Vector3;
use quatrack::{
    Controller, Equilibrium, ErrorForm, FeedForward, FlatOutput, IntegralAction, Law, Limits, Memory, Quaternion, Rate,
    Reference, State, StateError, StepError, Target,
};
use quatrack_design::model::flat::ReferencePoint;
use quatrack_tests::cases::{case, spread};
use quatrack_tests::core_step::{step, step_on};
use quatrack_tests::{halton, quantile};

use crate::twin::{self, Craft, craft, goal, matrix};

const CASES: u32 = 4000;

/// Bounds of a law's errors: their median, 99 % of them, all.
type Bounds = [f64; 3];

/// The law against the exact input, both signs of the measured quaternion.
fn agrees(law: Law<'_>, heading_max_rad: f64, bounds: Bounds, exact: impl Fn(&Craft, &ReferencePoint) -> Vector4<f64>) {
    let controller = Controller::new(law, Limits::NONE);
    let mut errors = Vec::new();
    for index in 0..CASES {
        let case = case(index, heading_max_rad);
        let exact = exact(&craft(&case.state), &goal(&case.sample));
        for attitude in [case.state.attitude, -case.state.attitude] {
            let state = State { attitude, ..case.state };
            match step(&controller, &state, &case.reference) {
                Ok(found) => errors.push((twin::input(&found.command) - exact).amax() / exact.amax().max(9.81)),
                // The flat map has no answer where a height far below is to be reached.
                Err(refused) => assert!(
                    refused == StepError::Singular && exact.iter().any(|u| !u.is_finite()),
                    "case {index}: {refused}, but {exact}"
                ),
            }
        }
    }
    assert!(errors.len() > 7 * CASES as usize / 4, "only {} commands", errors.len());
    for (share, bound) in [0.5, 0.99, 1.0].into_iter().zip(bounds) {
        let error = quantile(errors.clone(), share);
        assert!(error < bound, "{share} of the errors of {law:?}: {error}, not below {bound}");
    }
}

/// The reference's attitude, the measured one and its norm's inverse are each rounded to 2^-24; nine products of errors
/// below
/// 1.5 with gains up to 100 are summed: a dozen roundings of half of 1.2e-7, of the largest of which a command is.
const LINEAR: Bounds = [1.5e-7, 6e-7, 1.5e-6];

/// The flat map divides by thrust and by q0; where the asked acceleration comes near free fall the rates grow, and
/// their error with them.
const FLAT: Bounds = [1.5e-7, 1e-6, 5e-5];

/// A gain with an entry everywhere: that of a design, each entry moved by another amount.
fn full<const M: usize, const N: usize>(rows: &[[f32; N]; M], size: f64) -> [[f32; N]; M] {
    std::array::from_fn(|row| {
        std::array::from_fn(|column| rows[row][column] + spread(halton::<2>((row * N + column) as u32)[1], size))
    })
}

#[test]
fn the_equilibrium_law_is_its_twin_for_any_gain() {
    let whole = EquilibriumGain::new(full(paper::LQR_E.gain().rows(), 3.0)).unwrap();
    for gain in [&paper::LQR_E, &paper::LYAP_E, &whole] {
        let exact = matrix(gain.gain().rows());
        for feed_forward in [FeedForward::Without, FeedForward::With] {
            let fed = feed_forward == FeedForward::With;
            let law = Equilibrium { gain, error_form: ErrorForm::HeadingFrame, feed_forward };
            agrees(law.into(), 9.0, LINEAR, |x, goal| {
                twin::equilibrium(&exact, &twin::heading_error(x, goal), goal, fed)
            });
            let law = Equilibrium { gain, error_form: ErrorForm::Paper, feed_forward };
            agrees(law.into(), 1.0, LINEAR, |x, goal| {
                twin::equilibrium(&exact, &twin::paper_error(x, goal), goal, fed)
            });
        }
    }
}

#[test]
fn the_flat_output_law_is_its_twin_for_any_gain() {
    let whole = FlatOutputGain::new(full(paper::LQR_F.gain().rows(), 0.3)).unwrap();
    for gain in [&paper::LQR_F, &paper::LYAP_F, &whole] {
        let exact = matrix(gain.gain().rows());
        for feed_forward in [FeedForward::Without, FeedForward::With] {
            let law = FlatOutput { gain, feed_forward };
            agrees(law.into(), 9.0, FLAT, |x, goal| {
                twin::flat_output(&exact, x, goal, feed_forward == FeedForward::With)
            });
        }
    }
}

#[test]
fn a_gain_is_given_back_as_it_was_made_and_one_stray_entry_counts() {
    let flat = full(paper::LQR_F.gain().rows(), 0.3);
    assert_eq!(FlatOutputGain::new(flat).unwrap().gain().rows(), &flat);
    let whole = full(paper::LQR_E.gain().rows(), 3.0);
    assert_eq!(EquilibriumGain::new(whole).unwrap().gain().rows(), &whole);
    // Errors of 1 in the column of the stray entry: it comes out as it is.
    let state = |column: usize| {
        let mut e = [0.0; 9];
        e[column] = 1.0;
        let half = 0.5_f32.sqrt();
        let attitude = match column {
            3 => Quaternion::new(half, half, 0.0, 0.0),
            4 => Quaternion::new(half, 0.0, half, 0.0),
            5 => Quaternion::new(half, 0.0, 0.0, half),
            _ => Quaternion::IDENTITY,
        };
        let size = if attitude == Quaternion::IDENTITY { 1.0 } else { half };
        let state = State {
            position_m: Vector3::new(e[0], e[1], e[2]),
            attitude,
            velocity_m_s: Vector3::new(e[6], e[7], e[8]),
        };
        (state, size)
    };
    let hover = Reference::hover(Vector3::zeros(), 0.0).unwrap();
    let designed = *paper::LQR_E.gain().rows();
    for (row, column) in (0..4).flat_map(|row| (0..9).map(move |column| (row, column))) {
        let mut rows = designed;
        rows[row][column] += 2.0;
        let gain = EquilibriumGain::new(rows).unwrap();
        let (state, size) = state(column);
        let asked = |gain| {
            let step = step(&Controller::new(Equilibrium::new(gain), Limits::NONE), &state, &hover).unwrap();
            twin::input(&step.command)
        };
        let mut expected = Vector4::zeros();
        expected[row] = -2.0 * f64::from(size);
        // Differences of two f32 of up to 110.
        assert!((asked(&gain) - asked(&paper::LQR_E) - expected).amax() < 2e-5, "({row}, {column})");
    }
}

#[test]
fn integral_action_is_its_twin_for_any_gain() {
    let rate = Rate::from_hz(100).unwrap();
    let mut rows: [[f32; 12]; 4] = full(&[[0.0; 12]; 4], 9.0);
    for (row, designed) in rows.iter_mut().zip(paper::LQR_E.gain().rows()) {
        row.iter_mut().zip(designed).for_each(|(entry, designed)| *entry += designed);
    }
    let gain = IntegralGain::new(rows).unwrap();
    assert_eq!(gain.rows(), rows);
    let exact = matrix(&rows);
    for feed_forward in [FeedForward::Without, FeedForward::With] {
        let controller = Controller::new(IntegralAction::new(&gain, rate, feed_forward), Limits::NONE);
        for index in 0..CASES / 4 {
            let (before, case) = (case(index + 1, 9.0), case(index, 9.0));
            let mut memory = Memory::at_rest();
            step_on(&controller, &mut memory, &before.state, Target::new(&before.reference)).unwrap();
            // One step of 10 ms at the position error of another case.
            let sum = (twin::wide(&before.state.position_m) - twin::wide(&before.sample.position_m)) * 0.01;
            assert!((twin::wide(&memory.integral_m_s()) - sum).amax() < 2e-9, "{}", memory.integral_m_s());
            let found = step_on(&controller, &mut memory, &case.state, Target::new(&case.reference)).unwrap();
            let fed = feed_forward == FeedForward::With;
            let exact = twin::integral(&exact, &sum, &craft(&case.state), &goal(&case.sample), fed);
            let error = (twin::input(&found.command) - exact).amax() / exact.amax().max(9.81);
            assert!(error < LINEAR[2], "case {index}: {error}");
        }
    }
}

#[test]
fn the_cases_are_independent_in_every_dimension() {
    let columns: SMatrix<f64, 24, 24> = {
        let mut sums = SMatrix::<f64, 24, 24>::zeros();
        for index in 0..CASES {
            let u = SVector::<f64, 24>::from(halton::<24>(index)).map(|u| 2.0 * u - 1.0);
            sums += u * u.transpose();
        }
        sums * (3.0 / f64::from(CASES))
    };
    // Independent numbers would give 1 on the diagonal and 1/sqrt(4000) = 0.016 beside it; neighbouring primes of a Halton
    // sequence run together for the first of their product.
    let off = (columns - SMatrix::identity()).amax();
    assert!(off < 0.1, "{off}");
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
            let state = State {
                position_m: Vector3::new(x, y, z),
                attitude: Quaternion::new(q0, q1, q2, q3),
                velocity_m_s: Vector3::new(vx, vy, vz),
            };
            for law in [&controller, &flat] {
                let refused = step(law, &state, &reference);
                assert!(
                    matches!(refused, Err(StepError::State(StateError::NonFinite { .. }))),
                    "component {component} = {bad}: {refused:?}"
                );
            }
        }
    }
}
