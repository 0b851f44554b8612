//! Every setpoint that the Crazyflie's firmware can send a controller, flown through the C interface on the rigid plant.

mod by_hand;
mod flight;
mod goals;
mod orders;
mod planner;
mod sent;
