//! Whether a loop is stable, by the argument of its return difference and by its poles, over random loops.

use super::super::plant::{Controller, Plant};
use super::*;
use crate::analysis::eigenvalues;

/// Numbers between -1 and 1 (Knuth's linear congruential generator).
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

#[test]
fn the_argument_and_the_poles_agree_on_stability() {
    let mut state = 1_u64;
    let (mut stable, mut unstable) = (0, 0);
    for case in 0..300 {
        let (n, m) = (1 + case % 4, 1 + case % 3);
        let mut matrix = |rows, columns, size: f64| DMatrix::from_fn(rows, columns, |_, _| size * random(&mut state));
        let plant = Plant::new(matrix(n, n, 1.5), matrix(n, m, 1.0)).expect("finite");
        let gain = matrix(m, n, 2.0);
        let past_command_gains = (0..case % 3).map(|_| matrix(m, m, 0.4)).collect();
        let given = LinearLoop::new(&plant, &Controller { gain, past_command_gains, predictor: None });
        let timing = Timing { period_s: 0.1, delay_samples: case % 2 };
        let delays: Vec<f64> = (0..m).map(|_| 0.3 * random(&mut state).abs()).collect();
        let held = SampledLoop::new(&given, &timing, &delays).expect("finite");
        let poles = eigenvalues(&held.closed_loop()).expect("found");
        let radius = poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
        assert_eq!(held.is_stable(), radius < 1.0, "case {case}: radius {radius}");
        if radius < 1.0 { stable += 1 } else { unstable += 1 }
    }
    assert!(stable > 30 && unstable > 30, "both answers were asked for: {stable}, {unstable}");
}
