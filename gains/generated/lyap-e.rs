// lyap-e for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design 2266f2cb5e02c4da32afecafaa087d771e04f52e7a3afb060ca466d8146b5719
// Certificate 1c99aa863c0be550733e6d090908ccd55dd65aba746b6b8db473f361798501ac

/// (LYAP-E), equation (17): every pole of the hover model at real part -2 1/s.
#[rustfmt::skip]
pub static LYAP_E: quatrack::law::EquilibriumGain = quatrack::law::EquilibriumGain::table([
    [0.0, 0.0, 8.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0],
    [0.0, -3.2619777, 0.0, 12.0, 0.0, 0.0, 0.0, -2.4464831, 0.0],
    [3.2619777, 0.0, 0.0, 0.0, 12.0, 0.0, 2.4464831, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0],
]);
