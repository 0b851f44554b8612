//! Boards: one module for each, with its pins and clocks.

pub mod crazyflie_2_1;
