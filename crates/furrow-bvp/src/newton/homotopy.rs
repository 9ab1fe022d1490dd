//! A root by homotopy, where damped Newton from the guess fails.
//!
//! For a guess u₀ the problems F(u) − (1 − s) F(u₀) = 0 lead from the guess at s = 0 to a solution at s = 1. They are deformed
//! as differential equations, y′ = f + (1 − s)(u₀′ − f(u₀)), so that the mesh can follow their layers from step to step.
//!
//! # References
//! Deuflhard 2004, ch. 5 (the discrete counterpart, on one mesh, is the path that damped Newton follows).

use crate::dimensions::Dimensions;
use crate::gauss::Gauss;
use crate::kernels::Kernels;
use crate::linear::System;
use crate::mesh;
use crate::problem::{
    BoundaryJacobian, BoundaryValueProblem, CollocationPoint, CollocationPoints, End, PointJacobian, conditions_at,
};
use crate::solution::Solution;

use super::iteration::{Newton, NewtonScratch};
use super::work::Work;

/// First step in s.
const FIRST_STEP: f64 = 0.1;

/// A smaller step has met a fold of the path, or a problem without solution.
const MIN_STEP: f64 = 1e-6;

/// Bound on the defect on the way.
const BOUND: f64 = 1e-4;

/// Defect meshes are made for.
const TOLERANCE: f64 = 1e-5;

/// A mesh with less imbalance is kept.
const BALANCED: f64 = 1.3;

/// An extrapolated interval is at least so wide, in its width before.
const LEAST_WIDTH: f64 = 0.2;

/// Meshes tried in one step.
const MESHES: usize = 8;

/// The corrector: a step in s that needs more than this is too long.
const CORRECTOR: Newton = Newton {
    tolerance: 1e-6,
    max_factorisations: 12,
    max_iterations: 60,
    min_damping: 0.02,
    leniency: 1.0,
    chord_contraction: 0.3,
};

/// Most factorisations of a corrector after which the step grows.
const EASY: usize = 6;

/// The problem on the way from the guess `origin`.
struct HomotopyProblem<'a> {
    problem: &'a mut dyn BoundaryValueProblem,
    origin: &'a Solution,
    gauss: Gauss,
    /// 1 − s.
    rest: f64,
    /// Points of the table, and f(u₀) − u₀′ and the integrands there.
    x: Vec<f64>,
    f: Vec<f64>,
    g: Vec<f64>,
    left: Vec<f64>,
    right: Vec<f64>,
    offsets: Vec<f64>,
}

impl<'a> HomotopyProblem<'a> {
    fn new(problem: &'a mut dyn BoundaryValueProblem, origin: &'a Solution) -> Self {
        let Dimensions { scalars: np, integrals, .. } = problem.dimensions();
        problem.prepare(&origin.scalars);
        let p = &origin.scalars[..];
        let [at_left, ..] = conditions_at(problem, End::Left, origin.node(0), p);
        let [at_right, ..] = conditions_at(problem, End::Right, origin.node(origin.intervals()), p);
        let offsets = (0..integrals).map(|k| problem.integral_offset(k, p, &mut vec![0.0; np])).collect();
        let (gauss, x, f, g) = (origin.gauss(), Vec::new(), Vec::new(), Vec::new());
        HomotopyProblem { problem, origin, gauss, rest: 1.0, x, f, g, left: at_left, right: at_right, offsets }
    }

    /// Residuals of the guess at the points x.
    fn tabulate(&mut self, x: &[f64]) {
        if self.x == x {
            return;
        }
        let Dimensions { components: n, integrals, .. } = self.problem.dimensions();
        let (mut values, mut slopes) = (vec![0.0; x.len() * n], vec![0.0; x.len() * n]);
        for ((&x, value), slope) in x.iter().zip(values.chunks_exact_mut(n)).zip(slopes.chunks_exact_mut(n)) {
            let i = self.origin.interval_of(x);
            let [from, to] = [self.origin.mesh[i], self.origin.mesh[i + 1]];
            let theta = (x - from) / (to - from);
            self.origin.eval_in(&self.gauss, i, theta, value);
            self.origin.slope_in(&self.gauss, i, theta, slope);
        }
        let HomotopyProblem { problem, origin, f, g, .. } = self;
        f.clear();
        f.resize(x.len() * n, 0.0);
        g.clear();
        g.resize(x.len() * integrals, 0.0);
        problem.prepare(&origin.scalars);
        problem.prepare_points(x, &origin.scalars);
        problem.rhs_many(CollocationPoints { first: 0, x, y: &values }, &origin.scalars, f, g);
        f.iter_mut().zip(&slopes).for_each(|(f, slope)| *f -= slope);
        self.x.clear();
        self.x.extend_from_slice(x);
    }

