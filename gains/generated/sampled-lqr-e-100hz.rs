// sampled-lqr-e-100hz for crazyflie-2.1 at 100 Hz: made by `quatrack gains design` and not edited by hand.
// Design 55cc71e56d8e3f763521c9a5aaa96449299be4f4a8d8e30b6851712c49c54b24
// Certificate defcc6512d1f8a2497a16d1157d7cdc0f542a4cc80e908e1c3ba3de5f02f0b9b

/// The paper's weights at hover, under commands held for 10 ms.
#[rustfmt::skip]
pub static SAMPLED_LQR_E_100HZ: quatrack::law::EquilibriumGain = quatrack::law::EquilibriumGain::table([
    [0.0, 0.0, 72.26332, 0.0, 0.0, 0.0, 0.0, 0.0, 52.493053],
    [0.0, -28.208887, 0.0, 43.149403, 0.0, 0.0, 0.0, -22.846176, 0.0],
    [28.208887, 0.0, 0.0, 0.0, 43.149403, 0.0, 22.846176, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 9.755106, 0.0, 0.0, 0.0],
]);
