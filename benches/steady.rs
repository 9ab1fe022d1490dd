//! Cost of stationary branches and of the boundary of division, in processor time of one core.
//!
//! `cargo bench --bench steady`; `cargo bench --bench steady -- branch` for the first lines alone. These follow one
//! branch on the half domain, 40 intervals of 3 Gauss points, tolerance 1e-8, R0 = 2.00, from ξ_s = 0 past the fold: with
//! steps of any length, and with the steps of `benches/baseline/auto/compare.py`, which runs AUTO-07p too; the latter also on 20
//! intervals of 4 points, with a fold as accurate as AUTO's.

use furrow_bvp::{Continuation, SymmetryBreaking, Work};
use furrow_cell::{Cell, Cue, Numerics, Parameter};
use furrow_mechanics::cortex::Cortex;
use furrow_mechanics::critical::critical_radius;
use furrow_mechanics::division::{DivisionInput, Outcome, divide};
use furrow_mechanics::equilibria::branch::error_monitor;
use furrow_mechanics::equilibria::{BranchOptions, curves, locate, pitchfork, primary};

#[path = "common/clock.rs"]
mod clock;
use clock::now;

/// The shortest processor time of several runs in ms, and the last result.
fn best<T>(runs: usize, mut work: impl FnMut() -> T) -> (f64, T) {
    let mut least = f64::INFINITY;
    let mut result = None;
    for _ in 0..runs {
        let start = now();
        result = Some(work());
        least = least.min(1e3 * (now() - start));
    }
    (least, result.expect("at least one run"))
}

/// A mesh of the half domain: intervals, and Gauss points of each.
type Mesh = [usize; 2];

/// The mesh of the comparison with AUTO.
const SAME: Mesh = [40, 3];
/// A mesh with a fold as accurate as AUTO's.
const AS_CLOSE: Mesh = [20, 4];
/// A mesh that gives ten digits of the fold.
const FINE: Mesh = [80, 5];

/// Tolerance 1e-8.
fn branch_settings(max_step: f64, [intervals, stages]: Mesh) -> (Numerics, BranchOptions) {
    let numerics = Numerics { intervals: 2 * intervals, stages, ..Numerics::default() };
    let mut options = BranchOptions::default();
    options.settings.newton.tolerance = 1e-8;
    options.settings.max_step = max_step;
    options.settings.remesh_above = 1.2;
    // As AUTO does.
    options.settings.remesh_every = 3;
    (numerics, options)
}

/// Follows the branch past its fold with the pitchfork test at every point, which takes the factors of the point itself.
fn branch(max_step: f64, mesh: Mesh) -> Continuation<Cortex> {
    let (numerics, BranchOptions { settings, .. }) = branch_settings(max_step, mesh);
    let mut watch = SymmetryBreaking::default();
    let mut branch = primary::start(&Cell::gao2026_thresholds(2.0), &numerics, &settings).expect("a passive shape");
    branch.monitor = Some(error_monitor);
    branch
        .follow([0.0, 40.0], 600, |branch, _| {
            branch.factorise_newest().expect("a regular point");
            watch.test(&branch.system, &branch.problem).expect("a determinant");
            branch.state.parameter_slope() > 0.0
        })
        .expect("the branch passes its fold");
    branch
}

fn main() {
    let short = 0.187;
    for (max_step, mesh) in [(3.0, SAME), (3.0, AS_CLOSE), (short, SAME), (short, AS_CLOSE)] {
        let (ms, branch) = best(7, || branch(max_step, mesh));
        let (points, Work { iterations, factorisations, .. }) = (branch.state.points, branch.work);
        println!(
            "symmetric branch past its fold, {} x {}: {points} points, {iterations} Newton iterations with \
             {factorisations} factorisations, {ms:.2} ms, {:.3} ms a point",
            mesh[0],
            mesh[1],
            ms / (points - 1) as f64
        );
    }
    if std::env::args().any(|argument| argument == "branch") {
        for mesh in [SAME, AS_CLOSE, FINE] {
            let (numerics, options) = branch_settings(short, mesh);
            let passive = || primary::start(&Cell::gao2026_thresholds(2.0), &numerics, &options.settings);
            println!("{} x {}: of this the passive shape from nothing: {:.2} ms", mesh[0], mesh[1], best(7, passive).0);
            let fold = locate::fold_near(&mut branch(short, mesh)).expect("a fold").point;
            let pitchfork =
                pitchfork::first(&Cell::gao2026_thresholds(2.0), &numerics, &options).expect("a pitchfork").point;
            for (kind, point) in [("fold", fold), ("pitchfork", pitchfork)] {
                println!(
                    "{} x {}: {kind} at xi_s = {:.9}, L = {:.9}, p = {:.9}",
                    mesh[0], mesh[1], point.xi_s, point.length, point.pressure
                );
            }
        }
        return;
    }
    let (cell, numerics) = (Cell::gao2026_thresholds(2.0), Numerics::default());
    let (ms, _) = best(5, || pitchfork::first(&cell, &numerics, &BranchOptions::default()));
    println!("first pitchfork from the passive shape, with normal form: {ms:.1} ms");
    let (boundary, curve) = best(5, || {
        curves::pitchfork_curve(&cell, &numerics, Parameter::R0, [1.5, 5.4]).expect("the curve of pitchforks")
    });
    let points = curve.points.len();
    println!(
        "boundary R0 1.5 to 5.4: {points} points with criticality, {boundary:.1} ms, {:.3} ms a point; 100 points {:.0} ms",
        boundary / points as f64,
        100.0 * boundary / points as f64
    );
    let cued = cell.clone().with_cue(Cue::published());
    let (ms, found) = best(3, || critical_radius(&cell, &numerics));
    println!("critical radius without cue: {ms:.1} ms ({:.8})", found.expect("a critical radius").r0);
    let (ms, found) = best(3, || critical_radius(&cued, &numerics));
    println!("critical radius with the cue: {ms:.1} ms ({:.8})", found.expect("a critical radius").r0);
    let mut sum = 0.0;
    for r0 in [2.0, 2.5, 5.4] {
        let (ms, division) = best(3, || divide(&DivisionInput::new(Cell::gao2026_thresholds(r0))).expect("a division"));
        println!("one division at R0 = {r0}: {ms:.1} ms ({:?})", division.outcome());
        sum += ms;
    }
    println!("boundary of 100 points over these three divisions: {:.2}", 100.0 * boundary / points as f64 / sum);
    // One point of the boundary by bisection on the outcome of divisions, to 1e-3 in ξ_s.
    let (ms, runs) = best(1, || {
        let (mut low, mut high, mut runs) = (20.0, 26.0, 0);
        while high - low > 1e-3 {
            let xi_s = 0.5 * (low + high);
            let cell = Cell { xi_s, ..cell.clone() };
            let division = divide(&DivisionInput::new(cell)).expect("a division");
            if division.outcome() == Outcome::Arrested {
                low = xi_s
            } else {
                high = xi_s
            }
            runs += 1;
        }
        runs
    });
    println!("one boundary point by bisection on {runs} divisions: {ms:.0} ms, to three digits only");
}
