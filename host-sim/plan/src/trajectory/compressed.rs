//! Trajectories in the Crazyflie's compressed form: pieces in, bytes of Bezier control points out, and back.
//!
//! The layout is Bitcraze's (crazyflie-firmware, docs/functional-areas/trajectory_formats.md; `pptraj_compressed.c`): where
//! it starts, x, y, z in mm and yaw in tenths of a degree, 16 bits each; then for each piece a byte with two bits a
//! coordinate (constant, linear, cubic, degree 7), the duration in ms, and the control points behind the first, which is
//! the last of the piece before. A piece of no duration ends it. All little endian.
//!
//! A number is 1 mm or 0.1 degrees, so that a coordinate is off by half of that, at most: by the convex hull of its control
//! points. Its velocity is off by `14 * 0.5 mm / duration`. Durations are cut to a millisecond each, from the start of the
//! trajectory, so that they do not add up; they put a curve off by half a millisecond of its speed besides.

use super::polynomial::{COEFFICIENTS, Coordinate, Piece, PiecewisePolynomial, PolynomialError};

/// Tenths of a degree in a radian.
const YAW_UNITS: f64 = 1800.0 / std::f64::consts::PI;
const START_BYTES: usize = 8;
/// Control points behind the first, by the two bits.
const POINTS: [usize; 4] = [0, 1, 3, 7];

/// Why a trajectory has no compressed form, or bytes are none.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompressedError {
    /// Beyond 16 bits.
    #[error(
        "piece {piece}: a control point of {coordinate} is at {value:.1} {0}; the compressed form holds {1:.1}: {2} or \
         fly it by pieces of polynomials", coordinate.unit(), f64::from(i16::MAX) / units(*coordinate),
        if *coordinate == Coordinate::Yaw { "take whole turns off its yaw" } else { "move the trajectory's origin" }
    )]
    TooFar {
        /// The piece's number, from 1.
        piece: usize,
        /// The coordinate.
        coordinate: Coordinate,
        /// Value of the control point, m or rad.
        value: f64,
    },
    /// A piece beyond 16 bits of milliseconds, or below one.
    #[error(
        "piece {piece}: lasts {duration_s} s; the compressed form holds 0.001 to 65.535 s a piece: split or join it"
    )]
    Duration {
        /// The piece's number, from 1.
        piece: usize,
        /// Its duration, s.
        duration_s: f64,
    },
    /// Bytes that end within a piece, or go on behind the end.
    #[error("no compressed trajectory: its {length} bytes end within piece {piece}, or go on behind its end")]
    Length {
        /// The number of bytes.
        length: usize,
        /// The piece's number, from 1.
        piece: usize,
    },
    /// Its pieces make no trajectory.
    #[error(transparent)]
    Pieces(#[from] PolynomialError),
}

fn units(coordinate: Coordinate) -> f64 {
    if coordinate == Coordinate::Yaw { YAW_UNITS } else { 1000.0 }
}

/// C(n, k).
fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64)
}

/// Bezier control points of degree 7, of a polynomial over its duration.
fn control_points(coefficients: &[f64; COEFFICIENTS], duration_s: f64) -> [f64; COEFFICIENTS] {
    // b_i = sum over k of C(i, k) / C(7, k) times the coefficient in unit time.
    std::array::from_fn(|i| {
        (0..=i).map(|k| binomial(i, k) / binomial(7, k) * coefficients[k] * duration_s.powi(k as i32)).sum()
    })
}

/// The polynomial over its duration of Bezier control points of any degree.
fn polynomial(points: &[f64], duration_s: f64) -> [f64; COEFFICIENTS] {
    let degree = points.len() - 1;
    let mut differences = points.to_vec();
    let mut coefficients = [0.0; COEFFICIENTS];
    for (k, coefficient) in coefficients.iter_mut().enumerate().take(degree + 1) {
        *coefficient = binomial(degree, k) * differences[0] / duration_s.powi(k as i32);
        differences = differences.windows(2).map(|pair| pair[1] - pair[0]).collect();
    }
    coefficients
}

