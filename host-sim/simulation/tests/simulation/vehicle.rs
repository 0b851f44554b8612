//! Vehicles: the built-in files, derived figures, and refusals.

use quatrack_design::vehicle::VehicleError;
use quatrack_simulation::vehicles::{self, VehicleFileError};

const TEXT: &str = include_str!("../../../../gains/vehicles/crazyflie-2.1.toml");

#[test]
fn the_board_flies_tables_for_the_vehicle_that_they_are_designed_for() {
    let vehicle = vehicles::by_name("crazyflie-2.1").expect("built in");
    // The image is built for the target alone, so its source is read.
    let source = include_str!("../../../../firmware/src/vehicle.rs");
    let declared = source.lines().find(|line| line.starts_with("pub const VEHICLE: Vehicle")).expect("declared");
    assert!(declared.contains(&format!("Name::literal(\"{}\")", vehicle.name())), "{declared}");
    let id = declared.split_once("id: 0x").and_then(|(_, rest)| rest.split_once(' ')).expect("an id").0;
    assert_eq!(
        u32::from_str_radix(&id.replace('_', ""), 16),
        Ok(vehicles::id(&vehicle)),
        "gains/vehicles/crazyflie-2.1.toml"
    );
}

#[test]
fn a_vehicle_written_and_read_again_is_the_same() {
    // All built-in files, one with every optional table, and a number that no decimal of less than 17 digits is.
    let vehicles = vehicles::names().map(|name| vehicles::by_name(name).expect("built in"));
    let text = TEXT.replace("mass_kg = 0.029", "mass_kg = 0.028999999999999998");
    let text =
        format!("{text}\n[identified.mass_kg]\nlow = 0.1\nhigh = 0.30000000000000004\nsource = \"a \\\"log\\\"\"\n");
    let own = vehicles::from_toml(&text).expect("in range");
    assert!(own.mass_kg() < 0.029 && own.identified().len() == 1, "{own:?}");
    for vehicle in vehicles.into_iter().chain([own]) {
        let written = vehicles::to_toml(&vehicle).expect("TOML holds it");
        assert_eq!(vehicles::from_toml(&written), Ok(vehicle), "{written}");
    }
}

#[test]
fn built_in_vehicles_hover_between_their_limits() {
    for name in vehicles::names() {
        let vehicle = vehicles::by_name(name).expect("built in");
        // A table carries 31 bytes.
        assert!(vehicle.name().len() <= 31 && name.starts_with(vehicle.name().trim_end_matches("-45g")), "{name}");
        assert_eq!(vehicles::by_name(vehicle.name()), Ok(vehicle.clone()));
        let [min, max] = vehicle.thrust_limits_m_s2();
        assert!(min < 9.81 && max > 1.5 * 9.81, "{name}: {min} to {max} m/s^2");
        assert!(vehicles::limits(&vehicle).is_ok());
        let [shortest, longest] = vehicle.motors().published_lag_s;
        assert!((shortest..=longest).contains(&vehicle.motors().lag_s), "{name}");
    }
}

#[test]
fn the_crazyflie_has_the_firmware_s_figures() {
    let vehicle = vehicles::by_name("crazyflie-2.1").expect("built in");
    // 0.029 kg * 9.81 m/s^2 / 4.
    assert!((vehicle.hover_thrust_n() - 0.071_122_5).abs() < 1e-15);
    let mixing = vehicle.motors().mixing();
    let (a, c) = (0.046 / 2.0_f64.sqrt(), 0.006_992_894_899_247_056_5);
    // Rows: thrust, and the signs of the firmware's motor mixing for roll, pitch and yaw.
    let signs = [[1.0; 4], [-1.0, -1.0, 1.0, 1.0], [-1.0, 1.0, 1.0, -1.0], [-1.0, 1.0, -1.0, 1.0]];
    for (row, size) in [1.0, a, a, c].into_iter().enumerate() {
        for motor in 0..4 {
            assert!((mixing[(row, motor)] - size * signs[row][motor]).abs() < 1e-17, "({row}, {motor})");
        }
    }
}

