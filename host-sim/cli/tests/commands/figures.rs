//! Figures as SVG: every curve in every view, axes that fit the reference, for any flights.

use nalgebra::Vector3;
use quatrack_cli::figures::{Curve, FigureError, TrackingFigure};

const BLUE: &str = "#0072b2";
const VERMILION: &str = "#d55e00";

struct Data {
    time_s: Vec<f64>,
    position_m: Vec<Vector3<f64>>,
}

impl Data {
    /// 10 s at 100 Hz of a curve that starts 0 m high.
    fn new(at: impl Fn(f64) -> Vector3<f64>) -> Self {
        let time_s: Vec<f64> = (0..=1000).map(|k| f64::from(k) * 0.01).collect();
        Self { position_m: time_s.iter().map(|t| at(*t)).collect(), time_s }
    }

    fn wave(lag_s: f64) -> Self {
        Self::new(|t| {
            let t = (t - lag_s).max(0.0);
            Vector3::new(0.1 * t, (2.0 * t).sin(), 0.5 * (1.0 - t.cos()))
        })
    }

    fn curve<'a>(&'a self, label: &'a str) -> Curve<'a> {
        Curve { label, time_s: &self.time_s, position_m: &self.position_m }
    }
}

fn svg_of(reference: &Data, flights: &[&Data]) -> String {
    let labels = ["first", "second", "third", "fourth"];
    let flights = flights.iter().zip(labels).map(|(data, label)| data.curve(label)).collect();
    TrackingFigure { title: "A title", reference: reference.curve("reference"), flights }.to_svg().expect("a figure")
}

/// The points of all polylines with `mark` among their attributes, in document order.
fn polylines(svg: &str, mark: &str) -> Vec<Vec<[f64; 2]>> {
    let number = |text: &str| text.parse::<f64>().expect("a number");
    svg.lines()
        .filter(|line| line.starts_with("<polyline") && line.contains(mark))
        .map(|line| {
            let points = line.split("points=\"").nth(1).and_then(|rest| rest.split('"').next()).expect("points");
            points
                .split(' ')
                .map(|pair| pair.split_once(',').expect("a pair"))
                .map(|(x, y)| [number(x), number(y)])
                .collect()
        })
        .collect()
}

fn texts(svg: &str) -> Vec<&str> {
    svg.lines()
        .filter(|line| line.starts_with("<text"))
        .map(|line| line.split(['>', '<']).nth(2).expect("content"))
        .collect()
}

