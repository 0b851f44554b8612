// sampled-lqr-f for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design 0bb68458cba2848253807882ce36b1675b66d4e8f83faf5d7f866eea4dffe01b
// Certificate e74ef7acdbd0ea293cda58b000c6f257673bd8264c11748d6c60eb707036778e

/// The paper's weights on the flat chain, under commands held for 2 ms.
#[rustfmt::skip]
pub static SAMPLED_LQR_F: quatrack::law::FlatOutputGain = quatrack::law::FlatOutputGain::table([
    [43.655865, 0.0, 0.0, 23.743849, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 43.655865, 0.0, 0.0, 23.743849, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 43.655865, 0.0, 0.0, 23.743849, 0.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 30.64848, 0.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 30.64848, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 30.64848, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 19.606562],
]);