#[test]
fn the_id_tells_figures_and_names_apart_and_ignores_comments() {
    let id = |text: &str| vehicles::id(&vehicles::from_toml(text).expect("valid"));
    let known = id(TEXT);
    assert_eq!(known, id(&format!("# another comment\n{TEXT}")));
    assert_ne!(known, id(&TEXT.replace("mass_kg = 0.029", "mass_kg = 0.0291")));
    assert_ne!(known, id(&TEXT.replace("name = \"crazyflie-2.1\"", "name = \"mine\"")));
    assert_ne!(known, id(&TEXT.replace("\nlag_s = 0.126", "\nlag_s = 0.1")));
    let all = vehicles::names().map(|name| vehicles::id(&vehicles::by_name(name).expect("built in")));
    assert!((0..4).all(|i| (0..i).all(|j| all[i] != all[j])));
}

#[test]
fn refusals_name_the_field() {
    let refused = |from: &str, to: &str| {
        assert!(TEXT.contains(from), "{from}");
        vehicles::from_toml(&TEXT.replace(from, to)).expect_err("refused")
    };
    let field = |from: &str, to: &str| match refused(from, to) {
        VehicleFileError::Refused(VehicleError::Value { field, .. }) => field,
        other => panic!("{other}"),
    };
    assert_eq!(field("mass_kg = 0.029", "mass_kg = -0.029"), "body.mass_kg");
    assert_eq!(field("mass_kg = 0.029", "mass_kg = nan"), "body.mass_kg");
    assert_eq!(field("thrust_max_n = 0.12", "thrust_max_n = 0.07"), "motors.thrust_max_n");
    assert_eq!(field("thrust_min_n = 0.0128", "thrust_min_n = 0.128"), "motors.thrust_min_n");
    assert_eq!(field("[16.571710e-6, 0.0,", "[16.571710e-6, 1e-6,"), "body.inertia_kg_m2");
    // A body cannot be heavier about one axis than about the two others together.
    assert_eq!(field("29.261652e-6", "34e-6"), "body.inertia_kg_m2");
    assert_eq!(field("[0.0635, 0.126]", "[0.126, 0.0635]"), "motors.published_lag_s");
    assert_eq!(field("[20.0, 20.0, 10.0]", "[20.0, 0.0, 10.0]"), "limits.body_rates_rad_s");
    let at = 1 + TEXT.lines().position(|line| line.starts_with("arm_m")).expect("is there");
    assert!(matches!(refused("\narm_m", "\narm_mm"), VehicleFileError::Syntax { line, .. } if line == at));
    let unknown = vehicles::by_name("crazyflie").expect_err("refused").to_string();
    assert!(unknown.contains("crazyflie-2.1-upgrade-kit"), "{unknown}");
}

#[test]
fn figures_of_flight_are_no_part_of_the_identity() {
    let id = |text: &str| vehicles::id(&vehicles::from_toml(text).expect("valid"));
    let (designed, flown) = TEXT.split_once("\n[motors.flown]").expect("has them");
    let (_, limits) = flown.split_once("\n[limits]").expect("has them");
    let without = format!("{designed}\n[limits]{limits}");
    assert_eq!(id(&without), id(TEXT));
    let bare = vehicles::from_toml(&without).expect("valid");
    assert!(bare.flown().air.is_none() && vehicles::from_toml(TEXT).expect("valid").flown().air.is_some());
}

