// lqi-e for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design 5b190b1498918f9e06c5a23047e59a74dc553c7f21b52164c1aa719521a6eb1f
// Certificate 0a2db55a330485078d83806a272f700c40a48ef956b854c4bce6f57b259d139c

/// The paper's weights at hover with the integral of the position error, under commands held for 2 ms.
#[rustfmt::skip]
pub static LQI_E: quatrack::law::IntegralGain = quatrack::law::IntegralGain::table([
    [0.0, 0.0, 132.77145, 0.0, 0.0, 0.0, 0.0, 0.0, 67.842735, 0.0, 0.0, 65.85861],
    [0.0, -45.859737, 0.0, 46.394432, 0.0, 0.0, 0.0, -26.256348, 0.0, 0.0, -21.841887, 0.0],
    [45.859737, 0.0, 0.0, 0.0, 46.394432, 0.0, 26.256348, 0.0, 0.0, 21.841887, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 9.950208, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
]);
