//! An SVG document in, a PNG file's bytes out; and a line of text in, its width out.
//!
//! Both come from one renderer with one font: IBM Plex Sans Regular, SIL Open Font License 1.1
//! (`host-sim/cli/assets/ibm-plex-sans/OFL.txt`), so that figures are the same on every machine, with any fonts of its
//! own, and texts are as wide as the layout takes them to be.

use std::sync::{Arc, LazyLock};

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

use super::FigureError;
use super::style::FONT_FAMILY;
use super::svg::escaped;

/// Pixels of the PNG per SVG user unit.
const SCALE: f32 = 2.0;

/// The embedded face and no other.
static FONTS: LazyLock<Arc<fontdb::Database>> = LazyLock::new(|| {
    const FACE: &[u8] = include_bytes!("../../assets/ibm-plex-sans/IBMPlexSans_400Regular.ttf");
    let mut fonts = fontdb::Database::new();
    fonts.load_font_source(fontdb::Source::Binary(Arc::new(FACE)));
    // For a document of another crate, which names no face.
    fonts.set_sans_serif_family(FONT_FAMILY);
    Arc::new(fonts)
});

fn tree(document: &str) -> Result<Tree, FigureError> {
    let options = Options { fontdb: Arc::clone(&FONTS), ..Options::default() };
    Tree::from_str(document, &options).map_err(|error| FigureError::Rendering(error.to_string()))
}

/// An SVG document as a PNG file, two pixels to a unit, 8-bit RGBA; a figure's are opaque.
///
/// # Errors
/// [`FigureError::Rendering`].
pub fn png(document: &str) -> Result<Vec<u8>, FigureError> {
    let tree = tree(document)?;
    let size = tree.size().to_int_size().scale_by(SCALE);
    let mut pixels = size
        .and_then(|size| Pixmap::new(size.width(), size.height()))
        .ok_or_else(|| FigureError::Rendering("the sheet has no area".into()))?;
    resvg::render(&tree, Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
    pixels.encode_png().map_err(|error| FigureError::Rendering(error.to_string()))
}

/// Advance width of `content` at an em of 1.
pub(super) fn width_em(content: &str) -> Result<f64, FigureError> {
    // The renderer's box around a text runs from its start to its last advance. An em of many units keeps its
    // single-precision coordinates clear of rounding.
    const EM: f64 = 1000.0;
    let document = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"1\" height=\"1\"><text font-family=\"{FONT_FAMILY}\" \
         font-size=\"{EM}\">{}</text></svg>",
        escaped(content)
    );
    Ok(f64::from(tree(&document)?.root().bounding_box().width()) / EM)
}
