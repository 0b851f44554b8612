//! The cascade in flight: the figures that it is held to, on crafts in air.

mod course;
mod crafts;
mod filter;
mod flight;
mod noise;
mod plant;
