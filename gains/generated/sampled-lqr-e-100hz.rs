// sampled-lqr-e-100hz for crazyflie-2.1 at 100 Hz: made by `quatrack gains design` and not edited by hand.
// Design e925be29062337e88cd3ed1959482d311bcffa5d8fe626cc987bf69db3cb0434
// Certificate 894acd3849a1ab8563c19b70159c409fd41658b320aff9f3feabb23363a82d49

/// The paper's weights at hover, under commands held for 10 ms.
#[rustfmt::skip]
pub static SAMPLED_LQR_E_100HZ: quatrack::law::EquilibriumGain = quatrack::law::EquilibriumGain::table([
    [0.0, 0.0, 72.26332, 0.0, 0.0, 0.0, 0.0, 0.0, 52.493053],
    [0.0, -28.208887, 0.0, 43.149403, 0.0, 0.0, 0.0, -22.846176, 0.0],
    [28.208887, 0.0, 0.0, 0.0, 43.149403, 0.0, 22.846176, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 9.755106, 0.0, 0.0, 0.0],
]);
