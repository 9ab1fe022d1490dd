//! Residuals, solves and determinants of the condensed bordered system against the dense one.

use super::Random;
use super::dense::{Factorised, equations, jacobian, residual, unknowns_of_direction};
use super::distance;
use super::problems::{Quadratic, factored, random_conditions, random_solution};
use crate::dense::Determinant;
use crate::gauss::MAX_STAGES;
use crate::{Dimensions, Gauss, Solution, System};
use crate::{Direction, LinearCondition, Residual};

/// Sizes with and without each kind of unknown and condition, up to two linear conditions, more conditions at one end
/// than components, no conditions at one end, all components quadratures, quadratures behind the other components, and sizes beyond one lane.
pub const SHAPES: [Dimensions; 21] = [
    dims(1, 0, 0, 1, 0, 0),
    dims(1, 0, 0, 0, 1, 0),
    dims(2, 0, 0, 1, 1, 0),
    dims(2, 1, 1, 0, 2, 1),
    dims(2, 1, 1, 3, 0, 0),
    dims(2, 0, 1, 0, 3, 0),
    dims(3, 1, 1, 2, 1, 0),
    dims(4, 2, 2, 2, 2, 1),
    dims(5, 0, 3, 2, 3, 1),
    dims(4, 1, 3, 2, 1, 3),
    dims(5, 4, 1, 3, 2, 1),
    dims(6, 2, 0, 3, 1, 1),
    dims(7, 3, 2, 4, 4, 1),
    dims(7, 3, 3, 4, 4, 1),
    dims(9, 4, 2, 5, 4, 1),
    dims(1, 1, 1, 2, 0, 0),
    dims(2, 2, 2, 2, 1, 1),
    dims(3, 3, 0, 1, 2, 0),
    Dimensions { trailing_quadratures: 1, ..dims(9, 3, 2, 5, 5, 1) },
    Dimensions { trailing_quadratures: 2, ..dims(4, 0, 1, 2, 2, 0) },
    Dimensions { trailing_quadratures: 3, ..dims(7, 3, 0, 4, 3, 0) },
];

pub const fn dims(
    components: usize,
    quadratures: usize,
    scalars: usize,
    left: usize,
    right: usize,
    integrals: usize,
) -> Dimensions {
    Dimensions { components, quadratures, trailing_quadratures: 0, scalars, left, right, integrals }
}

/// A random problem at random values, with the factors of both kinds.
pub struct Case {
    pub problem: Quadratic,
    pub y: Solution,
    pub conditions: Vec<LinearCondition>,
    pub system: System,
    pub dense: Factorised,
}

impl Case {
    pub fn new(dims: Dimensions, m: usize, intervals: usize, random: &mut Random) -> Case {
        let mut problem = Quadratic::new(dims, random);
        let mesh = random.mesh(intervals);
        let y = random_solution(dims, m, mesh, random);
        let conditions = random_conditions(dims, intervals, random);
        let system = factored(&mut problem, &y, &conditions);
        let dense = jacobian(&problem, &y, &conditions).factor();
        Case { problem, y, conditions, system, dense }
    }

    /// ln of the factor by which the dense determinant exceeds the condensed one: eliminating the e quadrature
    /// components divides by the determinant of their stage equations, D for each of them on every interval.
    pub fn eliminated(&self) -> f64 {
        let gauss = Gauss::new(self.y.m).unwrap();
        let stage = super::dense::Matrix { n: gauss.m, a: gauss.d_matrix }.factor();
        (self.y.intervals() * self.problem.dims.all_quadratures()) as f64 * stage.determinant.log_abs
    }

    /// Asserts that ln|det| equals a dense matrix's, without the quadrature components.
    pub fn assert_determinant(&self, dense: &Factorised, condensed: Determinant) {
        let difference = dense.determinant.log_abs - condensed.log_abs - self.eliminated();
        assert!(difference.abs() <= dense.determinant_tolerance(), "{:?}: {difference:.1e}", self.problem.dims);
    }
}

/// A residual of the same shape with random entries.
pub fn random_residual(like: &Residual, random: &mut Random) -> Residual {
    let mut entries = |v: &Vec<f64>| random.vector(v.len());
    Residual {
        stages: entries(&like.stages),
        nodes: entries(&like.nodes),
        left: entries(&like.left),
        right: entries(&like.right),
        border: entries(&like.border),
    }
}

fn negated(v: Vec<f64>) -> Vec<f64> {
    v.into_iter().map(|v| -v).collect()
}

