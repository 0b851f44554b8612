//! Crafts that the object does not know as they are: other masses, and vehicle files with tables of their own.

use std::path::Path;
use std::sync::atomic::Ordering::Relaxed;

use nalgebra::Vector3;
use quatrack::gains::table::GainTable;
use quatrack_crazyflie::abi::Setpoint;
use quatrack_crazyflie::craft::{KNOWN, Platform};
use quatrack_crazyflie::ffi;
use quatrack_crazyflie::own_craft::{OwnCraft, OwnCraftError};
use quatrack_crazyflie::upload::Status;
use quatrack_design::model::GRAVITY_M_S2;
use quatrack_design::vehicle::Vehicle;
use quatrack_simulation::crazyflie::{
    Case, Course, Firmware, FlightErrors, Setpoints, Tune, craft_header, fly_on, own_craft, platform, standard_design,
};
use quatrack_simulation::gains::{Certified, Design};
use quatrack_simulation::plant::RigidState;
use quatrack_simulation::vehicles;

use super::tables::QUIET;
use super::uploads::send_for_words;

/// The figure eight of 2.1 m/s, in vacuum.
const EIGHT: Course = Course::FigureEight(1.485);

fn eight(firmware: &mut Firmware, vehicle: &Vehicle, case: &Case) -> FlightErrors {
    fly_on(firmware, vehicle, &EIGHT, case)
}

#[test]
fn any_stated_mass_within_the_certificate_flies() {
    for (name, lag_s, masses_kg) in [
        // As crazyflow and RotorPy have it with guards; with decks as in the IDSIA benchmark; the most that is taken.
        ("crazyflie-2.1-brushless", 0.05, &[0.0434, 0.044, 0.045, 0.0471][..]),
        ("crazyflie-2.1-upgrade-kit", 0.09, &[0.0379, 0.026]),
        // With a deck for motion capture; as NanoBench flew it; the least.
        ("crazyflie-2.1", 0.1, &[0.034, 0.027, 0.0233]),
    ] {
        let vehicle = vehicles::by_name(name).unwrap();
        for mass_kg in masses_kg {
            let tune = Tune::new(0, lag_s).in_vacuum();
            let mut firmware = Firmware::start_told(&vehicle, *mass_kg, &tune, QUIET).expect(name);
            let case = Case { mass_factor: mass_kg / vehicle.mass_kg(), ..Case::of_lag(lag_s) };
            let flown = eight(&mut firmware, &vehicle, &case);
            // As close as with the vehicle's own mass, of which `flights` has the figure: the mass is fed forward.
            assert!(flown.iae.is_some_and(|iae| iae <= 0.0023), "{name} of {mass_kg} kg: {flown:?}");
        }
    }
    // More than a fifth off changes the inertia by more than is certified.
    let vehicle = vehicles::by_name("crazyflie-2.1").unwrap();
    assert!(Firmware::start_told(&vehicle, 0.0349, &Tune::new(0, 0.0), QUIET).is_none());
}

