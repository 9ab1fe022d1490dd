//! Problems with conditions that may involve both ends.

#[cfg(feature = "auto")]
mod closures;

#[cfg(feature = "auto")]
pub use closures::solve_bvp;

use crate::deflation::{Deflation, DeflationError};
use crate::dimensions::{Dimensions, MAX_STAGE_UNKNOWNS};
use crate::gauss::Gauss;
use crate::invalid::{self, InvalidInput};
use crate::newton::{Settings, SolveError, Solved, solve};
use crate::problem::{BoundaryJacobian, BoundaryValueProblem, CollocationPoint, CollocationPoints, PointJacobian};
use crate::solution::Solution;

/// Conditions at both ends and their derivatives; row-major, zeroed before each call.
#[derive(Debug)]
pub struct TwoPointJacobian<'a> {
    /// Residuals.
    pub r: &'a mut [f64],
    /// ∂r/∂y(a); conditions × n.
    pub by_left: &'a mut [f64],
    /// ∂r/∂y(b); conditions × n.
    pub by_right: &'a mut [f64],
    /// ∂r/∂p; conditions × scalars.
    pub by_p: &'a mut [f64],
}

/// y′ = f(x, y, p) on \[a, b\] with as many conditions r(y(a), y(b), p) = 0 as there are components and scalar unknowns.
pub trait TwoPoint {
    /// Components of y, and scalar unknowns p.
    fn sizes(&self) -> [usize; 2];

