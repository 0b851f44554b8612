// sampled-lqr-e-100hz for crazyflie-2.1 at 100 Hz: made by `quatrack gains design` and not edited by hand.
// Design 7941a3b09a09f3d0f6ac8d50d3eb27656d8f002e9ca8721441805004fdaaf49d
// Certificate b5ddc833a3a0ef67ba891ef0b190afb870c835c0d9413abe056350fbb63c7045

/// The paper's weights at hover, under commands held for 10 ms.
#[rustfmt::skip]
pub static SAMPLED_LQR_E_100HZ: quatrack::law::EquilibriumGain = quatrack::law::EquilibriumGain::table([
    [0.0, 0.0, 72.26332, 0.0, 0.0, 0.0, 0.0, 0.0, 52.493053],
    [0.0, -28.208887, 0.0, 43.149403, 0.0, 0.0, 0.0, -22.846176, 0.0],
    [28.208887, 0.0, 0.0, 0.0, 43.149403, 0.0, 22.846176, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 9.755106, 0.0, 0.0, 0.0],
]);
