// lyap-f for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design c29fa147c48a2168640ceb33142b47851daa0e5bac089016e9761fd2cfcfb8d1
// Certificate b312d05957ed0e37506631d239440e00a5653bbd74e49220a9a8e6b6ebd9df6e

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
