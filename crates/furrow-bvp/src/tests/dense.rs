//! The collocation equations written out plainly, and dense linear algebra to compare the kernels with.
//!
//! Unknowns are ordered nodes, stages, scalars; equations stages, nodes, left, right, border.

use nalgebra::{DMatrix, DVector, Dyn, LU};

use crate::dense::Determinant;
use crate::problem::{End, conditions_at};
use crate::{BoundaryValueProblem, CollocationPoint, Direction, Gauss, LinearCondition, Residual, Solution};

use super::largest;

/// A square matrix, row-major.
pub struct Matrix {
    pub n: usize,
    pub a: Vec<f64>,
}

/// The factors of a matrix, with its condition number.
pub struct Factorised {
    lu: LU<f64, Dyn, Dyn>,
    pub determinant: Determinant,
    /// ‖A‖ ‖A⁻¹‖ in the maximum norm.
    pub condition: f64,
}

impl Matrix {
    /// By row pivoting.
    pub fn factor(self) -> Factorised {
        let matrix = DMatrix::from_row_slice(self.n, self.n, &self.a);
        let norm = |m: &DMatrix<f64>| m.row_iter().map(|row| row.lp_norm(1)).fold(0.0, f64::max);
        let size = norm(&matrix);
        let lu = matrix.lu();
        let mut determinant = Determinant { sign: lu.p().determinant(), ..Determinant::default() };
        for pivot in lu.u().diagonal().iter() {
            determinant.sign *= pivot.signum();
            determinant.log_abs += pivot.abs().ln();
        }
        let condition = size * norm(&lu.try_inverse().unwrap());
        Factorised { determinant, condition, lu }
    }
}

impl Factorised {
    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        self.lu.solve(&DVector::from_column_slice(b)).unwrap().as_slice().to_vec()
    }

    /// Relative error allowed to a solution: the backward errors of two eliminations, 3 n ε for one (Higham 2002,
    /// theorem 9.4, with growth that row pivoting keeps small), amplified by the condition number. A tolerance that
    /// would hide errors is refused.
    pub fn tolerance(&self) -> f64 {
        let tolerance = 6.0 * self.n() * f64::EPSILON * self.condition;
        assert!(tolerance < 1e-5, "a problem of condition {:.1e} tests nothing", self.condition);
        tolerance
    }

    /// Error allowed to ln|det|: its change with the matrix is tr(A⁻¹ δA), at most n ‖A⁻¹‖ ‖δA‖.
    pub fn determinant_tolerance(&self) -> f64 {
        self.n() * self.tolerance()
    }

    fn n(&self) -> f64 {
        self.lu.u().nrows() as f64
    }

    /// Asserts that `x` solves A x = b.
    pub fn assert_solves(&self, x: &[f64], b: &[f64], what: &str) {
        let exact = self.solve(b);
        let (error, allowed) = (super::distance(x, &exact), self.tolerance() * largest(&exact));
        assert!(largest(&exact) > 0.0, "{what}: nothing to solve");
        assert!(error <= allowed, "{what}: {error:.1e} > {allowed:.1e}");
    }
}

/// All unknowns of a solution.
pub fn unknowns(y: &Solution) -> Vec<f64> {
    [&y.nodes[..], &y.stages, &y.scalars].concat()
}

/// All unknowns of an update.
pub fn unknowns_of_direction(y: &Direction) -> Vec<f64> {
    [&y.nodes[..], &y.stages, &y.scalars].concat()
}

/// All equations.
pub fn equations(r: &Residual) -> Vec<f64> {
    [&r.stages[..], &r.nodes, &r.left, &r.right, &r.border].concat()
}

/// The collocation equations of `problem` at `y`, straight from their definition.
pub fn residual<P: BoundaryValueProblem>(problem: &P, y: &Solution, conditions: &[LinearCondition]) -> Vec<f64> {
    let (gauss, dims, n) = (Gauss::new(y.m).unwrap(), problem.dimensions(), y.components);
    let (np, p) = (dims.scalars, &y.scalars);
    let (mut stages, mut nodes) = (Vec::new(), Vec::new());
    let mut border: Vec<f64> = (0..dims.integrals).map(|k| problem.integral_offset(k, p, &mut vec![0.0; np])).collect();
    for i in 0..y.intervals() {
        let h = y.mesh[i + 1] - y.mesh[i];
        let y0 = y.node(i);
        for j in 0..y.m {
            let (mut f, mut g) = (vec![0.0; n], vec![0.0; dims.integrals]);
            let at = CollocationPoint { x: y.stage_x(&gauss, i, j), index: i * y.m + j };
            problem.rhs(at, y.stage(i, j), p, &mut f, &mut g);
            for c in 0..n {
                let slope: f64 = (0..y.m).map(|k| gauss.d_matrix[j * y.m + k] * (y.stage(i, k)[c] - y0[c])).sum();
                stages.push(slope - h * f[c]);
            }
            (0..dims.integrals).for_each(|k| border[k] += h * gauss.b[j] * g[k]);
        }
        for c in 0..n {
            let end: f64 = (0..y.m).map(|j| gauss.d[j] * (y.stage(i, j)[c] - y0[c])).sum();
            nodes.push(y0[c] + end - y.node(i + 1)[c]);
        }
    }
    let [left, ..] = conditions_at(problem, End::Left, y.node(0), p);
    let [right, ..] = conditions_at(problem, End::Right, y.node(y.intervals()), p);
    for condition in conditions {
        let products = condition.nodes.iter().zip(&y.nodes).chain(condition.scalars.iter().zip(p));
        border.push(products.map(|(w, v)| w * v).sum::<f64>() - condition.value);
    }
    [stages, nodes, left, right, border].concat()
}

/// The Jacobian of the collocation equations by central differences. For equations quadratic in the unknowns these are
/// exact for every step, and a step of one divides without rounding.
pub fn jacobian<P: BoundaryValueProblem>(problem: &P, y: &Solution, conditions: &[LinearCondition]) -> Matrix {
    let n = unknowns(y).len();
    let moved = |k: usize, by: f64| {
        let mut y = y.clone();
        let (nodes, stages) = (y.nodes.len(), y.stages.len());
        match k {
            k if k < nodes => y.nodes[k] += by,
            k if k < nodes + stages => y.stages[k - nodes] += by,
            k => y.scalars[k - nodes - stages] += by,
        }
        residual(problem, &y, conditions)
    };
    let mut a = vec![0.0; n * n];
    for k in 0..n {
        let (up, down) = (moved(k, 1.0), moved(k, -1.0));
        assert_eq!(up.len(), n, "as many equations as unknowns");
        (0..n).for_each(|row| a[row * n + k] = 0.5 * (up[row] - down[row]));
    }
    Matrix { n, a }
}
