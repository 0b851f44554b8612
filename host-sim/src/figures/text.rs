//! The embedded font: a text and a size in, its width or its coverage of pixels out.
//!
//! IBM Plex Sans Regular, SIL Open Font License 1.1 (`host-sim/assets/ibm-plex-sans/OFL.txt`): figures are the same on
//! every machine, whatever fonts it has.

use std::sync::OnceLock;

use plotters::style::{FontDesc, FontFamily, FontStyle, register_font};

const FONT: &[u8] = include_bytes!("../../assets/ibm-plex-sans/IBMPlexSans_400Regular.ttf");
const FAMILY: &str = "IBM Plex Sans";

/// The rasteriser sizes a face by ascender to descender; a designer, and SVG, by the em. The face's `hhea` table has
/// 1025 up and 275 down on an em of 1000.
const HEIGHT_PER_EM: f64 = 1.3;

/// Height of capitals and figures, em (`sCapHeight` 698 of 1000).
pub(super) const CAP_HEIGHT: f64 = 0.698;

/// Glyphs are rasterised this much larger and averaged down, so that they stand to a quarter of a pixel and not to a
/// whole one.
const OVERSAMPLING: i32 = 4;

/// The font file is part of the program; if it cannot be read, no text can be drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FontUnusable;

fn font(size_em: f64) -> Result<FontDesc<'static>, FontUnusable> {
    static REGISTERED: OnceLock<bool> = OnceLock::new();
    if !*REGISTERED.get_or_init(|| register_font(FAMILY, FontStyle::Normal, FONT).is_ok()) {
        return Err(FontUnusable);
    }
    Ok(FontDesc::new(FontFamily::Name(FAMILY), size_em * HEIGHT_PER_EM, FontStyle::Normal))
}

/// Advance width of `content` at an em of 1.
pub(super) fn width_em(content: &str) -> Result<f64, FontUnusable> {
    // The layout is in whole pixels: ask at an em of many.
    const EM: f64 = 1000.0;
    let ((_, _), (width, _)) = font(EM)?.layout_box(content).map_err(|_| FontUnusable)?;
    Ok(f64::from(width) / EM)
}

/// Coverage in 0..=1 of the pixels that `content` touches, as (column from the text's start, row from its baseline,
/// coverage); columns go right and rows down.
pub(super) fn coverage(content: &str, size_em: f64) -> Result<Vec<(i32, i32, f32)>, FontUnusable> {
    let height = size_em * HEIGHT_PER_EM * f64::from(OVERSAMPLING);
    // The face is drawn with its baseline half the height below the point it is drawn at.
    let baseline = (height / 2.0) as i32;
    let mut fine = Vec::new();
    let drawn = font(size_em * f64::from(OVERSAMPLING))?.draw(content, (0, 0), |x, y, value| {
        fine.push((y.wrapping_sub(baseline).div_euclid(OVERSAMPLING), x.div_euclid(OVERSAMPLING), value));
        Ok::<(), ()>(())
    });
    if !matches!(drawn, Ok(Ok(()))) {
        return Err(FontUnusable);
    }
    fine.sort_by_key(|&(row, column, _)| (row, column));
    let share = 1.0 / (OVERSAMPLING * OVERSAMPLING) as f32;
    let same_pixel = |a: &(i32, i32, f32), b: &(i32, i32, f32)| a.0 == b.0 && a.1 == b.1;
    Ok(fine
        .chunk_by(same_pixel)
        .map(|pixel| {
            let sum: f32 = pixel.iter().map(|&(_, _, value)| value).sum();
            (pixel[0].1, pixel[0].0, (sum * share).min(1.0))
        })
        .collect())
}
