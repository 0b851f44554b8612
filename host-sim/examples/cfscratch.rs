use quatrack_sim::crazyflie::*;
use quatrack_sim::vehicle::Vehicle;
use nalgebra::Vector3;
fn main() {
    let v = Vehicle::by_name(&std::env::args().nth(1).unwrap_or("crazyflie-2.1".into())).unwrap();
    let s = Sensors { gyro_noise_rad_s: 0.0, estimate_steps: 1 };
    let n = Sensors { gyro_noise_rad_s: 0.02, estimate_steps: 1 };
    let mild = Course::mild().unwrap(); let w = Course::aggressive().unwrap();
    for (table, lags) in [(0u8, vec![0.126]), (1, vec![0.005, 0.01, 0.02, 0.04]), (2, vec![0.005,0.01, 0.02]), (3, vec![0.005,0.02]), (4, vec![0.005,0.01,0.02])] {
        for lag in lags {
            let tune = Tune { table, motor_lag_s: lag };
            let base = Case { lag_s: lag.max(1e-3), mass_factor: 1.0, sensors: s, setpoints: Setpoints::HighLevel };
            for (name, course, case) in [
                ("hover", Course::Hover(Vector3::z()), base),
                ("step", Course::Step(Vector3::z(), Vector3::new(1.0,0.0,1.0)), base),
                ("hop", Course::Hop(0.014, 1.0), base),
                ("8 .85", Course::FigureEight(0.601), base),
                ("8 2.1", Course::FigureEight(1.485), base),
                ("8 2.1 n", Course::FigureEight(1.485), Case{sensors: n, ..base}),
                ("8 2.1 m+", Course::FigureEight(1.485), Case{mass_factor: 1.1, ..base}),
                ("8 2.1 fs", Course::FigureEight(1.485), Case{setpoints: Setpoints::FullState, ..base}),
                ("8 2.1 100Hz est", Course::FigureEight(1.485), Case{sensors: Sensors{estimate_steps: 10, ..s}, ..base}),
                ("8 3.1", Course::FigureEight(2.19), base),
                ("mild", mild.clone(), base),
                ("W", w.clone(), base),
            ] {
                let f = fly(&v, &course, &tune, &case);
                println!("table {table} lag {lag:.3} {name:16} iae {:?} max {:.3} end {:.4} tilt {:.1} in use {:?}", f.iae, f.max_error_m, f.end_error_m, f.max_tilt_deg, quatrack_crazyflie::ffi::quatrack.log.table);
            }
        }
    }
}
