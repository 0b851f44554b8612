// sampled-lqr-e for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design a6674cba188f3b51f8a220e4731a575f58b5ea4d92e98146bac3a60c2eed3d84
// Certificate 5ec294f278d1992083e6793207672dc9be1ad77f43d93867a46990dfb59cc348

/// The paper's weights at hover, under commands held for 2 ms.
#[rustfmt::skip]
pub static SAMPLED_LQR_E: quatrack::law::EquilibriumGain = quatrack::law::EquilibriumGain::table([
    [0.0, 0.0, 93.19272, 0.0, 0.0, 0.0, 0.0, 0.0, 67.296555],
    [0.0, -30.907187, 0.0, 45.249912, 0.0, 0.0, 0.0, -24.903625, 0.0],
    [30.907187, 0.0, 0.0, 0.0, 45.249912, 0.0, 24.903625, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 9.950208, 0.0, 0.0, 0.0],
]);
