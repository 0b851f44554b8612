//! Lines, curves, areas and texts in, the first one lowest; an SVG document out.
//!
//! Coordinates are user units, x to the right, y down. Curves are polylines, dashes are dashes and texts are texts, for
//! an editor of the figure.

use super::style::{Colour, FONT_FAMILY, Stroke};

/// Which point of a text its position names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A white sheet and the shapes drawn on it.
pub(super) struct Sheet {
    svg: String,
}

impl Sheet {
    /// An empty sheet; the title is for readers that announce one.
    pub(super) fn new([width, height]: [f64; 2], title: &str) -> Self {
        let svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} \
             {height}\" font-family=\"'{FONT_FAMILY}', sans-serif\" stroke-linecap=\"round\" \
             stroke-linejoin=\"round\">\n<title>{}</title>\n<rect width=\"{width}\" height=\"{height}\" \
             fill=\"{}\"/>\n",
            escaped(title),
            hex(Colour::PAPER)
        );
        Self { svg }
    }

    /// The document, ended by a line feed.
    pub(super) fn into_document(mut self) -> String {
        self.svg.push_str("</svg>\n");
        self.svg
    }

    /// A straight line: grid, axes, ticks.
    pub(super) fn line(&mut self, from: [f64; 2], to: [f64; 2], stroke: Stroke) {
        let [x1, y1, x2, y2] = [from[0], from[1], to[0], to[1]].map(number);
        let stroke = stroke_attributes(stroke);
        self.svg.push_str(&format!("<line x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\"{stroke}/>\n"));
    }

    /// Data.
    pub(super) fn curve(&mut self, points: &[[f64; 2]], stroke: Stroke) {
        let (stroke, points) = (stroke_attributes(stroke), point_list(points));
        self.svg.push_str(&format!("<polyline fill=\"none\"{stroke} points=\"{points}\"/>\n"));
    }

    /// A filled polygon.
    pub(super) fn area(&mut self, corners: &[[f64; 2]], colour: Colour) {
        let (fill, points) = (hex(colour), point_list(corners));
        self.svg.push_str(&format!("<polygon fill=\"{fill}\" points=\"{points}\"/>\n"));
    }

    /// One line of text of em size `size`, with its baseline at `at`.
    pub(super) fn text(&mut self, content: &str, at: [f64; 2], size: f64, anchor: Anchor) {
        self.turned_text(content, at, size, anchor, "");
    }

    /// The same about its middle, turned a quarter counter-clockwise: it reads upwards.
    pub(super) fn text_upwards(&mut self, content: &str, at: [f64; 2], size: f64) {
        let turn = format!(" transform=\"rotate(-90 {} {})\"", number(at[0]), number(at[1]));
        self.turned_text(content, at, size, Anchor::Middle, &turn);
    }

    fn turned_text(&mut self, content: &str, at: [f64; 2], size: f64, anchor: Anchor, turn: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let ([x, y, size], fill) = ([at[0], at[1], size].map(number), hex(Colour::INK));
        self.svg.push_str(&format!(
            "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\" text-anchor=\"{anchor}\" fill=\"{fill}\"{turn}>{}</text>\n",
            escaped(content)
        ));
    }
}

fn stroke_attributes(stroke: Stroke) -> String {
    let (colour, width) = (hex(stroke.colour), number(stroke.width));
    let dash = stroke.dash.map_or_else(String::new, |dash| {
        let [dash, gap] = dash.map(number);
        format!(" stroke-dasharray=\"{dash} {gap}\"")
    });
    format!(" stroke=\"{colour}\" stroke-width=\"{width}\"{dash}")
}

fn point_list(points: &[[f64; 2]]) -> String {
    let pairs: Vec<String> = points.iter().map(|p| format!("{},{}", number(p[0]), number(p[1]))).collect();
    pairs.join(" ")
}

/// Hundredths of a unit: finer than any screen or printer shows.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

fn hex(Colour([r, g, b]): Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Text as XML: markup replaced, characters that XML 1.0 does not allow left out.
pub(super) fn escaped(text: &str) -> String {
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
