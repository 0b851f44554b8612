//! The f32 core against the f64 model and the rigid plant.

mod flatness;
mod headings;
mod laws_beyond;
mod motors;
mod parity;
