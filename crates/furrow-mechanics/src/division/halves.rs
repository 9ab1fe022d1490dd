//! Steps of a nearly mirror-symmetric cell on half of its contour.
//!
//! While the antisymmetric part of a shape is small, it does not affect the symmetric part. The symmetric part solves
//! the step by itself, on half of the contour with the conditions of the mirror (M.14); the antisymmetric part solves
//! the step linearised about it, with the conditions of M.15: N.16. Both have the same intervals, so that one
//! elimination serves both. The neglected terms are of second order in the antisymmetric part, which has its own error
//! in the step-size control.
//!
//! Neither part needs a factorisation in every step: the symmetric part is found by chord steps with the factors of an
//! earlier step, and the antisymmetric part by iterative refinement of its linear equations, evaluated about the
//! solution.

use furrow_bvp::newton::NewtonScratch;
use furrow_bvp::{
    AntisymmetricEnd, BoundaryValueProblem, CollocationPoint, Direction, FactorisationError, InvalidInput, Newton,
    NewtonError, NewtonReport, Residual, Solution, System,
};

use crate::cortex::equations::{Carried, J, LENGTH, PSI};
use crate::cortex::lanes::sin_cos;
use crate::cortex::symmetry::{self, fold, join};
use crate::cortex::{Cortex, Domain};

/// Relative accuracy of the antisymmetric part of a step.
const EXACT: f64 = 1e-4;
/// Refinement continues while each correction is at most this fraction of the previous one.
const LEAST_CONTRACTION: f64 = 0.5;
/// Most corrections before a new factorisation.
const MOST_CORRECTIONS: usize = 8;

/// Workspace for steps on half contours.
pub struct Halves {
    /// Linear algebra.
    pub system: System,
    cortex: Cortex,
    scratch: NewtonScratch,
    end: AntisymmetricEnd,
    even: Solution,
    odd: Direction,
    /// Antisymmetric part of the past (r, z) at the collocation points of the half.
    odd_past: Vec<[f64; 2]>,
    /// Antisymmetric part of the past of a regulator.
    odd_carried: Vec<Carried>,
    /// Residual of the antisymmetric part's equations due to the past.
    source: Residual,
    residual: Residual,
    correction: Direction,
}

impl Halves {
    /// For shapes of a mirror-symmetric cell with the discretisation of `shape`.
    pub fn new(cortex: &Cortex, shape: &Solution) -> Halves {
        Halves {
            system: System::new(cortex.dimensions(), shape.m),
            cortex: Cortex::new(&cortex.cell, Domain::Half, &[]),
            scratch: NewtonScratch::default(),
            end: AntisymmetricEnd::default(),
            even: shape.clone(),
            odd: Direction::default(),
            odd_past: Vec::new(),
            odd_carried: Vec::new(),
            source: Residual::default(),
            residual: Residual::default(),
            correction: Direction::default(),
        }
    }

    /// Solves the step stated by `cortex` on a mirror-symmetric mesh, from and into `y`. With `reuse` the existing
    /// factors are tried first.
    ///
    /// # Errors
    /// [`NewtonError`] if the iteration does not converge.
    pub fn solve(
        &mut self,
        newton: &Newton,
        cortex: &Cortex,
        y: &mut Solution,
        reuse: bool,
    ) -> Result<NewtonReport, NewtonError> {
        fold(y, &mut self.even, &mut self.odd);
        self.fold_past(cortex);
        let Halves { system, cortex, scratch, even, end, .. } = self;
        let mut report = newton.solve(system, scratch, cortex, even, &[], reuse)?;
        let singular = |error| NewtonError::of_factorisation(error, report.iterations);
        if report.factorisations > 0 {
            system.eliminate_antisymmetric(symmetry::even(y.components), end).map_err(singular)?;
        }
        system.evaluate(cortex, even, &[], true)?;
        self.find_source();
        match self.correct_repeatedly()? {
            Some(corrections) => report.iterations += corrections,
            None => {
                self.factorise().map_err(singular)?;
                self.correct()?;
                report.factorisations += 1;
                report.iterations += 1;
            }
        }
        join(&self.even, &self.odd, y);
        Ok(report)
    }

