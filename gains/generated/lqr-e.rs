// lqr-e for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design efff0642daf0fbe800a06c9dbb2e0be75b7519321f6fb85d48c8e3dfbbccf23f
// Certificate e1bf3844f8aa09cf0cc134418fae3cc9ed82094cc70a463cc854aa095395ae39

/// (LQR-E), equation (21): the paper's weights at hover.
#[rustfmt::skip]
pub static LQR_E: quatrack::law::EquilibriumGain = quatrack::law::EquilibriumGain::table([
    [0.0, 0.0, 100.0, 0.0, 0.0, 0.0, 0.0, 0.0, 72.11102],
    [0.0, -31.622776, 0.0, 45.7951, 0.0, 0.0, 0.0, -25.448412, 0.0],
    [31.622776, 0.0, 0.0, 0.0, 45.7951, 0.0, 25.448412, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 10.0, 0.0, 0.0, 0.0],
]);
