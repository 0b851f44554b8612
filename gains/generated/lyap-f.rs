// lyap-f for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design 212e04680409e3dc1a112cbace39d99bec27d66057f62fc9afdd4bddd9228348
// Certificate 8c922c9dd2d59705d15fc60043236d075799880906bf64e92e113f9edd2da6a8

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
