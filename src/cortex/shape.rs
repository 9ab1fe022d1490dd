//! Shapes as solutions: the ellipsoidal first guess, the passive shape, mirroring, and the mesh monitor.

use std::f64::consts::PI;

use super::cue::Cue;
use super::equations::{COMPONENTS, Cortex, Domain, M, PSI, Q, R, T, V, Z};
use super::parameters::{Numerics, Physics};
use crate::numerics::newton::{Newton, NewtonError, NewtonReport, NewtonScratch};
use crate::numerics::{Gauss, Solution, System, mesh};

/// A prolate spheroid of the cell's volume that fits the shell: between a sphere (loose shell) and the shell's own shape
/// scaled to the cell's volume (tight shell), sampled on `mesh`; (L, p) are its contour length and 0.
pub fn spheroid(gauss: &Gauss, physics: &Physics, r0: f64, mesh: &[f64]) -> Solution {
    // Pressed shapes follow the shell; at small ε the sphere fits with room to spare.
    let weight = ((physics.epsilon - 0.3) / 0.4).clamp(0.0, 1.0);
    let aspect = physics.aspect.powf(weight);
    let b = r0 / aspect.cbrt();
    let a = aspect * b;
    // Arclength as a function of the parametric angle, by Gauss quadrature on fine pieces.
    let pieces = 400;
    let speed = |t: f64| ((b * t.cos()).powi(2) + (a * t.sin()).powi(2)).sqrt();
    let (c, w) = crate::numerics::gauss::gauss_rule(4);
    let step = PI / pieces as f64;
    let mut arc = vec![0.0];
    for k in 0..pieces {
        let part: f64 = c.iter().zip(&w).map(|(c, w)| w * speed((k as f64 + c) * step)).sum();
        arc.push(arc[k] + part * step);
    }
    let length = arc[pieces];
    let angle_at = |s: f64| {
        let k = arc.partition_point(|&x| x <= s).clamp(1, pieces) - 1;
        let mut t = (k as f64 + (s - arc[k]) / (arc[k + 1] - arc[k])) * step;
        // The table is fine enough for one correction along the local speed.
        let from = k as f64 * step;
        let part: f64 = c.iter().zip(&w).map(|(c, w)| w * speed(from + c * (t - from))).sum::<f64>() * (t - from);
        t -= (arc[k] + part - s) / speed(t);
        t
    };
    let kappa = physics.kappa;
    let mean = |t: f64| {
        let g = speed(t);
        a * b / g.powi(3) + a / (b * g)
    };
    Solution::from_fn(gauss, mesh, COMPONENTS, &[length, 0.0], |u, y| {
        let t = angle_at(u * length);
        y[R] = b * t.sin();
        y[Z] = a * t.cos();
        y[PSI] = (a * t.sin()).atan2(b * t.cos());
        y[M] = kappa * mean(t);
        let dt = 1e-4;
        y[Q] = kappa * (mean(t + dt) - mean(t - dt)) / (2.0 * dt * speed(t));
        y[V] = 0.0;
        y[T] = 0.0;
    })
}

/// Collects (r, z) at the collocation points of a solution.
pub fn positions(y: &Solution, out: &mut Vec<[f64; 2]>) {
    out.clear();
    out.extend(y.stages.chunks_exact(COMPONENTS).map(|s| [s[R], s[Z]]));
}

/// A stationary shape together with the work it took.
pub type Stationary = (Solution, NewtonReport);

/// The passive (ξ = 0) shape without cue on the mirror-symmetric half domain, R0 > 0 and ε ∈ [0.3, 0.95].
///
/// Newton from a spheroid; where that fails, implicit steps of growing size lead to the shape, which without activity is
/// an attractor.
///
/// # Errors
/// What Newton said last.
pub fn passive(physics: &Physics, numerics: &Numerics, r0: f64) -> Result<Stationary, NewtonError> {
    let passive = Physics { xi_s: 0.0, ..*physics };
    let mut cortex = Cortex::new(&passive, r0, &Cue::None, Domain::Half, &[]);
    let mut system = System::new(Cortex::dimensions_for(0), numerics.stages);
    let mut scratch = NewtonScratch::default();
    let newton = Newton { tolerance: 1e-11, ..Newton::default() };
    let gauss = system.gauss.clone();
    let grid = mesh::uniform(0.0, 0.5, (numerics.intervals / 2).max(2));
    let guess = spheroid(&gauss, physics, r0, &grid);
    let mut y = guess.clone();
    match newton.solve(&mut system, &mut scratch, &mut cortex, &mut y, &[], false) {
        Ok(report) if is_convex_half(&y) => return Ok((y, report)),
        _ => y = guess,
    }
    let mut total = NewtonReport::default();
    let (mut dt, mut last) = (1e-3 * r0 * r0, NewtonError::NonFinite { iterations: 0 });
    for _ in 0..200 {
        positions(&y, &mut cortex.past);
        cortex.rate = 1.0 / dt;
        let before = y.clone();
        match newton.solve(&mut system, &mut scratch, &mut cortex, &mut y, &[], false) {
            Ok(report) if is_convex_half(&y) => {
                total.iterations += report.iterations;
                total.factorisations += report.factorisations;
                dt *= 3.0;
                if dt > 1e8 * r0 * r0 {
                    break;
                }
            }
            other => {
                if let Err(error) = other {
                    last = error;
                }
                y = before;
                dt *= 0.2;
                if dt < 1e-12 {
                    return Err(last);
                }
            }
        }
    }
    cortex.rate = 0.0;
    let report = newton.solve(&mut system, &mut scratch, &mut cortex, &mut y, &[], false)?;
    total.iterations += report.iterations;
    total.factorisations += report.factorisations;
    Ok((y, total))
}