#[test]
fn a_figure_in_another_unit_is_the_one_that_is_named() {
    let refused = |changes: &[(&str, &str)]| {
        let text = changes.iter().fold(TEXT.to_owned(), |text, (from, to)| {
            assert!(text.contains(from), "{from}");
            text.replace(from, to)
        });
        vehicles::from_toml(&text).expect_err("refused").to_string()
    };
    let inertia = |unit: &str| {
        refused(&[
            ("16.571710e-6", &format!("16.571710{unit}")),
            ("16.655602e-6", &format!("16.655602{unit}")),
            ("29.261652e-6", &format!("29.261652{unit}")),
        ])
    };
    let cases = [
        (
            refused(&[("mass_kg = 0.029", "mass_kg = 29.0")]),
            "vehicle: body.mass_kg = 29: must be from ",
            "29 g are 0.029",
        ),
        (refused(&[("arm_m = 0.046", "arm_m = 46.0")]), "vehicle: motors.arm_m = 46: must be from ", "46 mm are 0.046"),
        // Centimetres and decimetres: the torque per thrust is 0.15 of the true arm, as on other craft.
        (refused(&[("arm_m = 0.046", "arm_m = 4.6")]), "vehicle: motors.arm_m = 4.6: must be from ", "46 mm are 0.046"),
        (
            refused(&[("arm_m = 0.046", "arm_m = 0.46")]),
            "vehicle: motors.arm_m = 0.46: must be from ",
            "46 mm are 0.046",
        ),
        (
            refused(&[("torque_per_thrust_m = 0.0069928948992470565", "torque_per_thrust_m = 6.99")]),
            "vehicle: motors.torque_per_thrust_m = 6.99: must be from 2.30e-4 to 4.60e-2 ",
            "5.7 mm are 0.0057",
        ),
        (
            refused(&[("thrust_max_n = 0.12", "thrust_max_n = 12.2")]),
            "vehicle: motors.thrust_max_n = 12.2: must be above 0.071123 N",
            "20 g",
        ),
        (
            refused(&[("[20.0, 20.0, 10.0]", "[1146.0, 1146.0, 573.0]")]),
            "vehicle: limits.body_rates_rad_s = 1146: must be from 0.1 to 60 ",
            "1146 degrees a second are 20",
        ),
        (
            refused(&[("full_n = 0.124", "full_n = 12.4")]),
            "vehicle: motors.force.full_n = 12.4: must be from 0.06 to 0.24 ",
            "thrust_max_n",
        ),
        (
            refused(&[("full_n = 0.124", "full_n = 0.0124")]),
            "vehicle: motors.force.full_n = 0.0124: must be from 0.06 to 0.24 ",
            "thrust_max_n",
        ),
        (inertia(""), "vehicle: body.inertia_kg_m2 = ", "kg m^2"),
        (inertia("e-9"), "vehicle: body.inertia_kg_m2 = ", "kg m^2"),
        (
            refused(&[("\nlag_s = 0.126", "\nlag_s = 126.0")]),
            "vehicle: motors.lag_s = 126: must be from 0.001 to 1 ",
            "67 ms",
        ),
        (
            refused(&[("rise_lag_s = 0.067", "rise_lag_s = 67.0")]),
            "vehicle: motors.flown.rise_lag_s = 67: must be",
            "67 ms",
        ),
        (
            refused(&[("drag_per_s = [0.39", "drag_per_s = [39.0")]),
            "vehicle: air.drag_per_s = 39: must be from 0 to 10",
            "mass",
        ),
        (
            refused(&[("capacity_a_h = 0.25", "capacity_a_h = -0.25")]),
            "vehicle: battery.capacity_a_h = -0.25: must be",
            "0.25",
        ),
    ];
    for (found, start, remedy) in cases {
        assert!(found.starts_with(start) && found.contains(remedy) && found.lines().count() == 1, "{found}");
    }
    // Ranges are those of the body: 0.029 kg (0.1 * 0.046 m)^2 and 9e2 times that.
    assert!(inertia("").contains("from 6.14e-7 to 5.52e-4 "), "{}", inertia(""));
    let unknown = refused(&[("\n[air]\n", "\n[air]\ndensity = 1.2\n")]);
    assert!(unknown.contains("density") && unknown.lines().count() == 1, "{unknown}");
    let control = refused(&[("name = \"crazyflie-2.1\"", "name = \"a\\nb\"")]);
    assert!(control.contains("name = \"a?b\"") && control.lines().count() == 1, "{control}");
}

#[test]
fn a_refusal_names_the_file() {
    let path = std::env::temp_dir().join(format!("quatrack-vehicle-{}.toml", std::process::id()));
    std::fs::write(&path, TEXT.replace("arm_m = 0.046", "arm_m = 46.0")).expect("written");
    let found = vehicles::from_file(&path).expect_err("refused").to_string();
    std::fs::remove_file(&path).expect("removed");
    assert!(found.starts_with(&format!("{}: vehicle: motors.arm_m = 46", path.display())), "{found}");
}
