//! Hover and track at every heading: the closed loop of the core is the same wherever the craft's nose points.

use std::f64::consts::{PI, TAU};

use quatrack::gains::paper;
use quatrack::nalgebra::Vector3;
use quatrack::{
    Controller, Equilibrium, ErrorForm, FeedForward, FlatOutput, Law, Limits, Quaternion, Rate, Reference, State,
};
use quatrack_design::model::StateVector;
use quatrack_design::model::flat::FlatSample;
use quatrack_plan::trajectory::Trajectory;
use quatrack_plan::trajectory::on_board;
use quatrack_plan::trajectory::polynomial::{Piece, PiecewisePolynomial};
use quatrack_simulation::flight::closed_loop::{Flight, LOST_M, fly_sampled};
use quatrack_simulation::flight::core_loop::CoreLoop;
use quatrack_simulation::flight::metrics::Metrics;
use quatrack_simulation::flight::reference::Exact;
use quatrack_tests::core_step::step;

const RATE_HZ: u32 = 500;

fn laws(feed_forward: FeedForward) -> [(&'static str, Law<'static>); 4] {
    let equilibrium = |gain| Equilibrium { gain, error_form: ErrorForm::HeadingFrame, feed_forward };
    let flat = |gain| FlatOutput { gain, feed_forward };
    [
        ("LYAP-E", equilibrium(&paper::LYAP_E).into()),
        ("LQR-E", equilibrium(&paper::LQR_E).into()),
        ("LYAP-F", flat(&paper::LYAP_F).into()),
        ("LQR-F", flat(&paper::LQR_F).into()),
    ]
}

/// Half a metre along the diagonal and up, rest to rest in 4 s, while the heading goes from one angle to another.
fn move_and_turn(from_rad: f64, to_rad: f64) -> PiecewisePolynomial {
    let duration_s: f64 = 4.0;
    // 35 s^4 - 84 s^5 + 70 s^6 - 20 s^7 goes from 0 to 1 with three derivatives zero at both ends.
    let step = |from: f64, to: f64| {
        let mut c = [0.0; 8];
        c[0] = from;
        for (power, k) in [(4, 35.0), (5, -84.0), (6, 70.0), (7, -20.0)] {
            c[power] = (to - from) * k / duration_s.powi(power as i32);
        }
        c
    };
    let coefficients = [step(0.0, 0.5), step(0.0, 0.5), step(0.0, 0.3), step(from_rad, to_rad)];
    PiecewisePolynomial::new(vec![Piece { duration_s, coefficients }]).unwrap()
}

fn fly(
    trajectory: &dyn Trajectory,
    pieces: &PiecewisePolynomial,
    law: Law<'_>,
    disturb: impl Fn(u32, &StateVector) -> StateVector,
) -> Flight {
    let pieces = on_board::pieces(pieces);
    let mut core = CoreLoop::new(&pieces, Rate::from_hz(RATE_HZ).unwrap(), law, Limits::NONE).unwrap();
    fly_sampled(&Exact(trajectory), RATE_HZ, LOST_M, |tick, _, x| core.step(tick, &disturb(tick, x)))
}

/// The same trajectory from a place beside it: the craft starts off its reference by so many metres.
struct Beside<'a>(&'a PiecewisePolynomial, Vector3<f64>);

impl Trajectory for Beside<'_> {
    fn duration_s(&self) -> f64 {
        self.0.duration_s()
    }

    fn at(&self, t_s: f64) -> FlatSample {
        let mut sample = self.0.at(t_s);
        if t_s == 0.0 {
            sample.position_m += self.1;
        }
        sample
    }
}

