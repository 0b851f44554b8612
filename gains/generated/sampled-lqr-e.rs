// sampled-lqr-e for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design 25c79af4507fb0d7700b836dee2615439c7d06a1736a8848118c693ec533d462
// Certificate 6607de307212c4796fc907e467e2ce9d5cb83e2e9894cc81bf27bb9b78711254

/// The paper's weights at hover, under commands held for 2 ms.
#[rustfmt::skip]
pub static SAMPLED_LQR_E: quatrack::law::EquilibriumGain = quatrack::law::EquilibriumGain::table([
    [0.0, 0.0, 93.19272, 0.0, 0.0, 0.0, 0.0, 0.0, 67.296555],
    [0.0, -30.907187, 0.0, 45.249912, 0.0, 0.0, 0.0, -24.903625, 0.0],
    [30.907187, 0.0, 0.0, 0.0, 45.249912, 0.0, 24.903625, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 9.950208, 0.0, 0.0, 0.0],
]);
