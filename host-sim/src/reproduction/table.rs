//! Table I, cell by cell: gains and trajectories in; IAE as printed, as published, exact, with the core and with
//! feed-forward out.

use quatrack::{AnyLaw, Equilibrium, ErrorForm, FlatOutput, Limits, Rate, gains::paper};
use serde::Serialize;

use super::published;
use crate::flight::closed_loop::{Flight, SAMPLE_PERIOD_S, Solver, fly_continuous, fly_sampled};
use crate::flight::core_loop::{self, CoreLoop};
use crate::flight::law::{EquilibriumGain, Feedback, FlatOutputGain, Law};
use crate::flight::metrics::Metrics;
use crate::flight::reference::{Exact, Reference, Sampled};
use crate::model::flat::reference_point;
use crate::trajectory::bspline::BSpline;
use crate::trajectory::polynomial::PiecewisePolynomial;

/// tmp
pub fn closed(mu: f64) -> (EquilibriumGain, FlatOutputGain, EquilibriumGain, FlatOutputGain) {
    let g = 9.81;
    let e = |t: [f64; 2], q: [f64; 3], r: f64| {
        let mut k = EquilibriumGain::zeros();
        k[(0, 2)] = t[0];
        k[(0, 8)] = t[1];
        k[(2, 0)] = q[0];
        k[(2, 6)] = q[1];
        k[(2, 4)] = q[2];
        k[(1, 1)] = -q[0];
        k[(1, 7)] = -q[1];
        k[(1, 3)] = q[2];
        k[(3, 5)] = r;
        k
    };
    let f = |r, v, a, q| {
        let mut k = FlatOutputGain::zeros();
        for i in 0..3 {
            k[(i, i)] = r;
            k[(i, i + 3)] = v;
            k[(i + 3, i + 6)] = a;
        }
        k[(6, 9)] = q;
        k
    };
    (
        e([2.0 * mu * mu, 2.0 * mu], [4.0 * mu * mu * mu / g, 6.0 * mu * mu / g, 6.0 * mu], 2.0 * mu),
        f(2.0 * mu * mu, 2.0 * mu, mu, mu),
        e([100.0, 5200.0_f64.sqrt()], [1000.0_f64.sqrt(), 25.4484, 45.7951], 10.0),
        f(2000.0_f64.sqrt(), (500.0 + 2.0 * 2000.0_f64.sqrt()).sqrt(), 1000.0_f64.sqrt(), 20.0),
    )
}
/// tmp
pub fn trial(spline: &BSpline) {
    let (le, lf, qe, qf) = closed(2.0);
    let pubref = Sampled::new(spline, SAMPLE_PERIOD_S, published::reference);
    let exref = Sampled::new(spline, SAMPLE_PERIOD_S, |t, s| reference_point(&t.at(s)));
    let m = |f: Flight| (Metrics::of(&f).iae_m_s, f.lost);
    let pieces = core_loop::pieces(&PiecewisePolynomial::from_bspline(spline));
    for (name, e, f) in [("LYAP", le, lf), ("LQR", qe, qf)] {
        println!("{name}-F pub {:?}", m(fly_continuous(&pubref, |x, t| published::flat_output_input(&f, x, t), Solver::PAPER)));
        println!("{name}-E pub {:?}", m(fly_continuous(&pubref, |x, t| published::equilibrium_input(&e, x, t), Solver::PAPER)));
        for ff in [false, true] {
            for law in [Law::FlatOutput(f), Law::EquilibriumPaper(e), Law::EquilibriumHeading(e)] {
                let fb = Feedback { law, feed_forward: ff };
                println!("{name} ff={ff} sampled {:?}", m(fly_continuous(&exref, |x, t| fb.input(x, t), Solver::PAPER)));
                println!("{name} ff={ff} exact   {:?}", m(fly_continuous(&Exact(spline), |x, t| fb.input(x, t), Solver::PAPER)));
            }
        }
        let (e32, f32_) = if name == "LYAP" { (&paper::LYAP_E, &paper::LYAP_F) } else { (&paper::LQR_E, &paper::LQR_F) };
        for hz in [100, 500, 1000] {
            for ff in [quatrack::FeedForward::Without, quatrack::FeedForward::With] {
                let laws: [AnyLaw; 3] = [
                    FlatOutput { gain: f32_, feed_forward: ff }.into(),
                    Equilibrium { gain: e32, error_form: ErrorForm::Paper, feed_forward: ff }.into(),
                    Equilibrium { gain: e32, error_form: ErrorForm::HeadingFrame, feed_forward: ff }.into(),
                ];
                for law in laws {
                    let mut core = CoreLoop::new(&pieces, Rate::from_hz(hz).unwrap(), law, Limits::NONE).unwrap();
                    let fl = fly_sampled(&Exact(spline), hz, |k, _, x| core.step(k, x));
                    let s = fl.saturated_steps; println!("{name} core {hz} {ff:?} sat {s} {:?}", m(fl));
                }
            }
        }
    }
    for (e, f) in [(closed(1.0).0, closed(1.0).1)] {
        let fl = fly_continuous(&pubref, |x, t| published::equilibrium_input(&e, x, t), Solver::PAPER);
        println!("mu1 E pub {:?}", Metrics::of(&fl));
        let fl = fly_continuous(&exref, |x, t| published::equilibrium_input(&e, x, t), Solver::PAPER);
        println!("mu1 E ex {:?}", Metrics::of(&fl));
        let fl = fly_continuous(&pubref, |x, t| published::flat_output_input(&f, x, t), Solver::PAPER);
        println!("mu1 F pub {:?}", Metrics::of(&fl));
        let fb = Feedback { law: Law::FlatOutput(f), feed_forward: false };
        let fl = fly_continuous(&exref, |x, t| fb.input(x, t), Solver::PAPER);
        println!("mu1 F ex {:?}", Metrics::of(&fl));
    }
}
