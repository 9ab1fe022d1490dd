//! States on which the equations are compared: shapes at rest, moving shapes, random states.

use furrow_bvp::newton::NewtonScratch;
use furrow_bvp::{BoundaryValueProblem, Newton, NewtonError, Solution, System};
use furrow_cell::cue::Field;
use furrow_cell::{Cell, CueError, Numerics};
use furrow_mechanics::cortex::equations::{Carried, PHI, R};
use furrow_mechanics::cortex::observables::{carried, positions, with_components};
use furrow_mechanics::cortex::symmetry::unfold;
use furrow_mechanics::cortex::{Cortex, Domain};
use furrow_mechanics::equilibria::{StationaryError, passive, stationary};

use crate::contour::Computed;

/// Random numbers, the same on every machine.
#[derive(Clone, Debug)]
pub struct Draws(pub u64);

impl Draws {
    /// The next number between two limits.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A label of the material, a source that follows the contour's length, a regulator without one, and couplings that saturate, beside a
/// painted term and beside each other.
const CARRIED: [&str; 3] = [
    "regulator:step,u0=0.55,omega=0.8Lh,amplitude=0.6,turnover=3,diffusion=1.2,diluted=false,kappa=0.3,xi_b=-0.4",
    "regulator:none,turnover=5,diffusion=0.9,activity=0.5,tension=0.7,tension.half=1.5",
    "kappa:gradient,amplitude=0.2+regulator:gradient,amplitude=0.3,turnover=2,diffusion=1,kappa=0.6,kappa.half=0.8",
];

/// No cue, every field with every profile, widths in u and in L_h, a sum of two terms, and regulators.
pub fn cues() -> Vec<String> {
    let mut out = vec!["none".to_owned()];
    for name in Field::ALL.map(Field::name) {
        out.push(format!("{name}:band,u0=0.44,omega=0.15,amplitude=0.2"));
        out.push(format!("{name}:step,u0=0.4,omega=0.9Lh,amplitude=-0.3"));
        out.push(format!("{name}:gradient,amplitude=0.25"));
    }
    out.push("kappa:gradient,amplitude=0.2+tension:band,u0=0.6,omega=0.8Lh,amplitude=0.5".to_owned());
    for name in Field::ALL.map(Field::name) {
        out.push(format!("regulator:band,u0=0.44,omega=0.2,amplitude=0.5,turnover=4,diffusion=0.7,{name}=0.4"));
    }
    out.extend(CARRIED.map(str::to_owned));
    out
}

/// A cell with constants that differ from each other and from 1, so that a test notices if two are swapped.
pub fn uneven_cell(r0: f64, xi_s: f64, cue: &str) -> Result<Cell, CueError> {
    let mut cell = Cell { xi_s, ..Cell::gao2026_thresholds(r0).with_cue(cue.parse()?) };
    let material = &mut cell.material;
    (material.kappa, material.eta_b, material.eta_s) = (1.3, 0.9, 0.7);
    (material.friction, material.tension, material.xi_ratio) = (1.2, 0.15, -0.12);
    (material.spontaneous_curvature, material.normal_friction) = (0.2, 0.35);
    Ok(cell)
}

/// Discretisation of [`resting`] and [`moving`] shapes, at which sums over collocation points are integrals to about 1e-8.
pub fn fine() -> Numerics {
    Numerics { intervals: 96, ..Numerics::default() }
}

/// The whole contour of a shape at rest, with activity and cue.
///
/// # Errors
/// If no such shape is found.
pub fn resting(cell: &Cell) -> Result<Computed, StationaryError> {
    let found = stationary(cell, &fine())?;
    let shape = match found.cortex.domain {
        Domain::Half => unfold(&found.solution),
        Domain::Full => found.solution,
    };
    Ok(Computed { cell: cell.clone(), shape, motion: Vec::new(), noise: Vec::new() })
}

/// The passive shape of a cell without its cue, on the whole contour.
///
/// # Errors
/// If Newton's method fails.
pub fn passive_shape(cell: &Cell, numerics: &Numerics) -> Result<Solution, NewtonError> {
    Ok(unfold(&passive(cell, numerics)?.0))
}

/// The past of a step of given rate from which the regulator of state `y` changes at `phi_t`, where the contour moves at `r_t` outwards
/// from the axis and stretches at `stretching`.
pub fn carried_past(cell: &Cell, y: &[f64], length: f64, rate: f64, [phi_t, r_t, stretching]: [f64; 3]) -> Carried {
    let diluted = cell.cue.regulator().is_some_and(|regulator| regulator.diluted);
    let now = Carried::of(y, length, diluted);
    let c = 1.0 + y[PHI];
    let amount_t = if diluted { y[R] * length * (phi_t + c * (r_t / y[R] + stretching)) } else { phi_t };
    let kept = 1.0 - stretching / rate;
    Carried { amount: now.amount - amount_t / rate, r_u: kept * now.r_u, z_u: kept * now.z_u }
}

/// The cell after `steps` implicit steps from its passive shape, solved to rounding, with the velocity of the last step. The first
/// step is 10⁻³ τ and each is twice as long as the one before; noise makes the activity of the last one uneven.
///
/// # Errors
/// If Newton's method fails.
pub fn moving(cell: &Cell, steps: usize) -> Result<Computed, NewtonError> {
    let mut cortex = Cortex::new(cell, Domain::Full, &[]);
    let mut shape = with_components(&passive_shape(cell, &fine())?, cortex.components());
    let mut system = System::new(cortex.dimensions(), shape.m);
    // As the steps of a division: without leniency one start in forty stalls, and which one is a matter of roundings.
    let newton = Newton { tolerance: 1e-11, leniency: 2.0, ..Newton::default() };
    let (mut before, mut after) = (Vec::new(), Vec::new());
    let mut dt = 5e-4;
    for step in 0..steps {
        dt *= 2.0;
        cortex.rate = 1.0 / dt;
        positions(&shape, &mut before);
        cortex.past.clone_from(&before);
        let mut past = Vec::new();
        carried(&cortex, &shape, &mut past);
        cortex.carried_past = past;
        if step + 1 == steps {
            let count = before.len() as f64;
            cortex.noise = (0..before.len()).map(|k| 1.0 + 0.05 * (9.0 * k as f64 / count).cos()).collect();
        }
        newton.solve(&mut system, &mut NewtonScratch::default(), &mut cortex, &mut shape, &[], false)?;
    }
    positions(&shape, &mut after);
    let motion = after.iter().zip(&before).map(|(new, old)| [0, 1].map(|k| (new[k] - old[k]) / dt)).collect();
    Ok(Computed { cell: cell.clone(), shape, motion, noise: cortex.noise })
}
