fn main(){ println!("{}", quatrack_sim::crazyflie::count(std::path::Path::new(".")).unwrap()); }