    /// Splits the past by parity; the symmetric part becomes the past of the problem on the half contour.
    fn fold_past(&mut self, cortex: &Cortex) {
        self.cortex.rate = cortex.rate;
        self.cortex.past.clear();
        self.odd_past.clear();
        let half = cortex.past.len() / 2;
        for ([r, z], [rm, zm]) in cortex.past.iter().zip(cortex.past.iter().rev()).take(half) {
            self.cortex.past.push([0.5 * (r + rm), 0.5 * (z - zm)]);
            self.odd_past.push([0.5 * (r - rm), 0.5 * (z + zm)]);
        }
        self.cortex.carried_past.clear();
        self.odd_carried.clear();
        let half = cortex.carried_past.len() / 2;
        for (here, there) in cortex.carried_past.iter().zip(cortex.carried_past.iter().rev()).take(half) {
            let ([a, r_u, z_u], [am, r_um, z_um]) = (here.parts(), there.parts());
            self.cortex.carried_past.push([0.5 * (a + am), 0.5 * (r_u - r_um), 0.5 * (z_u + z_um)].into());
            self.odd_carried.push([0.5 * (a - am), 0.5 * (r_u + r_um), 0.5 * (z_u - z_um)].into());
        }
    }

    /// The residual of the antisymmetric part if it were zero now and only the past had one, about the symmetric part
    /// at which the system was evaluated. The past enters through the normal velocity, in which the equations are
    /// linear.
    fn find_source(&mut self) {
        let Halves { system, cortex, even, source, odd_past, odd_carried, .. } = self;
        system.zero_residual_into(source);
        source.right.truncate(symmetry::even(even.components).len());
        let (length, n) = (even.scalars[LENGTH], even.components);
        for (i, interval) in even.mesh.windows(2).enumerate() {
            let h = interval[1] - interval[0];
            for j in 0..even.m {
                let (point, state) = (i * even.m + j, even.stage(i, j));
                let [r, z] = odd_past[point];
                let (sin, cos) = sin_cos(state[PSI]);
                let velocity = cortex.rate * (sin * r + cos * z);
                let at = CollocationPoint { x: even.stage_x(&system.gauss, i, j), index: point };
                let response = cortex.response_to_motion(at, state, length);
                let source = &mut source.stages[point * n..(point + 1) * n];
                response.put(h * velocity, 0.0, source);
                if let Some(past) = odd_carried.get(point) {
                    source[J] =
                        h * cortex.response_to_past(state, length, [r, z], *past) + h * velocity * response.strain;
                }
            }
        }
    }

    /// Factorises both problems where the system was evaluated.
    fn factorise(&mut self) -> Result<(), FactorisationError> {
        self.system.condense()?;
        self.system.factor_blocks(&[])?;
        self.system.eliminate_antisymmetric(symmetry::even(self.even.components), &mut self.end)
    }

    /// Corrects the antisymmetric part with the existing factors.
    fn correct(&mut self) -> Result<(), InvalidInput> {
        let Halves { system, end, odd, residual, source, correction, .. } = self;
        residual.clone_from(source);
        system.apply_antisymmetric(end, odd, residual)?;
        system.solve_antisymmetric(end, residual, correction)?;
        odd.add(1.0, correction);
        Ok(())
    }

    /// Corrects the antisymmetric part until it is accurate enough, and returns the number of corrections; `None` if
    /// they do not contract.
    fn correct_repeatedly(&mut self) -> Result<Option<usize>, InvalidInput> {
        let mut before = f64::INFINITY;
        for corrections in 1..=MOST_CORRECTIONS {
            self.correct()?;
            let size = self.correction.largest_at_nodes();
            let contraction = if corrections == 1 { LEAST_CONTRACTION } else { size / before };
            if !(contraction <= LEAST_CONTRACTION && size.is_finite()) {
                return Ok(None);
            }
            if size * contraction / (1.0 - contraction) <= EXACT * self.odd.largest_at_nodes() {
                return Ok(Some(corrections));
            }
            before = size;
        }
        Ok(None)
    }
}
