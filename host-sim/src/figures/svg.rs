//! A scene in, an SVG document out: one `polyline` per unbroken stretch of a curve, dashes as dashes, texts as texts.

use std::fmt::Write;

use super::scene::{Anchor, Colour, Item, Scene, Stroke, Text};

/// The embedded face where it is installed, else the reader's nearest.
const FONT_FAMILY: &str = "'IBM Plex Sans', 'Helvetica Neue', Helvetica, Arial, sans-serif";

/// The document, ended by a line feed.
pub(super) fn document(scene: &Scene) -> String {
    let [width, height] = scene.size;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} \
         {height}\" font-family=\"{FONT_FAMILY}\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n\
         <title>{}</title>\n<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n",
        escaped(&scene.title)
    );
    for item in &scene.items {
        write_item(&mut svg, item).expect("writing to a String cannot fail");
    }
    svg.push_str("</svg>\n");
    svg
}

fn write_item(svg: &mut String, item: &Item) -> std::fmt::Result {
    match item {
        Item::Line { from, to, stroke } => writeln!(
            svg,
            "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"{}/>",
            number(from[0]),
            number(from[1]),
            number(to[0]),
            number(to[1]),
            stroke_attributes(stroke)
        ),
        Item::Curve { points, stroke } => {
            writeln!(svg, "<polyline fill=\"none\"{} points=\"{}\"/>", stroke_attributes(stroke), point_list(points))
        }
        Item::Area { corners, colour } => {
            writeln!(svg, "<polygon fill=\"{}\" points=\"{}\"/>", hex(*colour), point_list(corners))
        }
        Item::Text(text) => write_text(svg, text),
    }
}

fn write_text(svg: &mut String, text: &Text) -> std::fmt::Result {
    let anchor = match text.anchor {
        Anchor::Start => "start",
        Anchor::Middle => "middle",
        Anchor::End => "end",
    };
    let (x, y) = (number(text.at[0]), number(text.at[1]));
    let turn = if text.upwards { format!(" transform=\"rotate(-90 {x} {y})\"") } else { String::new() };
    writeln!(
        svg,
        "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\" text-anchor=\"{anchor}\" fill=\"{}\"{turn}>{}</text>",
        number(text.size),
        hex(text.colour),
        escaped(&text.content)
    )
}

fn stroke_attributes(stroke: &Stroke) -> String {
    let mut attributes = format!(" stroke=\"{}\" stroke-width=\"{}\"", hex(stroke.colour), number(stroke.width));
    if let Some([dash, gap]) = stroke.dash {
        attributes.push_str(&format!(" stroke-dasharray=\"{} {}\"", number(dash), number(gap)));
    }
    attributes
}

fn point_list(points: &[[f64; 2]]) -> String {
    let pairs: Vec<String> = points.iter().map(|p| format!("{},{}", number(p[0]), number(p[1]))).collect();
    pairs.join(" ")
}

/// Hundredths of a pixel: finer than any screen or printer shows.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

fn hex(colour: Colour) -> String {
    let [r, g, b] = colour.0;
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Text as XML: markup replaced, characters that XML 1.0 does not allow left out.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&apos;"),
            '\t' | '\n' | '\r' => out.push(' '),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => {}
            c => out.push(c),
        }
    }
    out
}
