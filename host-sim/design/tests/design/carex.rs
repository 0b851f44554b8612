//! An extra check where the folder `shared` is beside the repository: the CAREX cases it holds.

use std::path::{Path, PathBuf};

use nalgebra::DMatrix;
use quatrack_design::design::{RiccatiSolution, care, strong_care};

struct Case {
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    q: DMatrix<f64>,
    r: DMatrix<f64>,
    exact: Option<DMatrix<f64>>,
}

impl Case {
    /// Format of the folder's README: a name, `n m p hasX`, then A, B, C, R, W and X by rows; Q = C' W C.
    fn read(path: &Path) -> Self {
        let text = std::fs::read_to_string(path).expect("readable");
        let mut lines = text.lines().skip(1);
        let header: Vec<usize> =
            lines.next().expect("sizes").split_whitespace().map(|value| value.parse().expect("a size")).collect();
        let (n, m, p) = (header[0], header[1], header[2]);
        let mut values = lines.flat_map(str::split_whitespace).map(|value| value.parse::<f64>().expect("a number"));
        let mut next = |rows, columns| {
            DMatrix::from_row_iterator(rows, columns, (0..rows * columns).map(|_| values.next().expect("an entry")))
        };
        let (a, b, c, r, w) = (next(n, n), next(n, m), next(p, n), next(m, m), next(p, p));
        let q = c.transpose() * w * c;
        let q = (&q + q.transpose()) * 0.5;
        Self { a, b, q, r, exact: (header[3] == 1).then(|| next(n, n)) }
    }

    fn solve(&self) -> RiccatiSolution {
        care(&self.a, &self.b, &self.q, &self.r).expect("a stabilising solution exists")
    }

    fn forward_error(&self, solution: &RiccatiSolution) -> f64 {
        let exact = self.exact.as_ref().expect("the case has its exact solution");
        (&solution.p - exact).norm() / exact.norm()
    }
}

/// The folder, or a line that says why nothing was checked.
fn folder() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/carex");
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: {} is not there", folder.display());
    None
}

#[test]
fn exact_solutions_come_out_to_the_last_digits() {
    let Some(folder) = folder() else { return };
    // Case, and its bound: an ulp or two, since P is rounded once and the file's X is, too. SciPy's own errors, after
    // the folder's README: 1e-15, 1e-15, 2e-12, 4e-15, 3e-11.
    for name in ["1_1", "1_2", "2_1", "2_3", "2_4"] {
        let case = Case::read(&folder.join(format!("carex_{name}.txt")));
        let error = case.forward_error(&case.solve());
        assert!(error <= 5e-16, "{name}: {error:e}");
    }
}

#[test]
fn cases_without_an_exact_solution_have_residuals_of_rounding() {
    let Some(folder) = folder() else { return };
    for name in ["1_3", "1_4", "1_5", "1_6"] {
        let solution = Case::read(&folder.join(format!("carex_{name}.txt"))).solve();
        // Rounding P to f64 alone leaves this.
        assert!(solution.relative_residual <= 1e-15, "{name}: {:e}", solution.relative_residual);
        assert!(solution.last_correction <= 1e-17, "{name}: {:e}", solution.last_correction);
        assert!(solution.poles.iter().all(|pole| pole.re < 0.0), "{name}");
    }
}

#[test]
fn a_nearly_singular_input_weight_is_known_beyond_an_f64() {
    let Some(folder) = folder() else { return };
    let solution = Case::read(&folder.join("carex_2_2.txt")).solve();
    assert!(solution.last_correction <= 1e-17, "{:e}", solution.last_correction);
    // eps = 1e-8 in R, so that rounding P is felt 1e4 times, by 1 / sqrt(eps), in B' P.
    assert!(solution.relative_residual <= 1e-12, "{:e}", solution.relative_residual);
}

#[test]
fn the_case_with_poles_on_the_axis_has_its_strong_solution() {
    let Some(folder) = folder() else { return };
    let case = Case::read(&folder.join("carex_2_5.txt"));
    let solution = strong_care(&case.a, &case.b, &case.q, &case.r).expect("a strong solution exists");
    // SciPy: 1e-8. The steps halve the error until the closed loop's own rounding.
    assert!(case.forward_error(&solution) <= 1e-13, "{:e}", case.forward_error(&solution));
}