    /// Subtracts the remaining residual of the guess from f and the integrands at the points of the table from `first` on.
    fn subtract(&self, first: usize, f: &mut [f64], g: &mut [f64]) {
        let Dimensions { components: n, integrals, .. } = self.problem.dimensions();
        let parts = [(f, &self.f[first * n..]), (g, &self.g[first * integrals..])];
        for (to, table) in parts {
            to.iter_mut().zip(table).for_each(|(to, table)| *to -= self.rest * table);
        }
    }

    /// Defects of the deformed problem.
    fn defects(&mut self, y: &Solution) -> Vec<f64> {
        let x = mesh::samples(&self.gauss, &y.mesh);
        self.prepare_points(&x, &y.scalars);
        let gauss = self.gauss.clone();
        mesh::defect(&gauss, self, y)
    }
}

impl BoundaryValueProblem for HomotopyProblem<'_> {
    fn dimensions(&self) -> Dimensions {
        self.problem.dimensions()
    }

    fn prepare(&mut self, p: &[f64]) {
        self.problem.prepare(p);
    }

    fn prepare_points(&mut self, x: &[f64], p: &[f64]) {
        self.tabulate(x);
        self.problem.prepare(p);
        self.problem.prepare_points(x, p);
    }

    fn rhs(&self, at: CollocationPoint, y: &[f64], p: &[f64], f: &mut [f64], g: &mut [f64]) {
        self.problem.rhs(at, y, p, f, g);
        self.subtract(at.index, f, g);
    }

    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        self.problem.rhs_jacobian(at, y, p, out);
        self.subtract(at.index, out.f, out.g);
    }

    fn rhs_many(&self, points: CollocationPoints<'_>, p: &[f64], f: &mut [f64], g: &mut [f64]) {
        self.problem.rhs_many(points, p, f, g);
        self.subtract(points.first, f, g);
    }

    fn rhs_jacobian_many(&self, points: CollocationPoints<'_>, p: &[f64], out: &mut PointJacobian<'_>) {
        self.problem.rhs_jacobian_many(points, p, out);
        self.subtract(points.first, out.f, out.g);
    }

    fn left(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        self.problem.left(y, p, out);
        out.r.iter_mut().zip(&self.left).for_each(|(r, at_origin)| *r -= self.rest * at_origin);
    }

    fn right(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        self.problem.right(y, p, out);
        out.r.iter_mut().zip(&self.right).for_each(|(r, at_origin)| *r -= self.rest * at_origin);
    }

    fn integral_offset(&self, k: usize, p: &[f64], hp: &mut [f64]) -> f64 {
        self.problem.integral_offset(k, p, hp) - self.rest * self.offsets[k]
    }

    fn kernels(&self, stages: usize) -> Kernels {
        self.problem.kernels(stages)
    }
}

/// One homotopy.
struct Path<'a> {
    deformed: HomotopyProblem<'a>,
    system: &'a mut System,
    scratch: &'a mut NewtonScratch,
    work: &'a mut Work,
    max_intervals: usize,
    /// Times the corrector may still run.
    corrections: usize,
}

/// A solution of `problem` with a defect below [`BOUND`], along the path of the guess `origin`; `None` if the path does
/// not lead to one within the limits of intervals and of corrections.
pub(super) fn solve(
    problem: &mut dyn BoundaryValueProblem,
    origin: &Solution,
    [max_intervals, corrections]: [usize; 2],
    system: &mut System,
    scratch: &mut NewtonScratch,
    work: &mut Work,
) -> Option<Solution> {
    let deformed = HomotopyProblem::new(problem, origin);
    Path { deformed, system, scratch, work, max_intervals, corrections }.run(origin.clone())
}

