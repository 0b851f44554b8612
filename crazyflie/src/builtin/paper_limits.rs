//! Scales and motor lags with which the paper's tables are flown: made by `cargo gains generate` and not edited by hand.

use super::Certified;

/// gains/lyap-e.toml: factor from its certificate; longest lag (s) with which hover is stable behind the rate loop.
pub(crate) const LYAP_E: Certified = (2.4, 0.0687);

/// gains/lqr-e.toml: factor from its certificate; longest lag (s) with which hover is stable behind the rate loop.
pub(crate) const LQR_E: Certified = (3.506, 0.0218);

/// gains/lyap-f.toml: factor from its certificate; longest lag (s) with which it has flown; none is certified.
pub(crate) const LYAP_F: Certified = (3.714, 0.02);

/// gains/lqr-f.toml: factor from its certificate; longest lag (s) with which it has flown; none is certified.
pub(crate) const LQR_F: Certified = (14.71, 0.02);