    /// f at many points; points × n.
    fn rhs(&self, points: CollocationPoints<'_>, p: &[f64], f: &mut [f64]);

    /// f and its derivatives at many points.
    fn rhs_jacobian(&self, points: CollocationPoints<'_>, p: &[f64], out: &mut PointJacobian<'_>);

    /// r and its derivatives for y(a) and y(b).
    fn conditions(&self, ends: [&[f64]; 2], p: &[f64], out: TwoPointJacobian<'_>);
}

/// The conditions that a problem has at each end, once it is stated with separated ones.
#[derive(Clone, Debug, PartialEq)]
enum Separation {
    /// Every condition involves one end: the rows at the left end and at the right end.
    Separated([Vec<usize>; 2]),
    /// A copy c = y(a) among the scalar unknowns takes the values of the left end to the right one.
    Copied,
}

struct Separated<'a, T> {
    problem: &'a T,
    separation: Separation,
    /// Values at the ends of the guess: conditions at one end are computed with those at the other.
    ends: [Vec<f64>; 2],
}

/// All derivatives of the conditions.
struct Conditions {
    r: Vec<f64>,
    by_left: Vec<f64>,
    by_right: Vec<f64>,
    by_p: Vec<f64>,
}

impl Conditions {
    fn of<T: TwoPoint>(problem: &T, ends: [&[f64]; 2], p: &[f64]) -> Conditions {
        let [n, np] = problem.sizes();
        let zeros = |columns: usize| vec![0.0; (n + np) * columns];
        let mut all = Conditions { r: zeros(1), by_left: zeros(n), by_right: zeros(n), by_p: zeros(np) };
        let Conditions { r, by_left, by_right, by_p } = &mut all;
        problem.conditions(ends, p, TwoPointJacobian { r, by_left, by_right, by_p });
        all
    }
}

impl Separation {
    /// By the conditions that depend on either end near a guess. A derivative that is no number counts as dependence.
    fn of<T: TwoPoint>(problem: &T, guess: &Solution) -> Separation {
        let [n, np] = problem.sizes();
        // A product of both ends does not depend on either where the other is 0.
        let near = |y: &[f64], k: usize| -> Vec<f64> {
            y.iter().enumerate().map(|(c, y)| y + 0.01 * (1.0 + y.abs()) * (1.7 * (c + k) as f64 + 0.9).sin()).collect()
        };
        let ends = [guess.node(0), guess.node(guess.intervals())];
        let at =
            |k: usize| Conditions::of(problem, ends.map(|y| near(y, k)).each_ref().map(|y| &y[..]), &guess.scalars);
        let tried = [at(1), at(5)];
        let depends = |row: usize, part: fn(&Conditions) -> &Vec<f64>| {
            tried.iter().any(|all| part(all)[row * n..(row + 1) * n].iter().any(|d| *d != 0.0))
        };
        let (mut left, mut right) = (Vec::new(), Vec::new());
        for row in 0..n + np {
            match (depends(row, |all| &all.by_left), depends(row, |all| &all.by_right)) {
                (true, true) => return Separation::Copied,
                (true, false) => left.push(row),
                (false, _) => right.push(row),
            }
        }
        Separation::Separated([left, right])
    }
}

impl Separation {
    /// A solution with the scalar unknowns of the separated problem.
    fn stated(&self, y: &Solution) -> Solution {
        let mut stated = y.clone();
        if *self == Separation::Copied {
            stated.scalars.extend(y.nodes.iter().take(y.components));
        }
        stated
    }
}

impl<'a, T: TwoPoint> Separated<'a, T> {
    fn new(problem: &'a T, guess: &Solution) -> Separated<'a, T> {
        let ends = [guess.node(0), guess.node(guess.intervals())].map(<[f64]>::to_vec);
        Separated { problem, separation: Separation::of(problem, guess), ends }
    }

    /// A solution from a guess, in which all conditions hold to a tolerance.
    fn solve<E>(
        mut self,
        guess: &Solution,
        tolerance: f64,
        solve: impl Fn(&mut Self, &Solution) -> Result<Solved, E>,
    ) -> Result<Solved, E> {
        let stated = self.separation.stated(guess);
        let mut solved = solve(&mut self, &stated)?;
        if self.separation != Separation::Copied && !self.holds(&solved.solution, tolerance) {
            self.separation = Separation::Copied;
            let stated = self.separation.stated(guess);
            solved = solve(&mut self, &stated)?;
        }
        solved.solution.scalars.truncate(guess.scalars.len());
        Ok(solved)
    }

    /// Whether all conditions hold at the ends of a solution. A condition that depends on an end only far from the guess, or by a tiny
    /// coefficient, has been taken for one at the other end, and then does not.
    fn holds(&self, y: &Solution, tolerance: f64) -> bool {
        let ([n, np], p) = (self.problem.sizes(), &y.scalars);
        let ends = [y.node(0), y.node(y.intervals())];
        let all = Conditions::of(self.problem, ends, &p[..np]);
        let size = |derivatives: &[f64], values: &[f64]| -> f64 {
            derivatives.iter().zip(values).map(|(d, value)| (d * value).abs()).sum()
        };
        (0..n + np).all(|row| {
            let parts = size(&all.by_left[row * n..], ends[0])
                + size(&all.by_right[row * n..], ends[1])
                + size(&all.by_p[row * np..], &p[..np]);
            all.r[row].abs() <= tolerance.max(HELD) * (1.0 + parts)
        })
    }

    /// Writes the conditions at one end and their derivatives by y and p.
    fn at_end(&self, end: usize, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        let [n, np] = self.problem.sizes();
        let columns = out.rp.len() / out.r.len().max(1);
        match &self.separation {
            Separation::Separated(rows) => {
                // The other end does not matter to these rows, but the function may not be defined everywhere.
                let [left, right] = &self.ends;
                let ends = if end == 0 { [y, right] } else { [left, y] };
                let all = Conditions::of(self.problem, ends, p);
                let by_y = if end == 0 { &all.by_left } else { &all.by_right };
                for (k, &row) in rows[end].iter().enumerate() {
                    out.r[k] = all.r[row];
                    out.ry[k * n..(k + 1) * n].copy_from_slice(&by_y[row * n..(row + 1) * n]);
                    out.rp[k * np..(k + 1) * np].copy_from_slice(&all.by_p[row * np..(row + 1) * np]);
                }
            }
            Separation::Copied if end == 0 => {
                for k in 0..n {
                    out.r[k] = y[k] - p[np + k];
                    out.ry[k * n + k] = 1.0;
                    out.rp[k * columns + np + k] = -1.0;
                }
            }
            Separation::Copied => {
                let all = Conditions::of(self.problem, [&p[np..], y], &p[..np]);
                out.r.copy_from_slice(&all.r);
                out.ry.copy_from_slice(&all.by_right);
                for (row, to) in out.rp.chunks_exact_mut(columns).enumerate() {
                    to[..np].copy_from_slice(&all.by_p[row * np..(row + 1) * np]);
                    to[np..].copy_from_slice(&all.by_left[row * n..(row + 1) * n]);
                }
            }
        }
    }
}

impl<T: TwoPoint> BoundaryValueProblem for Separated<'_, T> {
    fn dimensions(&self) -> Dimensions {
        let [components, own] = self.problem.sizes();
        let (scalars, [left, right]) = match &self.separation {
            Separation::Separated(rows) => (own, rows.each_ref().map(Vec::len)),
            Separation::Copied => (own + components, [components, components + own]),
        };
        Dimensions { components, scalars, left, right, ..Dimensions::default() }
    }

