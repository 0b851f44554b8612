//! Gain tables made offline: constants in the image, checked when it is compiled.

pub mod paper;
