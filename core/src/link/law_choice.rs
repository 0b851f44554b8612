//! Which law to fly: a choice as a message holds it in, the law out.

use serde::{Deserialize, Serialize};

use crate::control::Law;
use crate::gains::paper;
use crate::law::{Equilibrium, ErrorForm, FeedForward, FlatOutput};

/// A gain table, and with it the law that it is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Table {
    /// (LYAP-E) of the paper.
    LyapE,
    /// (LQR-E) of the paper.
    LqrE,
    /// (LYAP-F) of the paper.
    LyapF,
    /// (LQR-F) of the paper.
    LqrF,
    /// A loaded one, see [`super::GainStore::table`]: slot 0 is the one in use, slot 1 the one before.
    Loaded(u8),
    /// The cascade's for this craft where no lag of its motors is stated; takes neither feed-forward nor error form.
    Cascade,
}

/// A table and how its law is to be flown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LawChoice {
    /// The gains.
    pub table: Table,
    /// Whether the reference's input is added.
    pub feed_forward: FeedForward,
    /// How the equilibrium law forms its error; the flat output law has one form only.
    pub error_form: ErrorForm,
}

impl LawChoice {
    /// A table without feed-forward, errors in the heading frame.
    pub const fn new(table: Table) -> Self {
        Self { table, feed_forward: FeedForward::Without, error_form: ErrorForm::HeadingFrame }
    }

    /// The law of thrust and body rates, if its table is one of those in the image.
    pub fn built_in(&self) -> Option<Law<'static>> {
        let Self { table, feed_forward, error_form } = *self;
        let equilibrium = |gain| Some(Law::Equilibrium(Equilibrium { gain, error_form, feed_forward }));
        let flat_output = |gain| Some(Law::FlatOutput(FlatOutput { gain, feed_forward }));
        match table {
            Table::LyapE => equilibrium(&paper::LYAP_E),
            Table::LqrE => equilibrium(&paper::LQR_E),
            Table::LyapF => flat_output(&paper::LYAP_F),
            Table::LqrF => flat_output(&paper::LQR_F),
            Table::Loaded(_) | Table::Cascade => None,
        }
    }
}
