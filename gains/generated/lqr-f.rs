// lqr-f for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design 417e07b902c5c2e9ae7fe433eb910c2511f2c2079bc98a4b0d4c41c66f6d690f
// Certificate 7dde7a0eed3b01a854b52f50d164b6af51950420fc77d41a9f2428acbb8c1996

/// (LQR-F), equation (20): the paper's weights on the flat chain.
#[rustfmt::skip]
pub static LQR_F: quatrack::law::FlatOutputGain = quatrack::law::FlatOutputGain::table([
    [44.72136, 0.0, 0.0, 24.278442, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 44.72136, 0.0, 0.0, 24.278442, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 44.72136, 0.0, 0.0, 24.278442, 0.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 31.622776, 0.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 31.622776, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 31.622776, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 20.0],
]);
