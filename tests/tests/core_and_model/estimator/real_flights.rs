//! Real flights of a Crazyflie 2.1 (NanoBench, github syediu/nanobench-iros2026, arXiv 2603.09908): its gyroscope, its
//! accelerometer and Vicon's positions in, beside the estimate of its own firmware. Skipped, saying so, where the
//! flights are not there.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use flate2::read::GzDecoder;
use nalgebra::{UnitQuaternion, Vector3};
use quatrack::estimator::{Estimator, EstimatorConfig, Imu};
use quatrack::{Quaternion, State};

/// Where the flights are looked for, from the root of the checkout and upwards.
const FOLDER: &str = "shared/flights/nanobench";
const RATE_HZ: f64 = 100.0;
/// Shifts that are tried: 150 ms to either side in steps of 2.5 ms.
const SHIFTS: std::ops::RangeInclusive<i32> = -60..=60;
const SHIFT_STEP_S: f64 = 0.0025;
/// Rows at either end that shifts may ask beyond.
const MARGIN: usize = 20;

fn paths() -> Vec<PathBuf> {
    let found =
        Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().map(|above| above.join(FOLDER)).find(|path| path.is_dir());
    let Some(folder) = found else {
        println!("SKIPPED: no flights in a folder {FOLDER} beside or above the checkout");
        return Vec::new();
    };
    let mut paths: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "gz"));
    paths.sort();
    paths
}

/// A flight at 100 Hz, cut where its log ends.
struct Flight {
    name: String,
    position: Vec<Vector3<f64>>,
    velocity: Vec<Vector3<f64>>,
    attitude: Vec<UnitQuaternion<f64>>,
    gyro: Vec<Vector3<f64>>,
    force: Vec<Vector3<f64>>,
    own: Vec<Vector3<f64>>,
}

fn read(path: &Path) -> Flight {
    let mut text = String::new();
    GzDecoder::new(File::open(path).unwrap()).read_to_string(&mut text).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut columns: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for line in lines {
        for (name, number) in names.iter().zip(line.split(',')) {
            columns.entry(name).or_default().push(number.parse().unwrap());
        }
    }
    let vectors = |names: [&str; 3], scale: f64| -> Vec<Vector3<f64>> {
        let [x, y, z] = names.map(|name| &columns[name]);
        x.iter().zip(y).zip(z).map(|((x, y), z)| Vector3::new(*x, *y, *z) * scale).collect()
    };
    // Where the log has ended early the set goes on in straight lines.
    let z = &columns["imu_acc_z"];
    let straight = |at: &usize| (z[at + 2] - 2.0 * z[at + 1] + z[*at]).abs() < 2e-4;
    let end = z.len() - (0..z.len() - 2).rev().take_while(straight).count();
    let q = |at: usize| {
        let [w, x, y, z] = ["qw", "qx", "qy", "qz"].map(|name| columns[name][at]);
        UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z))
    };
    let cut = |mut column: Vec<Vector3<f64>>| {
        column.truncate(end);
        column
    };
    Flight {
        name: path.file_name().unwrap().to_string_lossy().into_owned(),
        position: cut(vectors(["px", "py", "pz"], 1.0)),
        velocity: cut(vectors(["vx", "vy", "vz"], 1.0)),
        attitude: (0..end).map(q).collect(),
        gyro: cut(vectors(["imu_gyro_x", "imu_gyro_y", "imu_gyro_z"], 1.0)),
        force: cut(vectors(["imu_acc_x", "imu_acc_y", "imu_acc_z"], 9.81)),
        own: cut(vectors(["est_stateEstimate_x", "est_stateEstimate_y", "est_stateEstimate_z"], 1.0)),
    }
}

/// A column at a row and a shift, between two rows linearly.
fn at(column: &[Vector3<f64>], row: usize, shift_s: f64) -> Vector3<f64> {
    let place = row as f64 + shift_s * RATE_HZ;
    let low = (place.floor().max(0.0) as usize).min(column.len() - 2);
    column[low].lerp(&column[low + 1], place - low as f64)
}

/// The shift of the least sum of squares.
fn best_shift(sum: impl Fn(f64) -> f64) -> f64 {
    let sums = SHIFTS.map(|step| f64::from(step) * SHIFT_STEP_S).map(|shift| (sum(shift), shift));
    sums.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap().1
}

impl Flight {
    fn rows(&self) -> std::ops::Range<usize> {
        MARGIN..self.position.len() - MARGIN
    }

    /// How much later the gyroscope's column is than Vicon's attitude: where its rates about body x and y are those of
    /// the attitude.
    fn gyro_shift(&self) -> f64 {
        const SPAN: usize = 2;
        let rates = |row: usize| {
            let turn = self.attitude[row - SPAN].inverse() * self.attitude[row + SPAN];
            turn.scaled_axis() * (RATE_HZ / (2 * SPAN) as f64)
        };
        best_shift(|shift| self.rows().map(|row| (at(&self.gyro, row, shift) - rates(row)).xy().norm_squared()).sum())
    }