    fn rhs(&self, at: CollocationPoint, y: &[f64], p: &[f64], f: &mut [f64], g: &mut [f64]) {
        self.rhs_many(CollocationPoints { first: at.index, x: &[at.x], y }, p, f, g);
    }

    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        self.rhs_jacobian_many(CollocationPoints { first: at.index, x: &[at.x], y }, p, out);
    }

    fn rhs_many(&self, points: CollocationPoints<'_>, p: &[f64], f: &mut [f64], _: &mut [f64]) {
        self.problem.rhs(points, &p[..self.problem.sizes()[1]], f);
    }

    fn rhs_jacobian_many(&self, points: CollocationPoints<'_>, p: &[f64], out: &mut PointJacobian<'_>) {
        let [n, np] = self.problem.sizes();
        let columns = self.dimensions().scalars;
        let mut fp = vec![0.0; points.x.len() * n * np];
        let PointJacobian { f, fy, g, gy, gp, .. } = out;
        let mut own = PointJacobian { f, fy, fp: &mut fp, g, gy, gp };
        self.problem.rhs_jacobian(points, &p[..np], &mut own);
        if np > 0 {
            for (to, from) in out.fp.chunks_exact_mut(columns).zip(fp.chunks_exact(np)) {
                to[..np].copy_from_slice(from);
            }
        }
    }

    fn left(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        self.at_end(0, y, p, out);
    }

    fn right(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        self.at_end(1, y, p, out);
    }
}

/// Solves a two-point problem from a guess on a mesh: a row of values at its nodes for every component, and p. Conditions that involve
/// both ends cost a scalar unknown for every component.
///
/// # Errors
/// [`SolveError`]; [`InvalidInput`] if the guess does not fit the mesh.
pub fn solve_two_point<T: TwoPoint>(
    problem: &T,
    mesh: &[f64],
    guess: &[&[f64]],
    p: &[f64],
    settings: &Settings,
) -> Result<Solved, SolveError> {
    let guess = guess_on_mesh(problem, mesh, guess, p)?;
    Separated::new(problem, &guess)
        .solve(&guess, settings.tolerance, |separated, guess| solve(separated, guess, settings))
}

/// [`solve_two_point`] for a solution besides the known ones, which are results of these functions. The norm of distances has all
/// weights 1; a metric in `deflation` is not used.
///
/// # Errors
/// [`DeflationError`].
pub fn solve_two_point_besides<T: TwoPoint>(
    problem: &T,
    mesh: &[f64],
    guess: &[&[f64]],
    p: &[f64],
    known: &[&Solution],
    deflation: &Deflation,
) -> Result<Solved, DeflationError> {
    let guess = guess_on_mesh(problem, mesh, guess, p)?;
    let deflation = Deflation { metric: None, ..deflation.clone() };
    Separated::new(problem, &guess).solve(&guess, deflation.settings.tolerance, |separated, guess| {
        let known: Vec<Solution> = known.iter().map(|y| separated.separation.stated(y)).collect();
        deflation.solve(separated, guess, &known)
    })
}

/// The guess of a problem, linear between its values.
fn guess_on_mesh<T: TwoPoint>(
    problem: &T,
    mesh: &[f64],
    guess: &[&[f64]],
    p: &[f64],
) -> Result<Solution, InvalidInput> {
    let [n, np] = problem.sizes();
    invalid::mesh(mesh)?;
    let rows = guess.iter().map(|row| ("values in a row of the guess", row.len(), mesh.len()));
    let counts = [("rows of the guess", guess.len(), n), ("scalar unknowns", p.len(), np)].into_iter().chain(rows);
    for (name, length, expected) in counts {
        if length != expected {
            return Err(InvalidInput::Length { name, length, expected });
        }
    }
    let gauss = Gauss::new((MAX_STAGE_UNKNOWNS / n.max(1)).clamp(1, STAGES))?;
    Solution::from_fn(&gauss, mesh, n, p, |x, y| {
        let i = mesh.partition_point(|node| *node <= x).clamp(1, mesh.len() - 1);
        let share = (x - mesh[i - 1]) / (mesh[i] - mesh[i - 1]);
        for (y, row) in y.iter_mut().zip(guess) {
            *y = row[i - 1] + share * (row[i] - row[i - 1]);
        }
    })
}

/// Conditions that hold do so to this share of their terms, or to the tolerance.
const HELD: f64 = 1e-6;

/// Stages of the collocation, of fewer components than 17.
const STAGES: usize = 4;
