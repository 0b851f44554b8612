//! Figures as PNG: the picture is in the file, with its texts, and the same on every machine.

use nalgebra::Vector3;
use quatrack_cli::figures::{Curve, TrackingFigure, png};
use resvg::tiny_skia::{Pixmap, PremultipliedColorU8};

const WIDTH: usize = 2400;
const HEIGHT: usize = 1120;

fn figure(lag_s: f64) -> Vec<u8> {
    let time_s: Vec<f64> = (0..=600).map(|k| f64::from(k) * 0.01).collect();
    let at = |t: f64| Vector3::new((1.3 * t).sin(), t.cos() - 1.0, 0.2 * t.sqrt());
    let reference: Vec<_> = time_s.iter().map(|t| at(*t)).collect();
    let flight: Vec<_> = time_s.iter().map(|t| at((t - lag_s).max(0.0))).collect();
    let curve = |label, position_m| Curve { label, time_s: &time_s, position_m };
    let flights = vec![curve("flight", &flight)];
    let figure = TrackingFigure { title: "A title", reference: curve("reference", &reference), flights };
    png(&figure.to_svg().expect("a figure")).expect("a picture")
}

/// Pixels of the file, all opaque.
fn decode(png: &[u8]) -> Vec<[u8; 3]> {
    let pixels = Pixmap::decode_png(png).expect("a PNG file");
    assert_eq!((pixels.width(), pixels.height()), (WIDTH as u32, HEIGHT as u32));
    assert!(pixels.pixels().iter().all(PremultipliedColorU8::is_opaque));
    pixels.pixels().iter().map(|p| [p.red(), p.green(), p.blue()]).collect()
}

#[test]
fn the_picture_is_in_the_file() {
    let pixels = decode(&figure(0.4));
    let count = |colour: [u8; 3]| pixels.iter().filter(|p| **p == colour).count();
    // White paper; and both curves in four views of some 1000 pixels across, 2 to 6 pixels wide: thousands.
    assert!(count([255; 3]) > WIDTH * HEIGHT / 2);
    assert!(count([0, 114, 178]) > 5_000, "the flight in blue: {}", count([0, 114, 178]));
    assert!(count([0; 3]) > 1_000, "the reference in black: {}", count([0; 3]));
    assert!(count([34; 3]) > 1_000, "type: {}", count([34; 3]));
    // Half-covered pixels at the edges of the blue line make it smooth: there is at least one at either side of it.
    let (line, paper) = ([0_u8, 114, 178], [255_u8; 3]);
    let between = |p: &[u8; 3]| (0..3).all(|i| p[i] > line[i] && p[i] < paper[i]) && p[2] > p[1] && p[1] > p[0];
    assert!(pixels.iter().filter(|p| between(p)).count() > 5_000);
}

#[test]
fn nothing_touches_the_edge_of_the_sheet() {
    let pixels = decode(&figure(0.4));
    let margin = 10;
    let inside = |k: usize| {
        let (row, column) = (k / WIDTH, k % WIDTH);
        (margin..HEIGHT - margin).contains(&row) && (margin..WIDTH - margin).contains(&column)
    };
    assert!(pixels.iter().enumerate().all(|(k, p)| inside(k) || *p == [255; 3]));
}

#[test]
fn the_same_data_give_the_same_file_and_others_another() {
    let png = figure(0.4);
    assert_eq!(png, figure(0.4));
    assert_ne!(decode(&png), decode(&figure(0.0)));
    assert!(png.len() < 1_000_000, "{} bytes", png.len());
}

#[test]
fn any_title_and_label_can_be_drawn() {
    let time_s = [0.0, 1.0];
    let position_m = [Vector3::zeros(), Vector3::new(1.0, 2.0, 3.0)];
    let long = "very long ".repeat(400);
    for text in ["", " ", "\u{3bc} = 2 \u{b0} \u{2212}1", "\u{1f681}\u{0}\n", &long] {
        let curve = Curve { label: text, time_s: &time_s, position_m: &position_m };
        let figure = TrackingFigure { title: text, reference: curve, flights: vec![curve; 4] };
        let drawn = png(&figure.to_svg().expect("a figure"));
        assert!(drawn.is_ok_and(|png| decode(&png).contains(&[0, 114, 178])), "{text:.20}");
    }
}