/// Distance of `p` from the line through `points`.
fn distance(p: [f64; 2], points: &[[f64; 2]]) -> f64 {
    let p = nalgebra::Vector2::from(p);
    points
        .windows(2)
        .map(|pair| {
            let (a, b) = (nalgebra::Vector2::from(pair[0]), nalgebra::Vector2::from(pair[1]));
            let along = b - a;
            let share = ((p - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            (p - a - share * along).norm()
        })
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn every_curve_is_in_every_view_and_only_the_reference_is_dashed() {
    let svg = svg_of(&Data::wave(0.0), &[&Data::wave(0.3), &Data::wave(0.1)]);
    // The 3D view and three panels.
    assert_eq!(polylines(&svg, BLUE).len(), 4);
    assert_eq!(polylines(&svg, VERMILION).len(), 4);
    assert_eq!(polylines(&svg, "stroke-dasharray").len(), 4);
    // And the reference's shadow on the floor.
    assert_eq!(polylines(&svg, "").len(), 13);
    for line in svg.lines().filter(|line| line.contains("stroke-dasharray")) {
        assert!(line.contains("stroke=\"#000000\""), "{line}");
    }
}

#[test]
fn axes_legend_and_title_are_written() {
    let svg = svg_of(&Data::wave(0.0), &[&Data::wave(0.3), &Data::wave(0.1)]);
    let texts = texts(&svg);
    for once in ["A title", "reference", "first", "second", "time (s)"] {
        assert_eq!(texts.iter().filter(|text| **text == once).count(), 1, "{once}");
    }
    for twice in ["x (m)", "y (m)", "z (m)"] {
        assert_eq!(texts.iter().filter(|text| **text == twice).count(), 2, "{twice}: 3D view and panel");
    }
    // Time from 0 to 10 s in at most 8 steps: 2 s each.
    for tick in ["0", "2", "4", "6", "8", "10"] {
        assert!(texts.contains(&tick), "{tick}");
    }
    assert!(texts.contains(&"\u{2212}1.0") || texts.contains(&"\u{2212}1"), "y reaches -1, with a true minus sign");
    assert_eq!(texts.len(), svg.matches("</text>").count(), "every text has content of its own");
}

#[test]
fn elements_are_closed_and_text_is_escaped() {
    let (reference, flight) = (Data::wave(0.0), Data::wave(0.1));
    let figure = TrackingFigure {
        title: "<Q> & \"R\"\u{1}",
        reference: reference.curve("r"),
        flights: vec![flight.curve("a<b")],
    };
    let svg = figure.to_svg().expect("a figure");
    assert!(svg.contains("<title>&lt;Q&gt; &amp; &quot;R&quot;</title>"), "escaped, control characters left out");
    assert!(svg.contains(">a&lt;b</text>"));
    let mut open = Vec::new();
    for tag in svg.split('<').skip(1).map(|rest| rest.split('>').next().expect("an end")) {
        assert_eq!(tag.matches('"').count() % 2, 0, "quotes come in pairs: {tag}");
        let name = |tag: &str| tag.split([' ', '/']).next().map(str::to_owned);
        match tag.strip_prefix('/') {
            Some(closed) => assert_eq!(open.pop().flatten().as_deref(), Some(closed)),
            None if tag.ends_with('/') => {}
            None => open.push(name(tag)),
        }
    }
    assert!(open.is_empty(), "{open:?}");
    assert!(svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\"") && svg.ends_with("</svg>\n"));
}

#[test]
fn thinned_curves_stay_where_the_samples_are() {
    let data = Data::wave(0.0);
    let svg = svg_of(&data, &[&data]);
    // Views in order: 3D, x, y, z; y is the sine of amplitude 1.
    let drawn = &polylines(&svg, BLUE)[2];
    assert!(drawn.len() < 300, "{} points for 1001 samples", drawn.len());
    let rows = || drawn.iter().map(|p| p[1]);
    let (top, bottom) = (rows().fold(f64::INFINITY, f64::min), rows().fold(0.0, f64::max));
    let (left, right) = (drawn[0][0], drawn[drawn.len() - 1][0]);
    for (t, p) in data.time_s.iter().zip(&data.position_m) {
        let page = [left + t / 10.0 * (right - left), 0.5 * (top + bottom) - 0.5 * (bottom - top) * p.y];
        // The line leaves samples by at most 0.05; twice that for the error in `top` and `bottom`, 0.01 for decimals.
        assert!(distance(page, drawn) < 0.16, "t = {t}");
    }
    // x rises steadily: a straight line needs its ends only.
    let x = &polylines(&svg, BLUE)[1];
    assert_eq!(x.len(), 2);
    assert!(x[0][0] < x[1][0] && x[0][1] > x[1][1], "later is to the right, more is further up: {x:?}");
}

#[test]
fn a_metre_is_as_long_along_every_axis_of_the_box() {
    // Straight flights of 1 m along each axis. In an orthographic view the squares of the lengths on the page of three
    // perpendicular unit vectors add up to 2 scale^2, each at most scale^2; and they are perpendicular in space only if
    // a^2 + b^2 + c^2 = 0 for the page vectors taken as complex numbers (Gauss's theorem of axonometry).
    let corner = Data::new(|t| match t {
        t if t < 2.5 => Vector3::new(1.0 - 0.4 * t, 0.0, 0.0),
        t if t < 5.0 => Vector3::new(0.0, 0.4 * (t - 2.5), 0.0),
        t if t < 7.5 => Vector3::new(0.0, 1.0 - 0.4 * (t - 5.0), 0.0),
        t => Vector3::new(0.0, 0.0, 0.4 * (t - 7.5)),
    });
    let svg = svg_of(&corner, &[&corner]);
    let view = &polylines(&svg, BLUE)[0];
    let [x, origin, y, back, z] = view[..] else { panic!("five corners: {view:?}") };
    assert_eq!(origin, back);
    let edges = [x, y, z].map(|end| [end[0] - origin[0], end[1] - origin[1]]);
    let real: f64 = edges.iter().map(|e| e[0] * e[0] - e[1] * e[1]).sum();
    let imaginary: f64 = edges.iter().map(|e| 2.0 * e[0] * e[1]).sum();
    let size: f64 = edges.iter().map(|e| e[0] * e[0] + e[1] * e[1]).sum();
    // Coordinates are written to 0.01 of edges of about 200 pixels.
    assert!(real.hypot(imaginary) < 2e-4 * size, "{edges:?}");
    assert!(z[1] < origin[1] && x[0] > origin[0], "z goes up, x to the right");
}

#[test]
fn a_flight_that_diverges_leaves_the_figure_readable() {
    let reference = Data::wave(0.0);
    let mut strays = Data::wave(0.1);
    let mut ends = Data::wave(0.2);
    for k in 500..=1000 {
        strays.position_m[k] += Vector3::new(1.0, -1.0, 0.5) * 2_f64.powi(2 * (k as i32 - 500)).min(1e300);
    }
    ends.position_m[700..].fill(Vector3::repeat(f64::NAN));
    let calm = svg_of(&reference, &[&Data::wave(0.1)]);
    let wild = svg_of(&reference, &[&strays, &ends]);
    for [x, y] in polylines(&wild, "").concat() {
        assert!((0.0..=1200.0).contains(&x) && (0.0..=560.0).contains(&y), "({x}, {y}) is off the sheet");
    }
    let height = |svg: &str, panel: usize| {
        let drawn = &polylines(svg, "stroke-dasharray")[panel];
        drawn.iter().map(|p| p[1]).fold(0.0, f64::max) - drawn.iter().map(|p| p[1]).fold(560.0, f64::min)
    };
    for panel in 1..=3 {
        // Axes grow by at most half of the longest extent (2 m, y) at either end, then by 6 % and 5 % at either end: z,
        // 1 m long, keeps a third of its panel, less their share beyond the 6 % that the calm one has as well.
        assert!(height(&wild, panel) > 0.3 * height(&calm, panel), "panel {panel}");
    }
    let notes: Vec<&str> = texts(&wild).into_iter().filter(|text| text.ends_with('.')).collect();
    assert_eq!(notes.len(), 1, "{notes:?}");
    assert!(notes[0].contains("first leaves the axes at 5.0"), "{notes:?}");
    assert!(notes[0].contains("second is not a finite number at 7.00 s."), "{notes:?}");
    assert!(!texts(&calm).iter().any(|text| text.contains("leaves the axes")));
}

#[test]
fn a_flight_that_comes_back_is_in_the_axes_whole() {
    let rest = Data::new(|_| Vector3::new(0.0, 0.0, 15.0));
    // 1.6 m below where it begins and ends, as a start upside down; and one that falls on, 5 m.
    let returns = Data::new(|t| Vector3::new(0.0, 0.0, 15.0 - 1.6 * (2.0 * t * (-t).exp()).min(1.0)));
    let falls = Data::new(|t| Vector3::new(0.0, 0.0, 15.0 - 0.5 * t));
    let svg = svg_of(&rest, &[&returns, &falls]);
    let notes: Vec<&str> = texts(&svg).into_iter().filter(|text| text.contains("leaves the axes")).collect();
    assert!(notes.len() == 1 && notes[0].starts_with("second"), "{notes:?}");
    // In space, x, y and z: one stretch each.
    assert_eq!(polylines(&svg, BLUE).len(), 4);
}

#[test]
fn points_that_are_not_finite_break_the_line() {
    let mut flight = Data::wave(0.1);
    flight.position_m[400].x = f64::NAN;
    let svg = svg_of(&Data::wave(0.0), &[&flight]);
    // Two stretches in space and in x; y and z of that sample are numbers and are drawn.
    assert_eq!(polylines(&svg, BLUE).len(), 2 + 2 + 1 + 1);
}

#[test]
fn flat_and_resting_references_have_axes() {
    let rest = Data::new(|_| Vector3::new(0.0, 0.0, 1.0));
    let svg = svg_of(&rest, &[&rest]);
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    let x = &polylines(&svg, BLUE)[1];
    assert!(x[1][0] - x[0][0] > 400.0, "a level line through the panel: {x:?}");
}

#[test]
fn the_same_data_give_the_same_document_and_a_small_one() {
    let draw = || svg_of(&Data::wave(0.0), &[&Data::wave(0.3), &Data::wave(0.1)]);
    assert_eq!(draw(), draw());
    assert!(draw().len() < 300_000, "{} bytes", draw().len());
}

#[test]
fn data_that_make_no_figure_are_refused() {
    let (good, short) = (Data::wave(0.0), Data { time_s: vec![0.0], position_m: vec![Vector3::zeros()] });
    let draw = |reference: Curve<'_>, flights: Vec<Curve<'_>>| {
        TrackingFigure { title: "t", reference, flights }.to_svg().expect_err("must be refused")
    };
    let flight = good.curve("flight");
    assert_eq!(draw(flight, vec![]), FigureError::Flights(0));
    assert_eq!(draw(flight, vec![flight; 5]), FigureError::Flights(5));
    let few = FigureError::Samples { label: "few".into(), times: 1, positions: 1 };
    assert_eq!(draw(flight, vec![short.curve("few")]), few);
    let uneven = Curve { label: "uneven", time_s: &good.time_s[1..], position_m: &good.position_m };
    assert!(matches!(draw(uneven, vec![flight]), FigureError::Samples { times: 1000, positions: 1001, .. }));
    for (index, value) in [(3, 0.02), (0, f64::NAN), (1000, f64::INFINITY), (0, -2e6)] {
        let mut data = Data::wave(0.0);
        data.time_s[index] = value;
        let error = draw(flight, vec![data.curve("clock")]);
        assert!(matches!(error, FigureError::Time { index: i, .. } if i == index), "{error}");
        assert!(error.to_string().starts_with(&format!("clock: time {index} (from 0) is {value} s;")), "{error}");
    }
    for value in [f64::NAN, 1.1e6] {
        let mut data = Data::wave(0.0);
        data.position_m[7].y = value;
        assert!(matches!(draw(data.curve("r"), vec![flight]), FigureError::Reference { index: 7, .. }), "{value}");
    }
}
