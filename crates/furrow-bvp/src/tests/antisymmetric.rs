//! Antisymmetric problems on a factorised system, with other right end rows and without scalars and borders, against the
//! dense ones.

use super::dense::{Factorised, Matrix, equations, jacobian, unknowns_of_direction};
use super::linear::{Case, SHAPES, for_every_shape, random_residual};
use super::{Random, largest};
use crate::{AntisymmetricEnd, Determinant, Direction, FactorisationError, PivotFailure, Residual};

/// The rows at the right end of an antisymmetric problem of `case`, n for each of the conditions the left ones leave open.
fn right_rows(case: &Case, random: &mut Random) -> Option<Vec<f64>> {
    let dims = case.problem.dims;
    // Too many left conditions leave no square system without the scalars.
    (dims.left <= dims.components).then(|| random.vector((dims.components - dims.left) * dims.components))
}

/// Stage, node and left rows of the full Jacobian without the columns of the scalars, then the right rows.
fn dense_antisymmetric(case: &Case, right: &[f64]) -> Factorised {
    let full = jacobian(&case.problem, &case.y, &case.conditions);
    let r = &case.system.residual;
    let kept = r.stages.len() + r.nodes.len() + r.left.len();
    let (nodes, n) = (case.y.nodes.len(), case.y.components);
    let size = nodes + case.y.stages.len();
    let mut a: Vec<f64> = full.a.chunks_exact(full.n).take(kept).flat_map(|row| row[..size].to_vec()).collect();
    for row in right.chunks_exact(n) {
        let mut wide = vec![0.0; size];
        wide[nodes - n..nodes].copy_from_slice(row);
        a.extend(wide);
    }
    Matrix { n: size, a }.factor()
}

fn with_rows(rows: Vec<f64>) -> AntisymmetricEnd {
    let mut end = AntisymmetricEnd::default();
    end.rows = rows;
    end
}

/// Every case that has antisymmetric problems, with right rows, their dense counterpart and their factors.
fn for_every_antisymmetric(
    mut test: impl FnMut(&mut Case, &[f64], &Factorised, &AntisymmetricEnd, Determinant, &mut Random),
) {
    let mut seen = 0;
    for_every_shape(|mut case, random| {
        let Some(right) = right_rows(&case, random) else { return };
        let dense = dense_antisymmetric(&case, &right);
        let mut end = with_rows(right.clone());
        let determinant = case.system.factor_antisymmetric_rows(&mut end).unwrap();
        test(&mut case, &right, &dense, &end, determinant, random);
        seen += 1;
    });
    assert!(seen > SHAPES.len(), "hardly any shape has antisymmetric problems");
}

/// A random right-hand side of an antisymmetric problem: no border, and as many right rows as it has.
fn antisymmetric_residual(case: &Case, right: &[f64], random: &mut Random) -> Residual {
    let r = random_residual(&case.system.residual, random);
    Residual { right: random.vector(right.len() / case.y.components), border: Vec::new(), ..r }
}

/// Compares with the dense problem, J times the solution with the residual, and the last node alone with the full solution.
#[test]
fn antisymmetric_problems_are_solved_as_the_dense_ones() {
    for_every_antisymmetric(|case, right, dense, end, _, random| {
        let mut r = antisymmetric_residual(case, right, random);
        let b: Vec<f64> = equations(&r).iter().map(|v| -v).collect();
        let (mut update, mut last) = (Direction::default(), Direction::default());
        case.system.solve_antisymmetric_last_node(end, &r, &mut last).unwrap();
        case.system.solve_antisymmetric(end, &r, &mut update).unwrap();
        let from = case.y.nodes.len() - case.y.components;
        assert_eq!(update.nodes[from..], last.nodes[from..]);
        assert!(update.scalars.iter().all(|p| *p == 0.0), "an antisymmetric problem has no scalars");
        update.scalars.clear();
        dense.assert_solves(&unknowns_of_direction(&update), &b, "antisymmetric");
        case.system.apply_antisymmetric(end, &update, &mut r).unwrap();
        let (left, scale) = (largest(&equations(&r)), largest(&unknowns_of_direction(&update)).max(1.0));
        assert!(left < 1e-11 * scale, "{left} of {scale}");
    });
}

#[test]
fn right_hand_sides_of_the_right_rows_alone_are_solved_for() {
    for_every_antisymmetric(|case, right, dense, end, _, random| {
        let values = random.vector(right.len() / case.y.components);
        if values.is_empty() {
            return;
        }
        // The workspace is left dirty on purpose: what was solved for before must not be seen.
        let mut update = Direction::default();
        case.system.solve_own(&mut update).unwrap();
        case.system.solve_antisymmetric_unit(end, &values, &mut update).unwrap();
        update.scalars.clear();
        let mut b = vec![0.0; unknowns_of_direction(&update).len() - values.len()];
        b.extend(values);
        dense.assert_solves(&unknowns_of_direction(&update), &b, "right rows");
    });
}

#[test]
fn an_antisymmetric_problem_leaves_the_factors_of_the_problem_itself_alone() {
    for_every_antisymmetric(|case, _, _, end, _, _| {
        let (mut before, mut after) = (Direction::default(), Direction::default());
        let determinant = case.system.determinant();
        case.system.solve_own(&mut before).unwrap();
        let values = vec![1.0; case.problem.dims.components - case.problem.dims.left];
        case.system.solve_antisymmetric_unit(end, &values, &mut Direction::default()).unwrap();
        case.system.solve_own(&mut after).unwrap();
        assert_eq!(before, after);
        assert_eq!(determinant, case.system.determinant());
    });
}

#[test]
fn determinants_of_antisymmetric_problems_are_the_dense_ones_up_to_a_fixed_sign() {
    for_every_antisymmetric(|case, _, dense, _, determinant, _| case.assert_determinant(dense, determinant));
    for dims in SHAPES.into_iter().filter(|d| d.left < d.components) {
        let mut random = Random(5);
        let (mut relative, mut signs) = (Vec::new(), Vec::new());
        for _ in 0..12 {
            let case = Case::new(dims, 2, 3, &mut random);
            let right = right_rows(&case, &mut random).unwrap();
            let determinant = case.system.factor_antisymmetric_rows(&mut with_rows(right.clone())).unwrap();
            let dense = dense_antisymmetric(&case, &right).determinant.sign;
            relative.push(dense * determinant.sign);
            signs.push(dense);
        }
        assert!(relative.iter().all(|s| *s == relative[0]), "{dims:?}: {relative:?}");
        assert!(signs.contains(&1.0) && signs.contains(&-1.0), "{dims:?}: a sign that never changes shows nothing");
    }
}

#[test]
fn a_singular_antisymmetric_problem_has_determinant_zero_and_a_broken_one_is_an_error() {
    let mut seen = 0;
    for_every_antisymmetric(|case, right, _, _, _, _| {
        if right.is_empty() {
            return;
        }
        let factor = |value: f64| case.system.factor_antisymmetric_rows(&mut with_rows(vec![value; right.len()]));
        assert_eq!(factor(0.0), Ok(Determinant { sign: 0.0, log_abs: f64::NEG_INFINITY }));
        let broken = factor(f64::NAN);
        assert!(matches!(broken, Err(FactorisationError::Pivot(PivotFailure { non_finite: true, .. }))), "{broken:?}");
        seen += 1;
    });
    assert!(seen > 0);
}
