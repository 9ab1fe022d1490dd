//! Detection of rest: the stationary state next to a shape, and its stability.

use furrow_bvp::{Newton, Solution, mesh};

use super::stepper::{Stepper, change_norm, parity_norm};
use crate::cortex::equations::{R, Z};
use crate::cortex::symmetry::unfold;
use crate::cortex::{Cortex, Domain, amount};
use crate::stability::Stability;

/// A shape slower than this, relative to R0 and in 1/τ, may be at rest.
const REST_SPEED: f64 = 1e-2;
/// Time between two searches for a stationary state, in τ.
pub const REST_INTERVAL: f64 = 0.5;
/// A slow shape farther from rest than this by its estimate, relative to R0, is passed over: it leaves a saddle, or has
/// not come near.
const SURELY_TOO_FAR: f64 = 2.0 * REST_DISTANCE;
/// Most shapes passed over in a row: the estimate assumes a single mode.
const MOST_PASSED_OVER: usize = 20;
/// A growth rate below this, in 1/τ, is computed on finer and finer meshes until it is known to 1 %.
const CRITICAL: f64 = 5e-4;
/// Most halvings of a mesh for this.
const MOST_HALVINGS: u32 = 4;

/// Largest L² distance to a stationary state, relative to R0, at which its stability decides.
const REST_DISTANCE: f64 = 2e-3;

/// Symmetric shapes that grow or decay more slowly than this, in 1/τ, may have asymmetric stationary shapes equally
/// near.
const CLEAR: f64 = 1e-3;

/// The first iteration for the stationary state. From a nearby shape it takes one factorisation. Next to a singular
/// point it takes more and continues; an iteration that has moved away by then had no solution nearby.
const NEARBY: Newton = Newton {
    tolerance: 1e-9,
    max_factorisations: 2,
    max_iterations: 12,
    min_damping: 0.1,
    leniency: 1.0,
    chord_contraction: 0.3,
};

/// A stationary shape next to the cell's, on the division's mesh with halved intervals.
pub struct Rest {
    /// The cell's own shape on this mesh.
    pub here: Solution,
    /// The stationary shape.
    pub stationary: Solution,
    /// Its leading growth rate, in 1/τ.
    pub growth_rate: f64,
    /// Number of times that every interval of the division's mesh is halved.
    pub halvings: u32,
}

/// Detects rest during a division.
#[derive(Clone, Copy, Debug, Default)]
pub struct EquilibriumDetector {
    /// Time of the next search, in τ.
    pub next: f64,
    /// Slow shapes since the last search that were estimated to be too far from rest.
    passed_over: usize,
}

impl EquilibriumDetector {
    /// The stationary state near the shape, if there is one.
    ///
    /// A slow shape is only a hint: near a saddle it is slow too. The stationary state next to it is solved for, and its
    /// leading growth rate decides.
    pub fn look(&mut self, stepper: &Stepper, nearly_symmetric: bool) -> Option<Rest> {
        let t = stepper.history[0].t;
        if t < self.next || stepper.speed() > REST_SPEED {
            return None;
        }
        self.next = t + REST_INTERVAL;
        let far = stepper.distance_to_rest().is_some_and(|distance| distance > SURELY_TOO_FAR);
        if far && self.passed_over < MOST_PASSED_OVER {
            self.passed_over += 1;
            return None;
        }
        self.passed_over = 0;
        let mut rest = Rest::near(stepper, 1, nearly_symmetric)?;
        // The mesh of the division is coarse; near the critical radius its growth rate may have the wrong sign.
        while rest.growth_rate.abs() < CRITICAL && rest.halvings < MOST_HALVINGS {
            let finer = Rest::near(stepper, rest.halvings + 1, nearly_symmetric)?;
            let change = (finer.growth_rate - rest.growth_rate).abs();
            rest = finer;
            if change < 0.01 * rest.growth_rate.abs() {
                break;
            }
        }
        (rest.growth_rate != 0.0 && rest.growth_rate.is_finite()).then_some(rest)
    }
}

impl Rest {
    /// The stationary state next to the newest shape, on the division's mesh with every interval halved `halvings`
    /// times. If a mirror-symmetric state may be near enough, it is looked for first, on half of the contour.
    pub fn near(stepper: &Stepper, halvings: u32, nearly_symmetric: bool) -> Option<Rest> {
        let newest = &stepper.history[0].y;
        let grid = (0..halvings).fold(newest.mesh.clone(), |grid, _| mesh::halved(&grid));
        let here = newest.on_mesh(&stepper.system.gauss, &grid);
        let (cell, n) = (&stepper.cortex.cell, here.components);
        let on_half = nearly_symmetric && cell.is_mirror_symmetric() && grid.len() % 2 == 1 && {
            let value = |i: usize| [here.stages[i * n + R], here.stages[i * n + Z]];
            parity_norm(&stepper.system.gauss, &here.mesh, value).odd < REST_DISTANCE * cell.r0
        };
        let symmetric = if on_half { beside(stepper, &here, Domain::Half) } else { None };
        let (stationary, growth_rate) = match symmetric {
            Some(found) if found.1.abs() > CLEAR => found,
            _ => beside(stepper, &here, Domain::Full)?,
        };
        Some(Rest { here, stationary, growth_rate, halvings })
    }
}

/// The stationary state next to the shape `here`, on a domain, with its leading growth rate; `None` if it is too far
/// away.
fn beside(stepper: &Stepper, here: &Solution, domain: Domain) -> Option<(Solution, f64)> {
    let mut cortex = Cortex::new(&stepper.cortex.cell, domain, &[]);
    let (mut y, n) = (here.clone(), here.components);
    if domain == Domain::Half {
        let intervals = here.intervals() / 2;
        y.mesh.truncate(intervals + 1);
        y.mesh[intervals] = Domain::Half.end();
        y.nodes.truncate((intervals + 1) * n);
        y.stages.truncate(intervals * here.m * n);
    }
    let wanted = amount::of(&y);
    let near = |y: &Solution| {
        let whole = if domain == Domain::Full { y.clone() } else { unfold(y) };
        let distance = change_norm(&stepper.system.gauss, here, stepper.cortex.cell.r0, |i, at| {
            at.map(|k| whole.stages[i + k] - here.stages[i + k])
        });
        (distance.even.hypot(distance.odd) <= REST_DISTANCE * stepper.cortex.cell.r0).then_some(whole)
    };
    if amount::solve_at_rest(&NEARBY, &mut cortex, &mut y, wanted).is_err() {
        near(&y)?;
        amount::solve_at_rest(&Newton::default(), &mut cortex, &mut y, wanted).ok()?;
    }
    let whole = near(&y)?;
    let growth_rate = Stability::new(y.m).leading(&cortex, &y).ok()?.growth_rate();
    Some((whole, growth_rate))
}
