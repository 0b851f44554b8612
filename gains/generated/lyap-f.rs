// lyap-f for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design 2bcdc709ddefaf64f5c328c1d8b5b2f15a46d4080b0ad8ced9b0a0251770fd1a
// Certificate b254ae9189499321489ce323cda4fbae2c8a1a7d9b8d5f1632846a114c9e0c5c

/// (LYAP-F), equation (15): every pole of the flat chain at real part -2 1/s.
#[rustfmt::skip]
pub static LYAP_F: quatrack::law::FlatOutputGain = quatrack::law::FlatOutputGain::table([
    [8.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 8.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 8.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0],
]);
