//! `quatrack pil`: the image on the emulated board, and everything that can be wrong with either.

mod counts;
mod emulated;
mod failures;
mod faults;
mod gain_tables;
mod hard_fault;
mod keyed;
mod motors;
mod support;
mod two_ways;
