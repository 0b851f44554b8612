//! Section III on the paper's own models: the numbers that pencil gives.

use nalgebra::{Complex, DMatrix};
use quatrack_design::analysis::{SectionThree, jordan_blocks};

#[test]
fn eigenvalues_of_both_models_are_all_zero() {
    let models = SectionThree::new().expect("the paper's models are finite");
    for model in [&models.flat, &models.equilibrium] {
        assert_eq!(model.eigenvalues, vec![Complex::new(0.0, 0.0); 10], "{}", model.label);
    }
}

#[test]
fn jordan_blocks_are_those_of_the_integrator_chains() {
    let models = SectionThree::new().expect("the paper's models are finite");
    // r' = v three times, and a, q3 alone; not the block of size 10 that the paper states.
    assert_eq!(models.flat.jordan[0].block_sizes, [2, 2, 2, 1, 1, 1, 1]);
    // x'' = 2 g q2, y'' = -2 g q1, z'' = 2 g q0, and q3 alone.
    assert_eq!(models.equilibrium.jordan[0].block_sizes, [3, 3, 3, 1]);
    assert_eq!(models.flat.jordan[0].ranks, [3, 0, 0]);
    assert_eq!(models.equilibrium.jordan[0].ranks, [6, 3, 0, 0]);
}

#[test]
fn ranks_are_ten_and_nine_by_all_three_tests() {
    let models = SectionThree::new().expect("the paper's models are finite");
    for (model, rank) in [(&models.flat, 10), (&models.equilibrium, 9)] {
        assert_eq!(model.controllability.rank, rank, "{}", model.label);
        assert_eq!(model.staircase.uncontrollable, 10 - rank, "{}", model.label);
        assert_eq!(model.pbh[0].rank, rank, "{}", model.label);
        // The decision is not close: the singular values on either side of it are far from the tolerance.
        let values = &model.controllability.singular_values;
        assert!(values[rank - 1] > 1e10 * model.controllability.tolerance, "{values:?}");
        assert!(values[rank..].iter().all(|value| *value == 0.0), "{values:?}");
    }
    assert!(models.flat.stabilisable && !models.equilibrium.stabilisable);
}

#[test]
fn the_uncontrollable_mode_is_exactly_q0_and_t_is_a_permutation() {
    let models = SectionThree::new().expect("the paper's models are finite");
    let staircase = &models.equilibrium.staircase;
    assert_eq!(models.equilibrium.uncontrollable_modes[0].combination, [("q0".to_owned(), 1.0)]);
    assert_eq!(staircase.uncontrollable_a(), DMatrix::zeros(1, 1));
    assert_eq!(staircase.steps, [2, 3, 4]);
    // q0; x, y; z, vx, vy; q1, q2, q3, vz: the order in which the paper's weights Q_e make sense.
    let order = [3, 0, 1, 2, 7, 8, 4, 5, 6, 9];
    let permutation = DMatrix::from_fn(10, 10, |i, j| if order[i] == j { 1.0 } else { 0.0 });
    assert_eq!(staircase.transformation, permutation);
    // (11): nothing drives the mode, neither the input nor the other states.
    assert!(staircase.a.view((0, 1), (1, 9)).iter().all(|value| *value == 0.0));
    assert!(staircase.b.row(0).iter().all(|value| *value == 0.0));
    let (a, b) = staircase.controllable_pair();
    assert_eq!((a.shape(), b.shape()), ((9, 9), (9, 4)));
    // The mode acts on vz alone, by 2 g.
    assert_eq!(staircase.coupling().iter().filter(|value| **value != 0.0).count(), 1);
    assert!((staircase.coupling()[(8, 0)] - 2.0 * 9.81).abs() < 1e-14);
}

#[test]
fn a_number_that_is_no_eigenvalue_has_no_jordan_block() {
    let models = SectionThree::new().expect("the paper's models are finite");
    let structure = jordan_blocks(&models.equilibrium.a, Complex::new(1.0, 2.0)).expect("finite");
    assert!(structure.block_sizes.is_empty());
    assert_eq!(structure.ranks, [10]);
}
