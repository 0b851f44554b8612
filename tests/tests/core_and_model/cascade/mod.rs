//! The cascade in flight: the figures that it is held to, on crafts in air; its gains and its certificate.

mod certificate;
mod course;
mod crafts;
mod filter;
mod flight;
mod in_air;
mod noise;
mod plant;
mod survival;
