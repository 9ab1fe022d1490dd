//! Observables of a shape: elongation, neck, furrow, volumes.

use std::f64::consts::PI;

use furrow_bvp::{Bracket, CollocationPoint, Gauss, Solution};

use super::Cortex;
use super::equations::{Carried, Domain, LENGTH, PHI, PSI, R, REGULATED, Z};
use super::lanes::sin_cos;
use serde::{Deserialize, Serialize};

/// Collects (r, z) at the collocation points of a solution.
pub fn positions(y: &Solution, out: &mut Vec<[f64; 2]>) {
    out.clear();
    out.extend(y.stages.chunks_exact(y.components).map(|s| [s[R], s[Z]]));
}

/// Collects the state of a regulator at the collocation points of a solution, as the past of a step; empty without a
/// regulator.
pub fn carried(cortex: &Cortex, y: &Solution, out: &mut Vec<Carried>) {
    out.clear();
    if let Some(regulator) = cortex.cell.cue.regulator() {
        let length = y.scalars[LENGTH];
        out.extend(y.stages.chunks_exact(REGULATED).map(|s| Carried::of(s, length, regulator.diluted)));
    }
}

/// φ at u; u > ½ on a half contour is mirrored. `None` without a regulator.
pub fn regulator_at(gauss: &Gauss, y: &Solution, domain: Domain, u: f64) -> Option<f64> {
    let mut out = [0.0; REGULATED];
    let u = if domain == Domain::Half && u > 0.5 { 1.0 - u } else { u };
    (y.components == REGULATED).then(|| {
        y.eval(gauss, u, &mut out);
        out[PHI]
    })
}

/// The same shape with another number of components: the components of a regulator at rest are added or removed.
pub fn with_components(y: &Solution, components: usize) -> Solution {
    let convert = |values: &[f64]| -> Vec<f64> {
        let state = |s: &[f64]| -> Vec<f64> { (0..components).map(|k| s.get(k).copied().unwrap_or(0.0)).collect() };
        values.chunks_exact(y.components).flat_map(state).collect()
    };
    let (nodes, stages) = (convert(&y.nodes), convert(&y.stages));
    Solution { components, m: y.m, mesh: y.mesh.clone(), nodes, stages, scalars: y.scalars.clone() }
}

/// The whole contour as (r, z) at `count` + 1 values of u, evenly spaced from pole to pole; a half contour is completed
/// by its mirror image.
pub fn contour(gauss: &Gauss, y: &Solution, domain: Domain, count: usize) -> Vec<[f64; 2]> {
    let mut out = [0.0; REGULATED];
    let mut at = |u: f64| {
        let mirrored = domain == Domain::Half && u > 0.5;
        y.eval(gauss, if mirrored { 1.0 - u } else { u }, &mut out[..y.components]);
        [out[R], if mirrored { -out[Z] } else { out[Z] }]
    };
    (0..=count).map(|k| at(k as f64 / count as f64)).collect()
}

/// Elongation H = (z(0) − z(1))/R0.
pub fn elongation(y: &Solution, domain: Domain, r0: f64) -> f64 {
    let (first, last) = (y.node(0)[Z], y.node(y.intervals())[Z]);
    match domain {
        Domain::Full => (first - last) / r0,
        Domain::Half => 2.0 * first / r0,
    }
}

/// Area of the whole surface, in L_h², and energy of its bending ∫ ½κ(C − C0)² dA, in κ0.
pub fn area_and_bending(gauss: &Gauss, cortex: &Cortex, y: &Solution) -> [f64; 2] {
    let length = y.scalars[LENGTH];
    let mut reader = cortex.constants().reader();
    let mut sums = [0.0; 2];
    for (index, s) in y.stages.chunks_exact(y.components).enumerate() {
        let (i, j) = (index / y.m, index % y.m);
        let x = y.stage_x(gauss, i, j);
        let here = cortex.coefficients_at(CollocationPoint { x, index }, s, length);
        let bent = reader.mean_curvature(x, &here, s, length)[0] - here.spontaneous;
        let area = 2.0 * PI * s[R] * length * (y.mesh[i + 1] - y.mesh[i]) * gauss.b[j] / cortex.domain.end();
        sums[0] += area;
        sums[1] += area * 0.5 * here.kappa * bent * bent;
    }
    sums
}

