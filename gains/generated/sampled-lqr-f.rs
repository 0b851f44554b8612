// sampled-lqr-f for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design eb3d3b29f3c9a9b514ae3b99f6bb4a688bff34636a91ac6f7299bafed885d6c1
// Certificate 88a4081f31dafba99559d55590281cf02119edd57d54b3a8fdacd9d7a0bb492d

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
