//! `--limits`: a vehicle's name or three numbers in, the core's limits out.

use std::str::FromStr;

use quatrack::Limits;
use quatrack::nalgebra::Vector3;

/// Limits by vehicle or by numbers.
#[derive(Clone, Debug)]
pub(crate) struct LimitsChoice {
    /// As it was asked for.
    pub(crate) name: String,
    /// What a command is cut to.
    pub(crate) limits: Limits,
}

/// Thrust of one motor (lowest, highest, N) and mass (kg) of Bitcraze's vehicles, from their platform definitions.
const VEHICLES: [(&str, f32, f32, f32); 3] = [
    ("crazyflie-2.1", 0.012_818, 0.12, 0.029),
    ("crazyflie-2.1-upgrade", 0.019_226, 0.18, 0.0325),
    ("crazyflie-2.1-brushless", 0.021_363, 0.2, 0.0393),
];

/// What a rate loop of these vehicles follows, rad/s.
const VEHICLE_BODY_RATES_RAD_S: Vector3<f32> = Vector3::new(20.0, 20.0, 10.0);

impl FromStr for LimitsChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let name = text.to_owned();
        if text == "none" {
            return Ok(Self { name, limits: Limits::NONE });
        }
        if let Some((_, min_n, max_n, mass_kg)) = VEHICLES.iter().find(|vehicle| vehicle.0 == text) {
            let limits = Limits::new(4.0 * min_n / mass_kg, 4.0 * max_n / mass_kg, VEHICLE_BODY_RATES_RAD_S)
                .map_err(|error| error.to_string())?;
            return Ok(Self { name, limits });
        }
        let numbers: Result<Vec<f32>, _> = text.split(',').map(|number| number.trim().parse()).collect();
        let Ok([min, max, rate]) = numbers.as_deref() else {
            let vehicles: Vec<&str> = VEHICLES.iter().map(|vehicle| vehicle.0).collect();
            return Err(format!(
                "neither a vehicle ({}), none, nor THRUST_MIN,THRUST_MAX,RATE_MAX in m/s^2 and rad/s",
                vehicles.join(", ")
            ));
        };
        let limits = Limits::new(*min, *max, Vector3::new(*rate, *rate, *rate)).map_err(|error| error.to_string())?;
        Ok(Self { name, limits })
    }
}
