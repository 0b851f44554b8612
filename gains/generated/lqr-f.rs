// lqr-f for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design bd9b7318475aae028dc4219e41384bd29e2fe0248cbd32e1f9de60266c482b05
// Certificate 9731ce6d565604fe23b2525afd3442ed55184b82e62ed117276345326d8d642e

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