    /// Positions and velocities by our filter: the positions of Vicon at 100 Hz in, the inertial sensors by their
    /// shift.
    fn estimated(&self, config: EstimatorConfig, shift: f64) -> Vec<(Vector3<f64>, Vector3<f64>)> {
        let estimator = Estimator::new(config).unwrap();
        let q = self.attitude[MARGIN].quaternion();
        let attitude = Quaternion::new(q.w as f32, q.i as f32, q.j as f32, q.k as f32);
        let start = State { attitude, ..State::at_rest(self.position[MARGIN].map(|x| x as f32)) };
        let mut estimate = estimator.start(&start).unwrap();
        let predict = |row: usize| {
            // The mean over the period that ends at this row.
            let mean = |column| (at(column, row, shift - 0.5 / RATE_HZ)).map(|x| x as f32);
            let imu = Imu { body_rates_rad_s: mean(&self.gyro), specific_force_m_s2: mean(&self.force) };
            estimator.predict(&mut estimate, &imu, (1.0 / RATE_HZ) as f32).unwrap();
            estimator.update_position(&mut estimate, &self.position[row].map(|x| x as f32), 1e-3).unwrap();
            (estimate.state().position_m.cast(), estimate.state().velocity_m_s.cast())
        };
        self.rows().map(predict).collect()
    }
}

/// Root of the mean square of each axis, and of the distance.
fn rms(pairs: impl Iterator<Item = Vector3<f64>>) -> (Vector3<f64>, f64) {
    let (sum, count) = pairs.fold((Vector3::zeros(), 0.0), |(sum, count), d| (sum + d.component_mul(&d), count + 1.0));
    let mean: Vector3<f64> = sum / count;
    (mean.map(f64::sqrt), mean.sum().sqrt())
}

/// The result of a flight.
struct Found {
    /// Ours to that on board, after the shift at which they are nearest: each axis, and the distance, m.
    axes: Vector3<f64>,
    distance: f64,
    /// That on board to Vicon's, after the same shift, m.
    on_board: f64,
    /// Velocities to Vicon's, m/s.
    velocity: f64,
}

impl Flight {
    fn found(&self, config: EstimatorConfig) -> Found {
        let gyro_shift = self.gyro_shift();
        let ours = self.estimated(config, gyro_shift);
        let own = &self.own;
        let differences =
            |shift: f64| self.rows().zip(&ours).map(move |(row, (position, _))| at(own, row, shift) - position);
        let shift = best_shift(|shift| differences(shift).map(|d| d.norm_squared()).sum());
        let (axes, distance) = rms(differences(shift));
        let (_, on_board) = rms(self.rows().map(|row| at(own, row, shift) - self.position[row]));
        let (_, velocity) = rms(self.rows().zip(&ours).map(|(row, (_, velocity))| self.velocity[row] - velocity));
        let (gyro_ms, shift_ms) = (1e3 * gyro_shift, 1e3 * shift);
        println!(
            "{}: gyro {gyro_ms} ms, on board {shift_ms} ms; ours to on board {distance:.4} m, by axis {:.4?}; on board to Vicon \
             {on_board:.4} m; velocity {velocity:.3} m/s",
            self.name,
            axes.as_slice()
        );
        Found { axes, distance, on_board, velocity }
    }
}

/// The estimate on board is itself 11 to 42 mm off Vicon, with a delay that slips within a flight: where it is
/// further off than 3 cm, two of the eleven flights, no filter that believes Vicon can be nearer to it. Along each axis
/// 3 cm hold in all of them.
#[test]
fn real_flights_are_estimated_as_on_board() {
    let mut velocities = [0.0; 2];
    for path in paths() {
        let flight = read(&path);
        let shipped = flight.found(EstimatorConfig::CRAZYFLIE);
        assert!(shipped.axes.max() < 0.03, "{} {:?}", flight.name, shipped.axes);
        assert!(shipped.distance < shipped.on_board.max(0.03 - 2e-3) + 2e-3, "{} {}", flight.name, shipped.distance);
        // Drag of the same craft, identified from the accelerometer in other flights of the set.
        let told = flight.found(EstimatorConfig { drag_per_s: [0.39, 0.40], ..EstimatorConfig::CRAZYFLIE });
        assert!(told.axes.max() < 0.03, "{} {:?}", flight.name, told.axes);
        velocities[0] += shipped.velocity;
        velocities[1] += told.velocity;
        assert!(told.velocity < shipped.velocity, "{}", flight.name);
    }
    println!(
        "velocity off Vicon's, sum of the flights' rms: {:.3} m/s as shipped, {:.3} with drag",
        velocities[0], velocities[1]
    );
}