/// A half contour that rises monotonically to the equator with positive radius, as every passive shape does.
fn is_convex_half(y: &Solution) -> bool {
    y.scalars[0] > 0.0
        && y.stages
            .chunks_exact(COMPONENTS)
            .all(|s| s[R] > 0.0 && s[Z] > -1e-6 && s[PSI] > -0.5 && s[PSI] < 0.5 * PI + 0.5)
}

/// The full contour of a mirror-symmetric half: r, m, T even, z, q, v odd about u = ½ and ψ → π − ψ.
pub fn unfold(gauss: &Gauss, half: &Solution) -> Solution {
    let n = half.intervals();
    let mut grid = half.mesh.clone();
    for i in (0..n).rev() {
        grid.push(1.0 - half.mesh[i]);
    }
    let mut mirrored = [0.0; COMPONENTS];
    let mut full = Solution {
        components: COMPONENTS,
        m: half.m,
        mesh: grid,
        nodes: half.nodes.clone(),
        stages: half.stages.clone(),
        scalars: half.scalars.clone(),
    };
    for i in (0..n).rev() {
        mirror(half.node(i), &mut mirrored);
        full.nodes.extend_from_slice(&mirrored);
        for j in (0..half.m).rev() {
            mirror(half.stage(i, j), &mut mirrored);
            full.stages.extend_from_slice(&mirrored);
        }
    }
    debug_assert_eq!(gauss.m, half.m);
    full
}

/// The state at 1 − u of the mirrored shape.
pub fn mirror(y: &[f64], out: &mut [f64]) {
    out.copy_from_slice(y);
    out[Z] = -y[Z];
    out[Q] = -y[Q];
    out[V] = -y[V];
    out[PSI] = PI - y[PSI];
}

/// Part of its mean that the mesh monitor never falls below.
const FLOOR: f64 = 0.2;
/// Growth of the interval width per interval that the monitor allows.
const GRADING: f64 = 1.0;

/// Mesh monitor per interval: turning of the contour |c1| + |c2| and the band of a cue, over a floor that keeps half of
/// the intervals spread evenly. `symmetric` averages it with its mirror image on a mirror-symmetric mesh.
pub fn monitor(cortex: &Cortex, y: &Solution, symmetric: bool, weight: &mut Vec<f64>) {
    let length = y.scalars[0];
    let end = y.mesh[y.intervals()] - y.mesh[0];
    weight.clear();
    for i in 0..y.intervals() {
        let mut largest: f64 = 0.0;
        for j in 0..y.m {
            let s = y.stage(i, j);
            let x = y.mesh[i] + (y.mesh[i + 1] - y.mesh[i]) * (j as f64 + 0.5) / y.m as f64;
            let (kappa, kappa_u) = cortex.constants().rigidity(x);
            let c2 = s[PSI].sin() / s[R];
            let c1 = s[M] / kappa - c2;
            largest = largest.max(length * (c1.abs() + c2.abs()) + 10.0 * kappa_u.abs() / kappa);
        }
        weight.push(largest);
    }
    let n = weight.len();
    if symmetric {
        for i in 0..n / 2 {
            let both = 0.5 * (weight[i] + weight[n - 1 - i]);
            weight[i] = both;
            weight[n - 1 - i] = both;
        }
    }
    let mean = y.mesh.windows(2).zip(weight.iter()).map(|(x, w)| (x[1] - x[0]) * w).sum::<f64>() / end;
    for w in weight.iter_mut() {
        *w += FLOOR * mean;
    }
    // Interval widths are to vary gently: the wanted width 1/w may grow by at most GRADING per unit of u.
    let total: f64 = y.mesh.windows(2).zip(weight.iter()).map(|(x, w)| (x[1] - x[0]) * w).sum();
    let slope = GRADING * n as f64 / total;
    for i in 1..n {
        let distance = 0.5 * (y.mesh[i + 1] - y.mesh[i - 1]);
        weight[i] = weight[i].max(1.0 / (1.0 / weight[i - 1] + slope * distance));
    }
    for i in (0..n - 1).rev() {
        let distance = 0.5 * (y.mesh[i + 2] - y.mesh[i]);
        weight[i] = weight[i].max(1.0 / (1.0 / weight[i + 1] + slope * distance));
    }
}

