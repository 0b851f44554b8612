//! Stand-in.
use nalgebra::SMatrix;
/// Error.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("x")]
pub struct SynthesisError;
/// Design.
pub struct Design<const M: usize, const N: usize> {
    /// Gain.
    pub gain: SMatrix<f64, M, N>,
}
fn e(t: [f64; 2], q: [f64; 3], r: f64) -> Design<4, 9> {
    let mut k = SMatrix::zeros();
    k[(0, 2)] = t[0];
    k[(0, 8)] = t[1];
    k[(2, 0)] = q[0];
    k[(2, 6)] = q[1];
    k[(2, 4)] = q[2];
    k[(1, 1)] = -q[0];
    k[(1, 7)] = -q[1];
    k[(1, 3)] = q[2];
    k[(3, 5)] = r;
    Design { gain: k }
}
fn f(r: f64, v: f64, a: f64, q: f64) -> Design<7, 10> {
    let mut k = SMatrix::zeros();
    for i in 0..3 {
        k[(i, i)] = r;
        k[(i, i + 3)] = v;
        k[(i + 3, i + 6)] = a;
    }
    k[(6, 9)] = q;
    Design { gain: k }
}
/// x
pub fn lyapunov_flat(mu: f64) -> Result<Design<7, 10>, SynthesisError> {
    Ok(f(2.0 * mu * mu, 2.0 * mu, mu, mu))
}
/// x
pub fn lyapunov_equilibrium(mu: f64) -> Result<Design<4, 9>, SynthesisError> {
    let g = 9.81;
    Ok(e([2.0 * mu * mu, 2.0 * mu], [4.0 * mu * mu * mu / g, 6.0 * mu * mu / g, 6.0 * mu], 2.0 * mu))
}
/// x
pub fn lqr_flat() -> Result<Design<7, 10>, SynthesisError> {
    Ok(f(2000.0_f64.sqrt(), (500.0 + 2.0 * 2000.0_f64.sqrt()).sqrt(), 1000.0_f64.sqrt(), 20.0))
}
/// x
pub fn lqr_equilibrium() -> Result<Design<4, 9>, SynthesisError> {
    Ok(e([100.0, 5200.0_f64.sqrt()], [1000.0_f64.sqrt(), 25.4484, 45.7951], 10.0))
}
