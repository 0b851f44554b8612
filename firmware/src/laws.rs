//! The four controllers of the paper: a number in, a law with its table out.

use quatrack::gains::paper;
use quatrack::{AnyLaw, Equilibrium, ErrorForm, FeedForward, FlatOutput};

/// How many there are.
pub const COUNT: u8 = 4;

/// Law `index` in the order of the paper's Table I: LYAP-F, LYAP-E, LQR-F, LQR-E. The E laws form their error as the
/// paper does, so that the flights of the paper come out.
pub fn by_index(index: u8) -> Option<AnyLaw<'static>> {
    let equilibrium = |gain| Equilibrium { gain, error_form: ErrorForm::Paper, feed_forward: FeedForward::Without };
    match index {
        0 => Some(FlatOutput::new(&paper::LYAP_F).into()),
        1 => Some(equilibrium(&paper::LYAP_E).into()),
        2 => Some(FlatOutput::new(&paper::LQR_F).into()),
        3 => Some(equilibrium(&paper::LQR_E).into()),
        _ => None,
    }
}
