//! The same problem with kernels for its sizes and with general ones, and with components integrated out or not.

use super::dense::unknowns_of_direction;
use super::linear::{Case, SHAPES, random_residual};
use super::problems::{Inert, factored};
use super::{Random, distance, largest};
use crate::{Dimensions, Gauss, Kernels, Solution};
use crate::{Direction, LinearCondition, Residual};

/// Sizes that [`Quadratic`](super::problems::Quadratic) has kernels for: 7 components, 3 integrable, and 2 lanes of columns, with 3 or 4 stages.
fn unrolled() -> impl Iterator<Item = (Dimensions, usize)> {
    let cell = Dimensions { components: 7, integrable: 3, scalars: 2, left: 4, right: 4, integrals: 1 };
    [2, 3, 5].into_iter().flat_map(move |scalars| [3, 4].map(|m| (Dimensions { scalars, ..cell }, m)))
}

/// Rows of n values as rows of n + 1 values, the last of them zero.
fn widened(v: &[f64], n: usize) -> Vec<f64> {
    v.chunks_exact(n).flat_map(|row| row.iter().copied().chain([0.0])).collect()
}

/// The values of [`widened`] rows without the added ones, which must be zero.
fn narrowed(v: &[f64], n: usize) -> Vec<f64> {
    assert!(v.chunks_exact(n + 1).all(|row| row[n] == 0.0), "the added component stays zero");
    v.chunks_exact(n + 1).flat_map(|row| row[..n].to_vec()).collect()
}

fn widened_solution(y: &Solution) -> Solution {
    let n = y.components;
    Solution { components: n + 1, nodes: widened(&y.nodes, n), stages: widened(&y.stages, n), ..y.clone() }
}

fn widened_conditions(conditions: &[LinearCondition], n: usize) -> Vec<LinearCondition> {
    conditions.iter().map(|c| LinearCondition { nodes: widened(&c.nodes, n), ..c.clone() }).collect()
}

#[test]
fn sized_kernels_give_the_bits_of_the_general_ones() {
    for (dims, m) in unrolled() {
        let mut case = Case::new(dims, m, 3, &mut Random(41 + m as u64));
        let r = random_residual(&case.system.residual, &mut Random(43));
        let (mut sized, mut general) = (Direction::default(), Direction::default());
        case.system.solve(&r, &mut sized);
        case.problem.sized = false;
        let mut system = factored(&mut case.problem, &case.y, &case.conditions);
        system.solve(&r, &mut general);
        assert_eq!((&system.residual, general), (&case.system.residual, sized));
        assert_eq!(system.determinant(), case.system.determinant());
    }
}

#[test]
fn kernels_for_other_sizes_are_not_used() {
    let layout = |dims| crate::condense::Layout::new(dims, 3);
    let kernels = Kernels::sized::<7, 3, 3, 4>();
    let mut chosen = unrolled().map(|(dims, _)| kernels.suited_to(&layout(dims)).is_sized());
    assert!(chosen.all(|sized| sized));
    for dims in SHAPES.into_iter().filter(|d| d.components != 7) {
        assert!(!kernels.suited_to(&layout(dims)).is_sized());
    }
}

#[test]
fn unrolled_residuals_are_the_general_ones_to_the_last_bit() {
    // Neither path reorders a sum, and the component added takes part in none of the others.
    for (dims, m) in unrolled() {
        let case = Case::new(dims, m, 3, &mut Random(m as u64));
        let conditions = widened_conditions(&case.conditions, 7);
        let general = factored(&mut Inert(case.problem), &widened_solution(&case.y), &conditions);
        let (a, b) = (&case.system.residual, &general.residual);
        assert_eq!(a.stages, narrowed(&b.stages, 7));
        assert_eq!(a.nodes, narrowed(&b.nodes, 7));
    }
}

#[test]
fn unrolled_solves_and_determinants_are_the_general_ones() {
    for (dims, m) in unrolled() {
        let mut random = Random(17 + m as u64);
        let mut case = Case::new(dims, m, 3, &mut random);
        let r = random_residual(&case.system.residual, &mut random);
        let mut unrolled = Direction::default();
        case.system.solve(&r, &mut unrolled);
        let conditions = widened_conditions(&case.conditions, 7);
        let mut general = factored(&mut Inert(case.problem), &widened_solution(&case.y), &conditions);
        let left = [&r.left[..], &[0.0]].concat();
        let wide = Residual { stages: widened(&r.stages, 7), nodes: widened(&r.nodes, 7), left, ..r };
        let mut update = Direction::default();
        general.solve(&wide, &mut update);
        let general_solution = [narrowed(&update.nodes, 7), narrowed(&update.stages, 7), update.scalars].concat();
        let unrolled = unknowns_of_direction(&unrolled);
        let tolerance = case.dense.tolerance();
        assert!(distance(&unrolled, &general_solution) <= tolerance * largest(&unrolled), "{dims:?} m={m}");
        // The component added has D as its stage matrix on every interval.
        let stage = super::dense::Matrix { n: m, a: Gauss::new(m).d_matrix }.factor().determinant.log_abs;
        let (a, b) = (case.system.determinant().log_abs, general.determinant().log_abs);
        assert!((b - a - 3.0 * stage).abs() <= case.dense.determinant_tolerance(), "{dims:?} m={m}: {a} {b}");
    }
}

#[test]
fn integrating_components_out_changes_no_solution() {
    for dims in SHAPES.into_iter().filter(|d| d.integrable > 0) {
        for m in 1..=5 {
            let mut random = Random(29 + m as u64);
            let mut case = Case::new(dims, m, 3, &mut random);
            let r = random_residual(&case.system.residual, &mut random);
            let (mut integrated, mut plain) = (Direction::default(), Direction::default());
            case.system.solve(&r, &mut integrated);
            for fewer in 0..dims.integrable {
                case.problem.dims.integrable = fewer;
                let mut system = factored(&mut case.problem, &case.y, &case.conditions);
                assert_eq!(system.residual, case.system.residual);
                system.solve(&r, &mut plain);
                let (a, b) = (unknowns_of_direction(&integrated), unknowns_of_direction(&plain));
                assert!(distance(&a, &b) <= case.dense.tolerance() * largest(&a), "{dims:?} m={m} {fewer}");
                case.assert_determinant(&case.dense, system.determinant());
            }
        }
    }
}