/// Reduced volume of a cell of radius R0 with this area: its volume divided by the volume of a sphere with this area.
pub fn reduced_volume(r0: f64, area: f64) -> f64 {
    (4.0 * PI * r0 * r0 / area).powf(1.5)
}

/// Radius at u = ½.
pub fn equator_radius(gauss: &Gauss, y: &Solution) -> f64 {
    let mut out = [0.0; REGULATED];
    y.eval(gauss, 0.5, &mut out[..y.components]);
    out[R]
}

/// A cell has divided when its neck is narrower than this, relative to R0 (M.20); a thinner neck does not belong to one
/// cell.
pub const PINCH_OFF: f64 = 1e-3;

/// The narrowest interior minimum of r.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neck {
    /// Arclength fraction.
    pub u: f64,
    /// Radius r.
    pub radius: f64,
}

/// Finds the neck of a full contour: its narrowest waist. `None` if the contour has no waist.
pub fn neck(gauss: &Gauss, y: &Solution) -> Option<Neck> {
    let mut best: Option<Neck> = None;
    for_each_waist(gauss, y, |found| {
        if best.is_none_or(|best| found.radius < best.radius) {
            best = Some(found);
        }
    });
    best
}

/// Finds the places of a full contour where r has a minimum: where the tangent angle passes ψ = π/2 downwards.
fn for_each_waist(gauss: &Gauss, y: &Solution, mut found: impl FnMut(Neck)) {
    let mut value = [0.0; REGULATED];
    for i in 0..y.intervals() {
        // r decreases where ψ exceeds π/2.
        let mut before = (0.0, y.node(i)[PSI]);
        for j in 0..=y.m {
            let theta = if j < y.m { gauss.c[j] } else { 1.0 };
            let psi = if j < y.m { y.stage(i, j)[PSI] } else { y.node(i + 1)[PSI] };
            if before.1 > 0.5 * PI && psi <= 0.5 * PI {
                let theta = waist(gauss, y, i, [before.into(), [theta, psi]]);
                y.eval_in(gauss, i, theta, &mut value[..y.components]);
                found(Neck { u: y.mesh[i] + theta * (y.mesh[i + 1] - y.mesh[i]), radius: value[R] });
            }
            before = (theta, psi);
        }
    }
}

/// A waist narrower than this, relative to R0, closes together with the neck: a closing neck is faster than all else.
const NEARLY_CLOSED: f64 = 0.05;
/// A smaller share of the volume is no part of its own: the two ends of a tube are one neck.
const LEAST_PART: f64 = 1e-3;

/// A second neck that is nearly closed when the first one closes: the cell falls into three parts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SecondNeck {
    /// Its arclength fraction.
    pub u: f64,
    /// Its radius, in L_h.
    pub radius: f64,
    /// Volume of the part beyond it, which the first neck does not bound, as a fraction of the cell's.
    pub share: f64,
}

/// Finds the narrowest waist beside `first` that is nearly closed and bounds a part of its own.
pub(crate) fn second_neck(gauss: &Gauss, y: &Solution, first: Neck, r0: f64) -> Option<SecondNeck> {
    let volume = volume_until(gauss, y, 1.0);
    let below = |u: f64| volume_until(gauss, y, u) / volume;
    let mut best: Option<SecondNeck> = None;
    for_each_waist(gauss, y, |Neck { u, radius }| {
        if u == first.u || radius >= best.map_or(NEARLY_CLOSED * r0, |best| best.radius) {
            return;
        }
        let [first_below, share_below] = [first.u, u].map(below);
        let share = if u < first.u { share_below } else { 1.0 - share_below };
        if share.min((share_below - first_below).abs()) >= LEAST_PART {
            best = Some(SecondNeck { u, radius, share });
        }
    });
    best
}

/// The secant method finds a waist to within this distance in θ.
const NEAR: f64 = 1e-11;
/// Larger values of |ψ − π/2| have a certain sign in spite of rounding.
const CLEAR: f64 = 1e-14;

