// sampled-lqr-f for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design 3b34857f644488d2ec2ba8e130acc73421508d63f2aab3d8c6b84381a25e1967
// Certificate 29aae199ff48b8b45d31326f91d4f99f338ef4675fd640a3d44fb7024983d177

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
