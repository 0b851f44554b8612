//! Rivals beside other tools' figures, scenarios, and the table in which laws are compared.

mod drone_controllers;
mod ours;
mod plants;
mod scenario;