/// Every shape with every number of stages and meshes of one to four intervals.
pub fn for_every_shape(mut test: impl FnMut(Case, &mut Random)) {
    for (s, dims) in SHAPES.into_iter().enumerate() {
        for m in 1..=MAX_STAGES {
            let mut random = Random((100 * s + m) as u64);
            let intervals = 1 + (s + m) % 4;
            test(Case::new(dims, m, intervals, &mut random), &mut random);
        }
    }
}

#[test]
fn residuals_are_those_of_the_definition() {
    for_every_shape(|mut case, _| {
        let exact = residual(&case.problem, &case.y, &case.conditions);
        // Sums of at most 64 terms below 100 (entries of D are the largest factors), in any order.
        let allowed = 64.0 * 100.0 * f64::EPSILON;
        let with_derivatives = equations(&case.system.residual);
        assert!(distance(&with_derivatives, &exact) < allowed);
        case.system.evaluate(&mut case.problem, &case.y, &case.conditions, false).unwrap();
        assert_eq!(equations(&case.system.residual), with_derivatives, "derivatives do not change residuals");
    });
}

#[test]
fn solves_the_dense_system_for_its_own_and_for_any_residual() {
    for_every_shape(|mut case, random| {
        let mut update = Direction::default();
        let own = negated(equations(&case.system.residual));
        case.system.solve_own(&mut update).unwrap();
        case.dense.assert_solves(&unknowns_of_direction(&update), &own, "own residual");
        // A residual of all kinds at once would hide a sign that is wrong for a kind that happens to be small.
        let all = random_residual(&case.system.residual, random);
        let zero = case.system.zero_residual();
        let residuals = [
            Residual { stages: all.stages.clone(), ..zero.clone() },
            Residual { nodes: all.nodes.clone(), ..zero.clone() },
            Residual { left: all.left.clone(), ..zero.clone() },
            Residual { right: all.right.clone(), ..zero.clone() },
            Residual { border: all.border.clone(), ..zero },
            all,
        ];
        for residual in residuals {
            let b = negated(equations(&residual));
            if b.iter().any(|v| *v != 0.0) {
                case.system.solve(&residual, &mut update).unwrap();
                case.dense.assert_solves(&unknowns_of_direction(&update), &b, "any residual");
            }
        }
    });
}

#[test]
fn unit_right_hand_sides_of_the_border_are_solved_for() {
    for_every_shape(|mut case, _| {
        let border = case.system.residual.border.len();
        let rows = equations(&case.system.residual).len();
        // The workspace is left dirty on purpose: a unit solve must not see the residual solved for before it.
        let mut update = Direction::default();
        case.system.solve_own(&mut update).unwrap();
        for which in 0..border {
            let mut b = vec![0.0; rows];
            b[rows - border + which] = 1.0;
            case.system.solve_unit(which, &mut update).unwrap();
            case.dense.assert_solves(&unknowns_of_direction(&update), &b, "unit");
        }
    });
}

#[test]
fn determinants_are_those_of_the_dense_matrix_up_to_a_fixed_sign() {
    for dims in SHAPES {
        let (m, intervals) = (3, 2);
        let mut random = Random(7);
        let mut relative = Vec::new();
        let mut dense = Vec::new();
        for _ in 0..12 {
            let case = Case::new(dims, m, intervals, &mut random);
            let condensed = case.system.determinant();
            case.assert_determinant(&case.dense, condensed);
            relative.push(case.dense.determinant.sign * condensed.sign);
            dense.push(case.dense.determinant.sign);
        }
        assert!(relative.iter().all(|s| *s == relative[0]), "{dims:?}: {relative:?}");
        assert!(dense.contains(&1.0) && dense.contains(&-1.0), "{dims:?}: a sign that never changes shows nothing");
    }
}

#[test]
fn a_workspace_that_has_seen_a_larger_mesh_gives_the_same_bits() {
    for dims in SHAPES {
        let mut random = Random(11);
        let mut large = Case::new(dims, 4, 5, &mut random);
        large.system.solve_own(&mut Direction::default()).unwrap();
        let mut small = Case::new(dims, 4, 2, &mut random);
        let (mut fresh, mut reused) = (Direction::default(), Direction::default());
        small.system.solve_own(&mut fresh).unwrap();
        large.system.factorise(&mut small.problem, &small.y, &small.conditions).unwrap();
        large.system.solve_own(&mut reused).unwrap();
        assert_eq!(fresh, reused, "{dims:?}");
        assert_eq!(small.system.determinant(), large.system.determinant(), "{dims:?}");
    }
}
