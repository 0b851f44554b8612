// lqr-f for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design 32ebe9676e83d4da3f1aeff651dd63e0f9c14104aed11308f2122150c1577aa3
// Certificate b1ba11b0eb8890cf3a1fefc8d5f398ce8ec40616c52f0a52babd90c9a5695429

/// (LQR-F), equation (20): the paper's weights on the flat chain.
#[rustfmt::skip]
pub static LQR_F: quatrack::law::FlatOutputGain = quatrack::law::FlatOutputGain::table([
    [44.72136, 0.0, 0.0, 24.278442, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 44.72136, 0.0, 0.0, 24.278442, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 44.72136, 0.0, 0.0, 24.278442, 0.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 31.622776, 0.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 31.622776, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 31.622776, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 20.0],
]);
