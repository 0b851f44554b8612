//! Gain tables as files: written, read back, refused, flown, uploaded, swapped.

mod actuator;
mod cascade;
mod fixture;
mod flight;
mod layout;
mod properties;
mod refusals;
mod schedule;
mod store;
