use quatrack_sim::crazyflie::*;
fn main(){
    let table: u8 = std::env::args().nth(1).map_or(2, |s| s.parse().unwrap());
    if let Some(path) = std::env::args().nth(2) {
        let v = quatrack_sim::vehicle::Vehicle::by_name("crazyflie-2.1").unwrap();
        let tune = Tune { table, motor_lag_s: if table == 0 { 0.0 } else { 0.02 } };
        let case = Case { lag_s: 0.02, mass_factor: 1.0, sensors: Sensors { gyro_noise_rad_s: 0.02, estimate_steps: 1 }, setpoints: Setpoints::HighLevel };
        let r = fly_recorded(&v, &Course::FigureEight(1.485), &tune, &case, 100);
        let mut calls = Vec::new();
        for value in [0.029f32, 0.046, 0.12, 0.00699289] { calls.extend(value.to_le_bytes()); }
        calls.extend(u32::from(tune.table).to_le_bytes());
        calls.extend((tune.motor_lag_s as f32).to_le_bytes());
        calls.extend((r.steps.len() as u32).to_le_bytes());
        calls.extend(&r.calls);
        std::fs::write(path, calls).unwrap();
        return;
    }
    println!("{}", count(std::path::Path::new(".")).unwrap());
}
