//! Passive shapes: a cell without activity in its shell, the start of every division and every branch.

use std::f64::consts::PI;

use furrow_bvp::gauss::gauss_rule;
use furrow_bvp::newton::NewtonScratch;
use furrow_bvp::{Gauss, InvalidInput, Newton, NewtonError, NewtonReport, Solution, System, mesh};

use crate::cortex::equations::{COMPONENTS, M, PSI, Q, R, T, V, Z};
use crate::cortex::observables::positions;
use crate::cortex::symmetry::unfold;
use crate::cortex::{Cortex, Domain};
use furrow_cell::{Cell, Numerics};

/// A prolate spheroid parametrised by arclength.
struct Spheroid {
    /// Half axes along and across.
    a: f64,
    b: f64,
    /// Arclength up to the ends of equal intervals of the parametric angle, by Gauss quadrature.
    arc: Vec<f64>,
    /// Points and weights of the quadrature.
    rule: (Vec<f64>, Vec<f64>),
}

/// Number of intervals in the table of arclengths.
const PIECES: usize = 400;

impl Spheroid {
    fn new(a: f64, b: f64) -> Spheroid {
        let mut spheroid = Spheroid { a, b, arc: vec![0.0], rule: gauss_rule(4) };
        for k in 0..PIECES {
            let next = spheroid.arc[k] + spheroid.arc_between(Spheroid::angle(k), Spheroid::angle(k + 1));
            spheroid.arc.push(next);
        }
        spheroid
    }

    fn angle(k: usize) -> f64 {
        k as f64 * PI / PIECES as f64
    }

    fn speed(&self, t: f64) -> f64 {
        ((self.b * t.cos()).powi(2) + (self.a * t.sin()).powi(2)).sqrt()
    }

    fn arc_between(&self, from: f64, to: f64) -> f64 {
        let (c, w) = &self.rule;
        c.iter().zip(w).map(|(c, w)| w * self.speed(from + c * (to - from))).sum::<f64>() * (to - from)
    }

    /// The parametric angle at arclength s. The table is fine enough for one correction along the local speed.
    fn angle_at(&self, s: f64) -> f64 {
        let k = self.arc.partition_point(|&x| x <= s).clamp(1, PIECES) - 1;
        let from = Spheroid::angle(k);
        let share = (s - self.arc[k]) / (self.arc[k + 1] - self.arc[k]);
        let t = from + share * (Spheroid::angle(k + 1) - from);
        t - (self.arc[k] + self.arc_between(from, t) - s) / self.speed(t)
    }

    /// c1 + c2 at a parametric angle.
    fn mean_curvature(&self, t: f64) -> f64 {
        let g = self.speed(t);
        self.a * self.b / g.powi(3) + self.a / (self.b * g)
    }
}

/// A prolate spheroid with the cell's volume that fits the shell: between a sphere (loose shell) and the shell's own
/// shape scaled to the cell's volume (tight shell), sampled on `mesh`; (L, p) are its contour length and 0.
///
/// # Errors
/// [`InvalidInput`] if `mesh` is not a valid mesh.
pub(crate) fn spheroid(gauss: &Gauss, cell: &Cell, mesh: &[f64]) -> Result<Solution, InvalidInput> {
    // Confined shapes follow the shell; at small ε the sphere fits easily.
    let weight = ((cell.epsilon - 0.3) / 0.4).clamp(0.0, 1.0);
    let aspect = cell.shell.aspect.powf(weight);
    let b = cell.r0 / aspect.cbrt();
    let ellipse = Spheroid::new(aspect * b, b);
    let (kappa, spontaneous) = (cell.material.kappa, cell.material.spontaneous_curvature);
    let length = ellipse.arc[PIECES];
    Solution::from_fn(gauss, mesh, COMPONENTS, &[length, 0.0], |u, y| {
        let t = ellipse.angle_at(u * length);
        y[R] = ellipse.b * t.sin();
        y[Z] = ellipse.a * t.cos();
        y[PSI] = (ellipse.a * t.sin()).atan2(ellipse.b * t.cos());
        y[M] = kappa * (ellipse.mean_curvature(t) - spontaneous);
        let dt = 1e-4;
        let rise = ellipse.mean_curvature(t + dt) - ellipse.mean_curvature(t - dt);
        y[Q] = kappa * rise / (2.0 * dt * ellipse.speed(t));
        y[V] = 0.0;
        y[T] = 0.0;
    })
}

