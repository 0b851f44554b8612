//! What no package can test alone: the f32 core against the f64 model and the rigid plant, and the layers of every crate.

mod headings;
mod layers;
mod motors;
mod parity;
