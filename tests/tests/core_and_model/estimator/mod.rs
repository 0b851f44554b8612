//! The estimator of the core: beside a twin in f64, its consistency in simulation, hostile inputs, real flights.

mod consistency;
mod crazyflie;
mod hostile;
mod real_flights;
mod simulation;
mod twin;
