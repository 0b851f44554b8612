//! Stand-in until the polynomial pieces land.
use super::bspline::BSpline;
use super::Trajectory;
/// Piece.
#[derive(Clone, Debug)]
pub struct PolynomialPiece {
    /// s
    pub duration_s: f64,
    /// x
    pub x: [f64; 8],
    /// y
    pub y: [f64; 8],
    /// z
    pub z: [f64; 8],
    /// yaw
    pub yaw: [f64; 8],
}
/// Pieces.
pub struct PiecewisePolynomial {
    pieces: Vec<PolynomialPiece>,
}
impl PiecewisePolynomial {
    /// pieces
    pub fn pieces(&self) -> &[PolynomialPiece] {
        &self.pieces
    }
    /// from
    pub fn from_bspline(s: &BSpline) -> Self {
        let w = s.duration_s() / s.spans() as f64;
        let pieces = (0..s.spans())
            .map(|k| {
                let mut c = [[0.0; 8]; 3];
                let mut f = 1.0;
                for o in 0..=s.degree() {
                    if o > 0 {
                        f *= o as f64;
                    }
                    let d = s.derivative(o, (k as f64 + 1e-12) * w);
                    for i in 0..3 {
                        c[i][o] = d[i] / f;
                    }
                }
                PolynomialPiece { duration_s: w, x: c[0], y: c[1], z: c[2], yaw: [0.0; 8] }
            })
            .collect();
        Self { pieces }
    }
}
