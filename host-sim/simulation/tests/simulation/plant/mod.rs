//! The plant in air: alone against analytic mechanics, and beside the plants of other simulators.

mod airborne;
mod contact;
mod motors;
mod peers;
mod refusals;
