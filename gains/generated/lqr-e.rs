// lqr-e for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design b9defba39066f48f255dacf568af6481b68f355618f06fdc808f9138fd6f239c
// Certificate 18b347491e250f7bba469d797f0aa5eb9bf4af6685449282b64aaa046a1c3433

/// (LQR-E), equation (21): the paper's weights at hover.
#[rustfmt::skip]
pub static LQR_E: quatrack::law::EquilibriumGain = quatrack::law::EquilibriumGain::table([
    [0.0, 0.0, 100.0, 0.0, 0.0, 0.0, 0.0, 0.0, 72.11102],
    [0.0, -31.622776, 0.0, 45.7951, 0.0, 0.0, 0.0, -25.448412, 0.0],
    [31.622776, 0.0, 0.0, 0.0, 45.7951, 0.0, 25.448412, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 10.0, 0.0, 0.0, 0.0],
]);