#[test]
fn an_offset_at_hover_dies_out_at_sixteen_headings() {
    for (name, law) in laws(FeedForward::Without) {
        for k in 0..16 {
            let heading = TAU * f64::from(k) / 16.0 - PI;
            let hover = {
                let mut coefficients = [[0.0; 8]; 4];
                coefficients[3][0] = heading;
                PiecewisePolynomial::new(vec![Piece { duration_s: 8.0, coefficients }]).unwrap()
            };
            // The flat chain (F-LTI) drives position by the thrust's size alone: F does not see a lateral offset.
            let lateral = if matches!(law, Law::Equilibrium(_)) { 1.0 } else { 0.0 };
            let offset = Vector3::new(0.3 * lateral, -0.2 * lateral, 0.1);
            let flight = fly(&Beside(&hover, offset), &hover, law, |_, x| *x);
            let error = flight.samples.last().unwrap().position_error_m().norm();
            // 0.37 m at the slowest pole, 1.4 1/s (LQR-E, vertical), over 8 s: e^-11 of it, and some overshoot.
            assert!(flight.lost.is_none() && error < 1e-4, "{name} at {heading:.2} rad: {error} m left");
        }
    }
}

#[test]
fn tracking_does_not_depend_on_the_heading() {
    for feed_forward in [FeedForward::Without, FeedForward::With] {
        for (name, law) in laws(feed_forward) {
            // The path lies at 45 degrees, so turning the craft by a half turn mirrors its axes: the paper's gains are
            // the same along both.
            let at_zero = iae(&move_and_turn(0.0, 0.0), law);
            for k in 1..16 {
                let heading = TAU * f64::from(k) / 16.0 - PI;
                let found = iae(&move_and_turn(heading, heading), law);
                // The symmetric model gives the same flight to rounding; f32 leaves 1e-6 m of noise over 4 s.
                assert!(
                    (found - at_zero).abs() < 2e-5 + 1e-3 * at_zero,
                    "{name} at {heading:.2}: {found}, not {at_zero}"
                );
            }
        }
    }
}

#[test]
fn tracking_goes_on_through_half_a_turn() {
    for (name, law) in laws(FeedForward::With) {
        let straight = iae(&move_and_turn(0.0, 0.0), law);
        for (from, to) in [(PI - 1.0, PI + 1.0), (-PI + 1.0, -PI - 1.0), (3.0 * PI - 1.0, 3.0 * PI + 1.0), (0.0, TAU)] {
            let turning = iae(&move_and_turn(from, to), law);
            // In a turn, half a period of hold at a heading rate of up to 3.4 rad/s costs millimetres.
            assert!(turning < straight + 0.02, "{name} from {from:.2} to {to:.2} rad: {turning} beside {straight}");
        }
    }
}

#[test]
fn the_sign_of_the_measured_quaternion_does_not_matter() {
    for (name, law) in laws(FeedForward::With) {
        let trajectory = move_and_turn(PI - 1.5, PI + 1.5);
        let flip = |tick: u32, x: &StateVector| {
            let mut x = *x;
            if tick.is_multiple_of(3) {
                x.fixed_rows_mut::<4>(3).neg_mut();
            }
            x
        };
        let plain = fly(&trajectory, &trajectory, law, |_, x| *x);
        let flipped = fly(&trajectory, &trajectory, law, flip);
        for (a, b) in plain.samples.iter().zip(&flipped.samples) {
            assert_eq!(a.input, b.input, "{name} at {} s", a.time_s);
        }
    }
}

#[test]
fn both_signs_give_one_command_over_many_attitudes() {
    let reference = Reference::hover(Vector3::new(0.0, 0.0, 1.0), 0.4).unwrap();
    for (name, law) in laws(FeedForward::Without) {
        let controller = Controller::new(law, Limits::NONE);
        for case in 0..2000 {
            let u = quatrack_tests::halton::<4>(case).map(|v| (2.0 * v - 1.0) as f32);
            let norm = u.iter().map(|v| v * v).sum::<f32>().sqrt();
            let [w, x, y, z] = u.map(|v| v / norm);
            let at = |q: Quaternion| State { attitude: q, ..State::at_rest(Vector3::new(0.1, 0.2, 0.9)) };
            let q = Quaternion::new(w, x, y, z);
            let (plus, minus) = (step(&controller, &at(q), &reference), step(&controller, &at(-q), &reference));
            assert_eq!(plus, minus, "{name} at {q:?}");
        }
    }
}

fn iae(trajectory: &PiecewisePolynomial, law: Law<'_>) -> f64 {
    Metrics::of(&fly(trajectory, trajectory, law, |_, x| *x)).iae_m_s.unwrap()
}