/// The bytes of a trajectory.
///
/// # Errors
/// [`CompressedError`] for a number that 16 bits do not hold.
pub fn to_bytes(trajectory: &PiecewisePolynomial) -> Result<Vec<u8>, CompressedError> {
    let mut bytes = Vec::new();
    let boundaries_s = trajectory.boundaries_s();
    let mut last = [0_i16; 4];
    for (index, piece) in trajectory.pieces().iter().enumerate() {
        let number = index + 1;
        let [from_ms, to_ms] = [boundaries_s[index], boundaries_s[index + 1]].map(|s| (1e3 * s).round());
        let duration_ms = to_ms - from_ms;
        if !(1.0..=f64::from(u16::MAX)).contains(&duration_ms) {
            return Err(CompressedError::Duration { piece: number, duration_s: piece.duration_s });
        }
        let mut scaled = [[0.0; COEFFICIENTS]; 4];
        for coordinate in Coordinate::ALL {
            let points = control_points(&piece.coefficients[coordinate as usize], piece.duration_s);
            for (place, value) in scaled[coordinate as usize].iter_mut().zip(points) {
                *place = value * units(coordinate);
                if place.is_nan() || place.round().abs() > f64::from(i16::MAX) {
                    return Err(CompressedError::TooFar { piece: number, coordinate, value });
                }
            }
        }
        if index == 0 {
            last = scaled.map(|points| points[0].round() as i16);
            last.iter().for_each(|value| bytes.extend(value.to_le_bytes()));
        }
        let bodies: [Vec<i16>; 4] = std::array::from_fn(|i| body(last[i], &scaled[i]));
        let kinds =
            bodies.each_ref().map(|body| POINTS.iter().position(|points| *points == body.len()).unwrap_or(3) as u8);
        bytes.push(kinds[0] | kinds[1] << 2 | kinds[2] << 4 | kinds[3] << 6);
        bytes.extend((duration_ms as u16).to_le_bytes());
        bodies.iter().flatten().for_each(|value| bytes.extend(value.to_le_bytes()));
        for (last, body) in last.iter_mut().zip(&bodies) {
            *last = body.last().copied().unwrap_or(*last);
        }
    }
    bytes.extend([0; 3]);
    Ok(bytes)
}

/// The shortest body whose curve has these control points to their rounding, from where the piece before ended.
fn body(first: i16, points: &[f64; COEFFICIENTS]) -> Vec<i16> {
    let close = |low: &[i16]| {
        let low: Vec<f64> = low.iter().map(|value| f64::from(*value)).collect();
        let raised = control_points(&polynomial(&low, 1.0), 1.0);
        // Half a unit, and rounding of numbers up to 2^15.
        raised.iter().zip(points).all(|(value, point)| (value - point).abs() <= 0.5 + 1e-9)
    };
    let end = points[COEFFICIENTS - 1].round() as i16;
    // A cubic has the slopes of the curve at its ends: its inner points are 7/3 of the way to those of degree 7.
    let inner = |end: f64, next: f64| (end + 7.0 / 3.0 * (next - end)).round().clamp(-32767.0, 32767.0) as i16;
    let [from, to] = [inner(points[0], points[1]), inner(points[COEFFICIENTS - 1], points[COEFFICIENTS - 2])];
    if close(&[first]) {
        Vec::new()
    } else if close(&[first, end]) {
        vec![end]
    } else if close(&[first, from, to, end]) {
        vec![from, to, end]
    } else {
        points[1..].iter().map(|value| value.round() as i16).collect()
    }
}

/// The trajectory of bytes; nothing may be behind the piece of no duration.
///
/// # Errors
/// [`CompressedError`] for bytes that are none.
pub fn from_bytes(bytes: &[u8]) -> Result<PiecewisePolynomial, CompressedError> {
    let wrong = |piece| CompressedError::Length { length: bytes.len(), piece };
    let number = |at: usize| Some(i16::from_le_bytes([*bytes.get(at)?, *bytes.get(at + 1)?]));
    let mut last = [0_i16; 4];
    for (i, value) in last.iter_mut().enumerate() {
        *value = number(2 * i).ok_or(wrong(1))?;
    }
    let mut at = START_BYTES;
    let mut pieces = Vec::new();
    while at < bytes.len() {
        let kinds = bytes[at];
        let duration_ms = number(at + 1).ok_or(wrong(pieces.len() + 1))? as u16;
        at += 3;
        if duration_ms == 0 {
            break;
        }
        let mut piece = Piece { duration_s: f64::from(duration_ms) * 1e-3, coefficients: [[0.0; COEFFICIENTS]; 4] };
        for coordinate in Coordinate::ALL {
            let i = coordinate as usize;
            let mut points = vec![f64::from(last[i]) / units(coordinate)];
            for _ in 0..POINTS[usize::from(kinds >> (2 * i) & 3)] {
                last[i] = number(at).ok_or(wrong(pieces.len() + 1))?;
                points.push(f64::from(last[i]) / units(coordinate));
                at += 2;
            }
            piece.coefficients[i] = polynomial(&points, piece.duration_s);
        }
        pieces.push(piece);
    }
    if at != bytes.len() || pieces.is_empty() {
        return Err(wrong(pieces.len()));
    }
    Ok(PiecewisePolynomial::new(pieces)?)
}

#[cfg(test)]
mod tests;
