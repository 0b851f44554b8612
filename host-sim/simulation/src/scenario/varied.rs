//! A scenario with one more deviation at a time: the cases of the robustness flights on top of its own.

use crate::flight::robustness::{Case, NOISE, RATE_RAD_S};
use crate::scenario::{CourseChoice, Scenario, SensorNoise};

impl Scenario {
    /// With the deviations of a case, on top of the scenario's own: factors multiply, delays add, and noise goes before a
    /// smaller one. The case of a faster eight is absent where no eight is flown.
    pub fn varied(&self, case: &Case) -> Option<Self> {
        let mut scenario = self.clone();
        let faster = case.rate_rad_s / RATE_RAD_S;
        match &mut scenario.course {
            CourseChoice::Eight(speed_m_s) => *speed_m_s *= faster,
            _ if faster != 1.0 => return None,
            _ => {}
        }
        let truth = &mut scenario.truth;
        truth.mass_kg *= case.mass_factor;
        truth.inertia_kg_m2 *= case.inertia_factor;
        truth.rise_lag_s *= case.lag_factor;
        truth.fall_lag_s *= case.lag_factor;
        truth.delay_s += case.delay_s;
        if case.noise.is_some() {
            let own = scenario.noise;
            scenario.noise = SensorNoise {
                gyro_rad_s: own.gyro_rad_s.max(NOISE.body_rates_rad_s),
                position_m: own.position_m.max(NOISE.position_m),
                velocity_m_s: own.velocity_m_s.max(NOISE.velocity_m_s),
                ..own
            };
        }
        Some(scenario)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flight::robustness::CASES;
    use crate::scenario::file::ScenarioFile;
    use std::path::Path;

    fn scenario(text: &str) -> Scenario {
        let file = ScenarioFile::parse(text, "test").unwrap();
        Scenario::checked(&file, "test", Path::new("")).unwrap()
    }

    #[test]
    fn cases_come_on_top_of_a_scenario() {
        let own = scenario("vehicle = \"crazyflie-2.1\"\n[errors]\nmass_factor = 1.2\ndelay_ms = 3.0\nlag_ms = 80.0\n");
        let varied = CASES.map(|case| (case.name, own.varied(&case).unwrap()));
        let of = |name: &str| &varied.iter().find(|(known, _)| *known == name).unwrap().1;
        assert_eq!(*of("nominal"), own);
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        close(of("mass+10").truth.mass_kg, 0.029 * 1.2 * 1.1);
        close(of("delay4ms").truth.delay_s, 0.007);
        close(of("lag*1.5").truth.rise_lag_s, 0.120);
        // 2.1 m/s at the rate of the usual eight, so 3.1 m/s at that of the fast one.
        let CourseChoice::Eight(speed_m_s) = of("fast").course else { panic!("an eight") };
        assert!((speed_m_s - 3.1).abs() < 0.01, "{speed_m_s}");
        assert_eq!(of("noise").noise.position_m, 1e-3);
    }

    #[test]
    fn nothing_but_an_eight_has_a_fast_case() {
        let hover = scenario("vehicle = \"crazyflie-2.1\"\ncourse = \"hover\"\n");
        let names: Vec<_> = CASES.iter().filter(|case| hover.varied(case).is_none()).map(|case| case.name).collect();
        assert_eq!(names, ["fast"]);
    }
}