/// Elongation H = (z(0) − z(1))/R0.
pub fn elongation(y: &Solution, domain: Domain, r0: f64) -> f64 {
    let (first, last) = (y.node(0)[Z], y.node(y.intervals())[Z]);
    match domain {
        Domain::Full => (first - last) / r0,
        Domain::Half => 2.0 * first / r0,
    }
}

/// Radius at u = ½.
pub fn equator_radius(gauss: &Gauss, y: &Solution) -> f64 {
    let mut out = [0.0; COMPONENTS];
    y.eval(gauss, 0.5, &mut out);
    out[R]
}

/// A cell has divided when its neck is narrower than this, relative to R0; thinner ones are no shapes of one cell.
pub const PINCH_OFF: f64 = 1e-3;

/// The narrowest interior minimum of r.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neck {
    /// Arclength fraction.
    pub u: f64,
    /// Radius r.
    pub radius: f64,
}

/// Finds the neck of a full contour: the smallest radius where the tangent angle passes ψ = π/2 downwards. None if the
/// contour has no waist.
pub fn neck(gauss: &Gauss, y: &Solution) -> Option<Neck> {
    let mut best: Option<Neck> = None;
    let mut value = [0.0; COMPONENTS];
    for i in 0..y.intervals() {
        // ψ above π/2 means r falls.
        let mut before = (0.0, y.node(i)[PSI]);
        for j in 0..=y.m {
            let theta = if j < y.m { gauss.c[j] } else { 1.0 };
            let psi = if j < y.m { y.stage(i, j)[PSI] } else { y.node(i + 1)[PSI] };
            if before.1 > 0.5 * PI && psi <= 0.5 * PI {
                let (mut low, mut high) = (before.0, theta);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    y.eval_in(gauss, i, middle, &mut value);
                    if value[PSI] > 0.5 * PI { low = middle } else { high = middle }
                }
                y.eval_in(gauss, i, 0.5 * (low + high), &mut value);
                let found = Neck { u: y.mesh[i] + 0.5 * (low + high) * (y.mesh[i + 1] - y.mesh[i]), radius: value[R] };
                if best.is_none_or(|b| found.radius < b.radius) {
                    best = Some(found);
                }
            }
            before = (theta, psi);
        }
    }
    best
}

/// Volume enclosed between the first pole and the plane at u, by Gauss quadrature of πr² sinψ.
pub fn volume_until(gauss: &Gauss, y: &Solution, u: f64) -> f64 {
    let length = y.scalars[0];
    let mut value = [0.0; COMPONENTS];
    let mut total = 0.0;
    for i in 0..y.intervals() {
        let h = y.mesh[i + 1] - y.mesh[i];
        let part = ((u - y.mesh[i]) / h).clamp(0.0, 1.0);
        if part == 0.0 {
            break;
        }
        for (c, b) in gauss.c.iter().zip(&gauss.b) {
            y.eval_in(gauss, i, c * part, &mut value);
            total += b * part * h * PI * length * value[R] * value[R] * value[PSI].sin();
        }
    }
    total
}

/// The meridional furrow position: where the curvature c1 is most negative, refined on the collocation polynomial;
/// `None` if c1 is positive everywhere.
pub fn furrow_position(gauss: &Gauss, cortex: &Cortex, y: &Solution) -> Option<f64> {
    let curvature = |i: usize, theta: f64| {
        let mut value = [0.0; COMPONENTS];
        y.eval_in(gauss, i, theta, &mut value);
        let u = y.mesh[i] + theta * (y.mesh[i + 1] - y.mesh[i]);
        let (kappa, _) = cortex.constants().rigidity(u);
        value[M] / kappa - value[PSI].sin() / value[R]
    };
    let at = |u: f64| {
        let i = y.interval_of(u);
        curvature(i, (u - y.mesh[i]) / (y.mesh[i + 1] - y.mesh[i]))
    };
    let mut best = (f64::INFINITY, 0.0);
    for i in 0..y.intervals() {
        for k in 0..4 {
            let theta = (k as f64 + 0.5) / 4.0;
            let c1 = curvature(i, theta);
            if c1 < best.0 {
                best = (c1, y.mesh[i] + theta * (y.mesh[i + 1] - y.mesh[i]));
            }
        }
    }
    if best.0 >= 0.0 {
        return None;
    }
    // Golden section on the bracketing quarter intervals.
    let i = y.interval_of(best.1);
    let width = 0.3 * (y.mesh[i + 1] - y.mesh[i]);
    let end = y.mesh[y.intervals()];
    let (mut low, mut high) = ((best.1 - width).max(y.mesh[0]), (best.1 + width).min(end));
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    for _ in 0..60 {
        let (x1, x2) = (high - golden * (high - low), low + golden * (high - low));
        if at(x1) < at(x2) { high = x2 } else { low = x1 }
    }
    Some(0.5 * (low + high))
}
