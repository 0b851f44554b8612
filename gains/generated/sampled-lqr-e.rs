// sampled-lqr-e for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design 2eabdb5dc49b3d9cc5280c0fe8b4953b50a7c52439e4de07e23ae677c2e5ab08
// Certificate 74d342c5e3573d1b8ad72d8f0a8356b4270cf1529962bd1947063b48a3242b29

/// The paper's weights at hover, under commands held for 2 ms.
#[rustfmt::skip]
pub static SAMPLED_LQR_E: quatrack::law::EquilibriumGain = quatrack::law::EquilibriumGain::table([
    [0.0, 0.0, 93.19272, 0.0, 0.0, 0.0, 0.0, 0.0, 67.296555],
    [0.0, -30.907187, 0.0, 45.249912, 0.0, 0.0, 0.0, -24.903625, 0.0],
    [30.907187, 0.0, 0.0, 0.0, 45.249912, 0.0, 24.903625, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 9.950208, 0.0, 0.0, 0.0],
]);
