//! The paper's four gain tables, Table I: made by `cargo gains generate` and not edited by hand.

use crate::law::{EquilibriumGain, FlatOutputGain};

/// (LYAP-F): Lyapunov design (15) on the flat chain, every pole at real part -2 1/s.
pub static LYAP_F: FlatOutputGain = FlatOutputGain::table([
    [8.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 8.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 8.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0],
]);

/// (LYAP-E): Lyapunov design (17) at the hover equilibrium, every pole at real part -2 1/s.
pub static LYAP_E: EquilibriumGain = EquilibriumGain::table([
    [0.0, 0.0, 8.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0],
    [0.0, -3.2619777, 0.0, 12.0, 0.0, 0.0, 0.0, -2.4464831, 0.0],
    [3.2619777, 0.0, 0.0, 0.0, 12.0, 0.0, 2.4464831, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0],
]);

/// (LQR-F): the Riccati equation (20) on the flat chain, with the paper's weights.
pub static LQR_F: FlatOutputGain = FlatOutputGain::table([
    [44.72136, 0.0, 0.0, 24.278442, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 44.72136, 0.0, 0.0, 24.278442, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 44.72136, 0.0, 0.0, 24.278442, 0.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 31.622776, 0.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 31.622776, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 31.622776, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 20.0],
]);

/// (LQR-E): the Riccati equation (21) at the hover equilibrium, with the paper's weights.
pub static LQR_E: EquilibriumGain = EquilibriumGain::table([
    [0.0, 0.0, 100.0, 0.0, 0.0, 0.0, 0.0, 0.0, 72.11102],
    [0.0, -31.622776, 0.0, 45.7951, 0.0, 0.0, 0.0, -25.448412, 0.0],
    [31.622776, 0.0, 0.0, 0.0, 45.7951, 0.0, 25.448412, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 10.0, 0.0, 0.0, 0.0],
]);