fn file(name: &str) -> Vehicle {
    vehicles::from_file(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../gains/vehicles").join(name)).unwrap()
}

/// A quadrotor of 120 g on a Bolt, whose ESCs make force of throttle in proportion.
const BOLT: &str = "name = \"bolt-120g\"\n[body]\nmass_kg = 0.12\n\
     inertia_kg_m2 = [[1.6e-4, 0.0, 0.0], [0.0, 1.7e-4, 0.0], [0.0, 0.0, 2.9e-4]]\n[motors]\narm_m = 0.075\n\
     thrust_min_n = 0.03\nthrust_max_n = 0.75\ntorque_per_thrust_m = 0.008\nlag_s = 0.05\npublished_lag_s = [0.03, 0.05]\n\
     [limits]\nbody_rates_rad_s = [20.0, 20.0, 10.0]\n";

fn certified(vehicle: &Vehicle) -> Certified {
    standard_design(vehicle).and_then(|design| design.certify()).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_vehicle_file_flies_with_its_own_table() {
    for vehicle in [
        file("crazyflie-2.1-legacy.toml"),
        file("crazyflie-2.1-brushless-45g.toml"),
        vehicles::from_toml(BOLT).unwrap(),
    ] {
        let own = own_craft(&certified(&vehicle)).unwrap();
        let built_for = platform(&vehicle);
        let tune = Tune::new(0, 0.0).in_vacuum();
        let mut firmware = Firmware::start_own(&vehicle, &built_for, &own, &tune, QUIET).unwrap();
        let lag_s = GainTable::from_bytes(&own.table).unwrap().cascade().unwrap().motor_lag_s;
        let flown = eight(&mut firmware, &vehicle, &Case::of_lag(lag_s.into()));
        println!("{}: {flown:?}", vehicle.name());
        assert!(flown.iae.is_some_and(|iae| iae <= 0.0023), "{}: {flown:?}", vehicle.name());
        // A lag that it is not certified for is refused, and the table in the air stays.
        drop(firmware);
        let firmware = Firmware::start_own(&vehicle, &built_for, &own, &Tune::new(0, 0.3), QUIET).unwrap();
        let log = &ffi::quatrack.log;
        let refusal = log.refusal.load(Relaxed);
        assert_eq!(refusal, quatrack_crazyflie::tables::Refusal::MotorLag as u16);
        drop(firmware);
    }
}

#[test]
fn figures_that_do_not_fit_together_are_refused_in_words() {
    let vehicle = file("crazyflie-2.1-legacy.toml");
    let own = own_craft(&certified(&vehicle)).unwrap();
    let built_for = platform(&vehicle);
    let refused = |built_for: Platform, own: OwnCraft, error: OwnCraftError| {
        let words = Firmware::start_own(&vehicle, &built_for, &own, &Tune::new(0, 0.0), QUIET).err();
        assert_eq!(words, Some(error.words().to_string_lossy().into_owned()));
    };
    // Built for the propellers of the 2.1+.
    let other = KNOWN[0].airframe.figures().torque_per_thrust_m;
    refused(Platform { torque_per_thrust_m: other, ..built_for }, own, OwnCraftError::TorquePerThrust);
    refused(Platform { arm_m: 0.05, ..built_for }, own, OwnCraftError::Arm);
    refused(Platform { thrust_max_n: 0.1125, ..built_for }, own, OwnCraftError::ForceMax);
    refused(built_for, OwnCraft { mass_kg: 0.03, ..own }, OwnCraftError::Figures);
    let mut table = own.table;
    table[200] ^= 1;
    refused(built_for, OwnCraft { table, ..own }, OwnCraftError::Table);
    assert!(Firmware::start_own(&vehicle, &built_for, &own, &Tune::new(0, 0.0), QUIET).is_ok());
}

fn weight_n(vehicle: &Vehicle) -> f64 {
    GRAVITY_M_S2 * vehicle.mass_kg()
}

/// Steps of a craft that is held at rest where its course is, or with its motors off; the force that is commanded at the end, N.
fn held(firmware: &mut Firmware, vehicle: &Vehicle, course: Option<&Course>, steps: u32) -> f64 {
    let place = course.map_or_else(Vector3::zeros, |course| course.position_m(0.0).unwrap());
    let thrust_n = course.map_or(0.0, |_| vehicle.hover_thrust_n());
    let (state, off) = (RigidState::at_rest(place, thrust_n), Setpoint::default());
    let mut force_n = 0.0;
    for _ in 0..steps {
        if let Some(course) = course {
            firmware.command(course, 0.0, Setpoints::HighLevel);
        }
        force_n = firmware.step(&state, if course.is_some() { None } else { Some(&off) }).sum();
    }
    force_n
}

#[test]
fn a_craft_is_sent_and_flies_once_the_one_before_does_not() {
    let (built_in, vehicle) =
        (vehicles::by_name("crazyflie-2.1-brushless").unwrap(), file("crazyflie-2.1-brushless-45g.toml"));
    let own = own_craft(&certified(&vehicle)).unwrap();
    let hover = Course::Hover(Vector3::z());
    let log = &ffi::quatrack.log;
    let mut firmware =
        Firmware::start_told(&vehicle, built_in.mass_kg(), &Tune::new(0, 0.0), QUIET).expect("the built-in one");
    // In the air it is refused.
    let force_n = held(&mut firmware, &vehicle, Some(&hover), 100);
    assert!((force_n / weight_n(&built_in) - 1.0).abs() < 0.02, "{force_n} N");
    assert_eq!(send_for_words(&own.to_bytes()), (Status::Flying as u8, "motors on: land first".to_owned()));
    // On the ground it is taken, and a flight that begins before the app has looked at it ends as it began.
    held(&mut firmware, &vehicle, None, 100);
    let mut damaged = own.to_bytes();
    damaged[10] ^= 1;
    let end = damaged.len() - 4;
    let checksum = quatrack::checksum::crc32c(&damaged[..end]).to_le_bytes();
    damaged[end..].copy_from_slice(&checksum);
    assert_eq!(send_for_words(&damaged), (Status::Figures as u8, "table for other figures".to_owned()));
    assert_eq!(send_for_words(&own.to_bytes()).0, Status::Taken as u8);
    held(&mut firmware, &vehicle, Some(&hover), 100);
    ffi::quatrackService();
    let force_n = held(&mut firmware, &vehicle, Some(&hover), 500);
    assert_eq!(log.mode.load(Relaxed), 1);
    assert!((force_n / weight_n(&built_in) - 1.0).abs() < 0.02, "{force_n} N");
    held(&mut firmware, &vehicle, None, 100);
    let force_n = held(&mut firmware, &vehicle, Some(&hover), 100);
    assert!((force_n / weight_n(&vehicle) - 1.0).abs() < 0.02, "{force_n} N");
    // It is told its own air where the owner has not said another.
    let told = own.on(&platform(&vehicle)).unwrap().0.air.drag_per_s;
    assert_eq!(ffi::quatrack.parameters.drag_per_s.get(), told);
    drop(firmware);
}

#[test]
fn a_craft_that_was_sent_is_flown_by_the_controller_that_is_selected_in_the_air() {
    let (built_in, vehicle) =
        (vehicles::by_name("crazyflie-2.1-brushless").unwrap(), file("crazyflie-2.1-brushless-45g.toml"));
    let own = own_craft(&certified(&vehicle)).unwrap();
    let mut firmware =
        Firmware::start_told(&vehicle, built_in.mass_kg(), &Tune::new(0, 0.0), QUIET).expect("the built-in one");
    held(&mut firmware, &vehicle, None, 100);
    assert_eq!(send_for_words(&own.to_bytes()).0, Status::Taken as u8);
    ffi::quatrackService();
    // No step of this controller in between: another one has taken off.
    ffi::controllerOutOfTreeInit();
    let force_n = held(&mut firmware, &vehicle, Some(&Course::Hover(Vector3::z())), 4);
    assert!((force_n / weight_n(&vehicle) - 1.0).abs() < 0.02, "{force_n} N");
    assert_eq!(ffi::quatrack.log.table.load(Relaxed), 0);
}

#[test]
fn a_craft_that_there_is_no_table_for_flies_once_it_is_sent() {
    let vehicle = file("crazyflie-2.1-legacy.toml");
    let own = own_craft(&certified(&vehicle)).unwrap();
    // Nothing of the built-in ones: the propellers are others.
    assert!(Firmware::start_told(&vehicle, vehicle.mass_kg(), &Tune::new(0, 0.0), QUIET).is_none());
    let mut firmware = Firmware::start(&vehicle, &Tune::new(0, 0.0).in_vacuum(), QUIET);
    held(&mut firmware, &vehicle, None, 100);
    assert_eq!(send_for_words(&own.to_bytes()).0, Status::Taken as u8);
    ffi::quatrackService();
    held(&mut firmware, &vehicle, None, 100);
    let lag_s = GainTable::from_bytes(&own.table).unwrap().cascade().unwrap().motor_lag_s;
    let flown = eight(&mut firmware, &vehicle, &Case::of_lag(lag_s.into()));
    // As built in.
    assert!(flown.iae.is_some_and(|iae| iae <= 0.0023), "{flown:?}");
}

#[test]
fn a_craft_with_one_wrong_bit_is_not_taken_whatever_its_checksum() {
    let vehicle = file("crazyflie-2.1-legacy.toml");
    let sound = own_craft(&certified(&vehicle)).unwrap().to_bytes();
    let firmware = Firmware::start(&vehicle, &Tune::new(0, 0.0), QUIET);
    let end = sound.len() - 4;
    // Every byte of magic, version and figures, and some of the table, which has a checksum of its own.
    for position in (0..66).chain((66..end).step_by(23)) {
        let mut bytes = sound;
        bytes[position] ^= 1 << (position % 8);
        let checksum = quatrack::checksum::crc32c(&bytes[..end]).to_le_bytes();
        bytes[end..].copy_from_slice(&checksum);
        assert_ne!(send_for_words(&bytes).0, Status::Taken as u8, "byte {position}");
    }
    assert_eq!(send_for_words(&sound).0, Status::Taken as u8);
    drop(firmware);
}

#[test]
fn the_header_has_the_figures_and_the_table_in_full() {
    let certified = certified(&file("crazyflie-2.1-legacy.toml"));
    let (own, header) = (own_craft(&certified).unwrap(), craft_header(&certified).unwrap());
    let field = |name: &str| {
        let from = header.find(name).unwrap() + name.len() + 3;
        let to = from + header[from..].find(['}', '\n']).unwrap();
        header[from..to].trim_matches(['{', ',']).split(", ").map(|text| text.trim_end_matches('f').to_owned())
    };
    let floats = |name: &str| field(name).map(|text| text.parse::<f32>().unwrap()).collect::<Vec<_>>();
    assert_eq!(floats(".massKg"), [own.mass_kg]);
    assert_eq!(floats(".inertiaKgM2"), own.inertia_kg_m2);
    assert_eq!(floats(".armM"), [own.arm_m]);
    assert_eq!(floats(".forceN"), own.force_n);
    assert_eq!(floats(".torquePerThrustM"), [own.torque_per_thrust_m]);
    assert_eq!(floats(".motorLagS"), [own.motor_lag_s]);
    assert_eq!(floats(".bodyRatesRadS"), own.body_rates_rad_s);
    let bytes: Vec<u8> = header
        .split(|c: char| !c.is_ascii_alphanumeric())
        .filter_map(|text| text.strip_prefix("0x"))
        .map(|text| u8::from_str_radix(text, 16).unwrap())
        .collect();
    assert_eq!(bytes, own.table);
}

#[test]
fn other_laws_and_rates_have_no_craft_for_the_object() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../gains");
    let design = |name: &str| Design::from_file(&folder.join(name)).and_then(|design| design.certify()).unwrap();
    let error = own_craft(&design("lqr-e.toml")).unwrap_err().to_string();
    assert!(error.starts_with("lqr is no law"), "{error}");
    // The vehicle's 126 ms are outside of 32 to 95.
    let error = own_craft(&design("cascade-63ms.toml")).unwrap_err().to_string();
    assert!(error.starts_with("the vehicle's motors lag 126 ms, the design's region is 32 to 95 ms"), "{error}");
}
