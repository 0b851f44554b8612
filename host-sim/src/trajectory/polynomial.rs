//! Stand-in until the polynomial pieces land.
use super::Trajectory;
use super::bspline::BSpline;
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
impl Trajectory for PiecewisePolynomial {
    fn duration_s(&self) -> f64 {
        self.pieces.iter().map(|p| p.duration_s).sum()
    }
    fn at(&self, t_s: f64) -> super::FlatSample {
        let w = self.pieces[0].duration_s;
        let k = ((t_s / w) as usize).min(self.pieces.len() - 1);
        let t = t_s - w * k as f64;
        let p = &self.pieces[k];
        let d = |c: &[f64; 8], o: usize| {
            (o..8).rev().fold(0.0, |s, i| s * t + c[i] * (0..o).map(|j| (i - j) as f64).product::<f64>())
        };
        let v = |o| nalgebra::Vector3::new(d(&p.x, o), d(&p.y, o), d(&p.z, o));
        super::FlatSample {
            position_m: v(0),
            velocity_m_s: v(1),
            acceleration_m_s2: v(2),
            jerk_m_s3: v(3),
            heading_rad: 0.0,
            heading_rate_rad_s: 0.0,
        }
    }
}
