// lqr-e for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design f026623a14bbfd48f75caf37d954ce5e29749af81b27b05e82de0b31d5cdcebb
// Certificate fc705af3eee7bb4c543d136d97917c3d61178ff90b47ecfd0c7ae24e29136b1c

/// (LQR-E), equation (21): the paper's weights at hover.
#[rustfmt::skip]
pub static LQR_E: quatrack::law::EquilibriumGain = quatrack::law::EquilibriumGain::table([
    [0.0, 0.0, 100.0, 0.0, 0.0, 0.0, 0.0, 0.0, 72.11102],
    [0.0, -31.622776, 0.0, 45.7951, 0.0, 0.0, 0.0, -25.448412, 0.0],
    [31.622776, 0.0, 0.0, 0.0, 45.7951, 0.0, 25.448412, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 10.0, 0.0, 0.0, 0.0],
]);