impl Path<'_> {
    /// Steps in s, a quarter as long after a failure and twice as long where the corrector was fast.
    fn run(&mut self, mut y: Solution) -> Option<Solution> {
        let (mut s, mut step) = (0.0, FIRST_STEP);
        let mut before: Option<(f64, Solution)> = None;
        while self.corrections > 0 {
            let next = if s + step > 1.0 - 0.01 * step { 1.0 } else { s + step };
            self.deformed.rest = 1.0 - next;
            let guess = match &before {
                Some((earlier, last)) => extrapolated(&self.system.gauss, last, &y, (next - s) / (s - earlier)),
                None => y.clone(),
            };
            let found = self.corrected(guess).and_then(|(y, easy)| Some((self.resolved(y)?, easy)));
            let Some((found, easy)) = found else {
                step *= 0.25;
                if step < MIN_STEP {
                    return None;
                }
                continue;
            };
            if next == 1.0 {
                return Some(found);
            }
            before = Some((s, std::mem::replace(&mut y, found)));
            s = next;
            if easy {
                step *= 2.0;
            }
        }
        None
    }

    /// Newton, and whether it was fast.
    fn corrected(&mut self, mut y: Solution) -> Option<(Solution, bool)> {
        self.corrections = self.corrections.checked_sub(1)?;
        let report = CORRECTOR.solve(self.system, self.scratch, &mut self.deformed, &mut y, &[], false);
        let Ok(report) = report else {
            self.work.rejected += 1;
            return None;
        };
        *self.work += report;
        self.work.steps += 1;
        Some((y, report.factorisations <= EASY))
    }

    /// The solution on a mesh that resolves it.
    fn resolved(&mut self, mut y: Solution) -> Option<Solution> {
        let mut weight = Vec::new();
        for round in 0..MESHES {
            let defects = self.deformed.defects(&y);
            let largest = defects.iter().copied().fold(0.0, f64::max);
            if !largest.is_finite() {
                return None;
            }
            let intervals = y.intervals();
            let needed = mesh::intervals_for(&y.mesh, &defects, y.m, TOLERANCE).clamp(intervals / 2, 2 * intervals);
            mesh::defect_monitor(&y.mesh, &defects, y.m, &mut weight);
            if largest <= BOUND && (round > 1 || mesh::imbalance(&y.mesh, &weight) < BALANCED) {
                return Some(y);
            }
            let most = self.max_intervals.max(1);
            let grid = mesh::redistributed(&y.mesh, &defects, y.m, needed.clamp(1, most), most);
            self.work.remeshings += 1;
            y = self.corrected(y.on_mesh(&self.system.gauss, &grid))?.0;
        }
        None
    }
}

/// y + ratio (y − last), node by node, with a mesh that moves likewise: as meshes share the defect equally, a layer that moves
/// stays at the same nodes. On the mesh of y where the nodes would meet.
fn extrapolated(gauss: &Gauss, last: &Solution, y: &Solution, ratio: f64) -> Solution {
    let moved = |mesh: &[f64], from: &[f64]| -> Vec<f64> {
        mesh.iter().zip(from).map(|(x, from)| x + ratio * (x - from)).collect()
    };
    let mut from = with_intervals(&last.mesh, y.intervals());
    let mut grid = moved(&y.mesh, &from);
    let least = |x: &[f64], h: &[f64]| x[1] - x[0] > LEAST_WIDTH * (h[1] - h[0]);
    if !grid.windows(2).zip(y.mesh.windows(2)).all(|(x, h)| least(x, h)) {
        from.clone_from(&y.mesh);
        grid.clone_from(&y.mesh);
    }
    let last = last.on_mesh(gauss, &from);
    let mut out = y.clone();
    let parts = [(&mut out.nodes, &last.nodes), (&mut out.stages, &last.stages), (&mut out.scalars, &last.scalars)];
    for (to, from) in parts {
        to.iter_mut().zip(from).for_each(|(to, from)| *to += ratio * (*to - from));
    }
    out.mesh = grid;
    out
}

/// The mesh as a function of the running number of its nodes, with another number of intervals.
fn with_intervals(mesh: &[f64], intervals: usize) -> Vec<f64> {
    let count = mesh.len() - 1;
    let at = |k: usize| {
        let place = (k * count) as f64 / intervals as f64;
        let i = (k * count / intervals).min(count - 1);
        let theta = place - i as f64;
        if theta >= 1.0 { mesh[i + 1] } else { mesh[i] + theta * (mesh[i + 1] - mesh[i]) }
    };
    (0..=intervals).map(at).collect()
}
