//! Tests across packages: the f32 core against the f64 model, the rigid plant and
//! real flights, and the layers of every crate.

mod cascade;
mod estimator;
mod headings;
mod layers;
mod motors;
mod parity;
