//! Distributions: their draws, their bounds and their refusals.

use super::*;

fn vary(text: &str) -> Result<Vec<Varied>, (String, String)> {
    all(&text.parse().unwrap(), &mut Table::new())
}

fn one(text: &str) -> Varied {
    vary(text).unwrap().remove(0)
}

/// Empirical distribution of 4,000 draws at a point.
fn below(varied: &Varied, point: f64) -> f64 {
    (0..4000).filter(|run| varied.drawn(5, *run) < point).count() as f64 / 4000.0
}

#[test]
fn draws_have_the_distribution_that_is_asked_for() {
    // Four deviations of a share of one half among 4,000: 0.032.
    let close = |a: f64, b: f64| assert!((a - b).abs() < 0.032, "{a} {b}");
    close(below(&one("a = { uniform = [2.0, 4.0] }"), 2.5), 0.25);
    // One deviation above the mean lie 15.87 %.
    close(below(&one("a = { normal = [1.0, 0.2] }"), 1.2), 0.8413);
    close(below(&one("a = { log_normal = [2.0, 0.5] }"), 2.0 * 0.5_f64.exp()), 0.8413);
    close(below(&one("a = { choice = [1, 2, 3, 4] }"), 2.5), 0.5);
    // Half of a normal distribution that is cut at its mean lies above 0.6745 deviations.
    let cut = one("a = { normal = [0.0, 1.0], min = 0.0 }");
    close(below(&cut, 0.6745), 0.5);
    assert_eq!(below(&cut, 0.0), 0.0);
    // Beyond 2.2 deviations lie 1.39 %, half of them beyond 2.46.
    close(below(&one("a = { normal = [0.0, 1.0], min = 2.2 }"), 2.46), 0.5);
}

#[test]
fn a_draw_goes_where_its_name_says() {
    let text = "errors.lag_ms = { choice = [50] }\nair.wind_m_s = [{ choice = [2] }, 0.5, { choice = [-1] }]\n";
    let mut scenario: Table = "air = \"vehicle\"\n".parse().unwrap();
    let varied = all(&text.parse().unwrap(), &mut scenario).unwrap();
    let names = |varied: &[Varied]| varied.iter().map(Varied::name).collect::<Vec<_>>();
    assert_eq!(names(&varied), ["air.wind_m_s.0", "air.wind_m_s.2", "errors.lag_ms"]);
    let quoted = text.replace("errors.lag_ms", "\"errors.lag_ms\"").parse().unwrap();
    assert_eq!(names(&all(&quoted, &mut Table::new()).unwrap()), names(&varied));
    for figure in &varied {
        figure.put(&mut scenario, figure.drawn(1, 1)).unwrap();
    }
    assert_eq!(scenario["errors"]["lag_ms"].as_float(), Some(50.0));
    let wind: Vec<_> = scenario["air"]["wind_m_s"].as_array().unwrap().iter().map(|v| v.as_float().unwrap()).collect();
    assert_eq!((wind, scenario["air"]["of"].as_str()), (vec![2.0, 0.5, -1.0], Some("vehicle")));
}

#[test]
fn a_list_is_whole_before_anything_is_drawn() {
    for (text, nominal) in [
        ("a = [0, 0, { normal = [0.5, 0.1] }]", vec![0.0, 0.0, 0.5]),
        ("a = [{ uniform = [1, 3] }, { choice = [7, 8] }, { normal = [0.0, 1.0], min = 1.0 }]", vec![2.0, 7.0, 1.0]),
        ("a = [{ uniform = [1, 3] }, 4]", vec![2.0, 4.0]),
    ] {
        let mut scenario = Table::new();
        all(&text.parse().unwrap(), &mut scenario).unwrap();
        let list: Vec<f64> = scenario["a"].as_array().unwrap().iter().map(|v| v.as_float().unwrap()).collect();
        assert_eq!(list, nominal, "{text}");
    }
    // What the scenario states stays.
    let mut scenario: Table = "a = [9.0, 9.0]".parse().unwrap();
    all(&"a = [{ uniform = [1, 3] }, { uniform = [1, 3] }]".parse().unwrap(), &mut scenario).unwrap();
    assert_eq!(scenario["a"].as_array().unwrap()[0].as_float(), Some(9.0));
}

#[test]
fn a_relative_draw_multiplies_the_figure() {
    let figure = one("air.drag_per_s = { choice = [2.0], relative = true }");
    let mut scenario: Table = "[air]\ndrag_per_s = [0.4, 0.5, 1]\n".parse().unwrap();
    figure.put(&mut scenario, 2.0).unwrap();
    let drag: Vec<_> =
        scenario["air"]["drag_per_s"].as_array().unwrap().iter().map(|v| v.as_float().unwrap()).collect();
    assert_eq!(drag, [0.8, 1.0, 2.0]);
    assert!(figure.put(&mut Table::new(), 2.0).unwrap_err().contains("relative"));
}

#[test]
fn distributions_without_sense_are_refused_by_name() {
    for (text, key, reason) in [
        ("a = 3", "a", "no distribution"),
        ("a.b = { uniform = [1.0] }", "a.b", "two numbers"),
        ("a = { uniform = [2.0, 1.0] }", "a", "the least comes first"),
        ("a = { uniform = [nan, 1.0] }", "a", "finite"),
        ("a = { normal = [1.0, -1.0] }", "a", "not negative"),
        ("a = { log_normal = [0.0, 1.0] }", "a", "positive"),
        ("a = { normal = [1.0, 0.1], min = 5.0 }", "a", "nothing to draw"),
        // 0.135 % of a normal distribution lies beyond three deviations.
        ("a = { normal = [1.0, 0.05], min = 1.15 }", "a", "leave 1.3e-1 % of the distribution, 1 % is the least"),
        ("a = { log_normal = [1.0, 0.5], min = 2.0, max = 2.0 }", "a", "write uniform"),
        ("a = { uniform = [0.0, 1.0], min = 0.5 }", "a", "own ends"),
        ("a = { choice = [] }", "a", "nothing to choose"),
        ("a = { choice = [1], normal = [1, 1] }", "a", "one distribution"),
        ("a = { uniform = [0, 1], sigma = 3 }", "a", "sigma"),
        ("a = { gauss = [0, 1] }", "a.gauss", "no distribution"),
        ("seed = { choice = [1] }", "seed", "not drawn"),
    ] {
        let (named, why) = vary(text).unwrap_err();
        assert!(named == key && why.contains(reason), "{text}: {named}: {why}");
    }
}
