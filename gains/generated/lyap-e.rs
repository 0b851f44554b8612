// lyap-e for crazyflie-2.1 at 500 Hz: made by `quatrack gains design` and not edited by hand.
// Design 1f24379242e2c4cea1286c9a050295b0342f05f499076d1bb4ebc38ee7c4a5ee
// Certificate 3cc3b6d490f557c5a6a755f95e4a1aca10dc87d6de0d6475d79c3ab6e244cda5

/// (LYAP-E), equation (17): every pole of the hover model at real part -2 1/s.
#[rustfmt::skip]
pub static LYAP_E: quatrack::law::EquilibriumGain = quatrack::law::EquilibriumGain::table([
    [0.0, 0.0, 8.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0],
    [0.0, -3.2619777, 0.0, 12.0, 0.0, 0.0, 0.0, -2.4464831, 0.0],
    [3.2619777, 0.0, 0.0, 0.0, 12.0, 0.0, 2.4464831, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0],
]);
