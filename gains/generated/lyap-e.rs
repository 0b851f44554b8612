// lyap-e for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design 0c1ab3c0feda6d5b685d3816c166d70cd17d19d5b89b1eebf69df5370e2ac83d
// Certificate d0a597b8415f544cb782e97da65ae8c3284f1e0ec969ae2bbba45e8c927344f9

/// (LYAP-E), equation (17): every pole of the hover model at real part -2 1/s.
#[rustfmt::skip]
pub static LYAP_E: quatrack::law::EquilibriumGain = quatrack::law::EquilibriumGain::table([
    [0.0, 0.0, 8.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0],
    [0.0, -3.2619777, 0.0, 12.0, 0.0, 0.0, 0.0, -2.4464831, 0.0],
    [3.2619777, 0.0, 0.0, 0.0, 12.0, 0.0, 2.4464831, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0],
]);