/// θ at which ψ passes π/2 downwards on interval i, between two θ with their ψ, by bisection to the last digit. The secant method
/// tells the sign of ψ − π/2 at most midpoints, so that ψ is evaluated only near the root.
fn waist(gauss: &Gauss, y: &Solution, i: usize, ends: [[f64; 2]; 2]) -> f64 {
    let excess = |theta: f64| y.component_in(gauss, i, theta, PSI) - 0.5 * PI;
    let mut bracket = Bracket::new(ends.map(|[theta, psi]| [theta, psi - 0.5 * PI]));
    for _ in 0..10 {
        let theta = bracket.secant();
        let here = excess(theta);
        bracket.keep([theta, here]);
        if here.abs() < CLEAR {
            break;
        }
    }
    let [mut low, mut high] = ends.map(|[theta, _]| theta);
    let root = bracket.secant();
    let near = [root - NEAR, root + NEAR];
    let is_found = excess(near[0]) > CLEAR && excess(near[1]) < -CLEAR;
    let [from, to] = if is_found { near } else { [low, high] };
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if middle == low || middle == high {
            break;
        }
        if middle <= from || middle < to && excess(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Volume enclosed between the first pole and the plane at u, by Gauss quadrature of πr² sinψ.
pub fn volume_until(gauss: &Gauss, y: &Solution, u: f64) -> f64 {
    let length = y.scalars[LENGTH];
    let mut value = [0.0; REGULATED];
    let mut total = 0.0;
    for i in 0..y.intervals() {
        let h = y.mesh[i + 1] - y.mesh[i];
        let part = ((u - y.mesh[i]) / h).clamp(0.0, 1.0);
        if part == 0.0 {
            break;
        }
        for (c, b) in gauss.c.iter().zip(&gauss.b) {
            y.eval_in(gauss, i, c * part, &mut value[..y.components]);
            total += b * part * h * PI * length * value[R] * value[R] * value[PSI].sin();
        }
    }
    total
}

/// (V_above − V_below)/V for the parts on both sides of u, usually of the neck: χ with its sign, M.21.
pub fn asymmetry(gauss: &Gauss, y: &Solution, u: f64) -> f64 {
    1.0 - 2.0 * volume_until(gauss, y, u) / volume_until(gauss, y, 1.0)
}

/// The meridional furrow position: the minimum of the curvature c1 next to the collocation point with the most negative
/// c1; `None` if c1 is positive at all of them.
///
/// There c1_s = q/κ − m κ_s/κ² − (cosψ/r)(c1 − c2) vanishes, which gives the position to the last digits; minimising c1
/// itself would give half of them.
pub(crate) fn furrow_position(gauss: &Gauss, cortex: &Cortex, y: &Solution) -> Option<f64> {
    let length = y.scalars[LENGTH];
    let place = |index: usize| y.stage_x(gauss, index / y.m, index % y.m);
    let states = || y.stages.chunks_exact(y.components);
    let mut reader = cortex.constants().reader();
    let curvature = |(index, s): (usize, &[f64])| {
        let here = cortex.coefficients_at(CollocationPoint { x: place(index), index }, s, length);
        let [mean, _] = reader.mean_curvature(place(index), &here, s, length);
        (mean - sin_cos(s[PSI]).0 / s[R], index)
    };
    let (_, nearest) =
        states().enumerate().map(curvature).filter(|(c1, _)| *c1 < 0.0).min_by(|a, b| a.0.total_cmp(&b.0))?;
    let mut slope = |u: f64| {
        let mut value = [0.0; REGULATED];
        let s = &mut value[..y.components];
        y.eval(gauss, u, s);
        let here = cortex.constants().of_state(u, s, length);
        let ([mean, mean_s], (sin, cos)) = (reader.mean_curvature(u, &here, s, length), sin_cos(s[PSI]));
        mean_s - cos / s[R] * (mean - 2.0 * sin / s[R])
    };
    let around = [nearest.saturating_sub(1), (nearest + 1).min(states().len() - 1)];
    let [mut before, mut newest] = around.map(|index| (place(index), slope(place(index))));
    if !(before.1 < 0.0 && newest.1 > 0.0) {
        return Some(place(nearest));
    }
    for _ in 0..60 {
        let u = newest.0 - newest.1 * (newest.0 - before.0) / (newest.1 - before.1);
        let (next, moved) = ((u, slope(u)), (u - newest.0).abs());
        // The Illinois rule: the value at an end that is kept is halved.
        before = if next.1 * newest.1 < 0.0 { newest } else { (before.0, 0.5 * before.1) };
        newest = next;
        if moved < 1e-12 {
            break;
        }
    }
    Some(newest.0)
}
