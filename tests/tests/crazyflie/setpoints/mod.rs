//! Every setpoint that the Crazyflie's firmware can send a controller, flown through the C interface on the rigid plant.

mod by_hand;
pub(crate) mod flight;
mod goals;
pub(crate) mod orders;
pub(crate) mod planner;
mod rates;
pub(crate) mod sent;