/// A shape and the work it took.
type Found = Result<(Solution, NewtonReport), NewtonError>;

/// Newton's tolerance for passive shapes, on which everything else is based.
const TOLERANCE: f64 = 1e-11;

/// The passive (ξ = 0) shape of a cell without its cue in a mirror-symmetric shell, on the half domain; R0 > 0 and ε ∈ [0.3, 0.95].
///
/// Newton's method from a spheroid; if this fails, implicit steps of increasing size lead to the shape, which is an
/// attractor without activity.
///
/// # Examples
/// ```
/// use furrow_cell::{Cell, Numerics};
/// use furrow_mechanics::cortex::{Domain, observables::elongation};
/// let (half, _) = furrow_mechanics::equilibria::passive(&Cell::new(2.0), &Numerics::default())?;
/// // In a shell of a/b = 1.5 the cell is longer than a sphere, whose elongation is 2.
/// assert!(elongation(&half, Domain::Half, 2.0) > 2.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The last error of Newton's method.
pub fn passive(cell: &Cell, numerics: &Numerics) -> Found {
    passive_on(Domain::Half, cell, numerics)
}

/// The whole [`passive`] shape: twice its half, unless the shell tells one pole from the other.
///
/// # Errors
/// As [`passive`].
pub fn passive_whole(cell: &Cell, numerics: &Numerics) -> Found {
    if cell.has_even_shell() {
        let (half, report) = passive(cell, numerics)?;
        return Ok((unfold(&half), report));
    }
    passive_on(Domain::Full, cell, numerics)
}

fn passive_on(domain: Domain, cell: &Cell, numerics: &Numerics) -> Found {
    let cell = cell.passive();
    let mut cortex = Cortex::new(&cell, domain, &[]);
    let mut system = System::new(Cortex::dimensions_for(&cell, 0), numerics.stages);
    let newton = Newton { tolerance: TOLERANCE, ..Newton::default() };
    let intervals = if domain == Domain::Half { numerics.intervals / 2 } else { numerics.intervals };
    let grid = mesh::uniform(0.0, domain.end(), intervals.max(2));
    let guess = spheroid(&system.gauss, &cell, &grid)?;
    let mut y = guess.clone();
    match newton.solve(&mut system, &mut NewtonScratch::default(), &mut cortex, &mut y, &[], false) {
        Ok(report) if is_convex(&y, domain) => Ok((y, report)),
        _ => relax(cortex, system, newton, guess),
    }
}

/// Follows the passive dynamics from a guess by implicit steps of increasing size until they are long enough for rest.
fn relax(mut cortex: Cortex, mut system: System, newton: Newton, mut y: Solution) -> Found {
    // Times scale with R0².
    let scale = cortex.cell.r0 * cortex.cell.r0;
    let mut scratch = NewtonScratch::default();
    let mut total = NewtonReport::default();
    let (mut dt, mut last) = (1e-3 * scale, NewtonError::NonFinite { iterations: 0 });
    for _ in 0..200 {
        positions(&y, &mut cortex.past);
        cortex.rate = 1.0 / dt;
        let before = y.clone();
        match newton.solve(&mut system, &mut scratch, &mut cortex, &mut y, &[], false) {
            Ok(report) if is_convex(&y, cortex.domain) => {
                total.iterations += report.iterations;
                total.factorisations += report.factorisations;
                dt *= 3.0;
                if dt > 1e8 * scale {
                    break;
                }
            }
            other => {
                last = other.err().unwrap_or(last);
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

/// A contour with positive radius that runs downwards, its half as far as the equator, as every passive shape does.
fn is_convex(y: &Solution, domain: Domain) -> bool {
    let (lowest, end) = if domain == Domain::Half { (-1e-6, 0.5 * PI) } else { (f64::NEG_INFINITY, PI) };
    y.scalars[0] > 0.0
        && y.stages.chunks_exact(COMPONENTS).all(|s| s[R] > 0.0 && s[Z] > lowest && s[PSI] > -0.5 && s[PSI] < end + 0.5)
}
