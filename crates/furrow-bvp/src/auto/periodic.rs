//! Periodic orbits as boundary-value problems with separated conditions.

use crate::dimensions::Dimensions;
use crate::gauss::Gauss;
use crate::invalid::InvalidInput;
use crate::linear::{FactorisationError, System};
use crate::problem::BoundaryValueProblem;
use crate::solution::Solution;

use super::numbers::Number;
use super::{Auto, Equations, Part};

/// A vector field v(y, p) with periodic orbits, written once for any number type.
pub trait VectorField {
    /// Components of y.
    fn components(&self) -> usize;

    /// Parameters p.
    fn parameters(&self) -> usize;

    /// Number of leading components with velocities that depend on the other components and on p only, see
    /// [`Dimensions::quadratures`].
    fn quadratures(&self) -> usize {
        0
    }

    /// v(y, p) into `v`, which is zero before.
    fn velocity<D: Number>(&self, y: &[D], p: &[D], v: &mut [D]);
}

/// A periodic orbit of y′ = v(y, p), with the period T scaled to 1: y′ = T v(y, p) on \[0, 1\].
///
/// Boundary conditions of this crate involve one end each. A common value c = y(0) = y(1) among the scalar unknowns makes
/// periodicity such a pair: y(0) − c = 0 and y(1) − c = 0. An orbit may be shifted in time; the phase condition
/// ∫ y · y₀′ dx = 0 selects the shift that is nearest to a reference orbit y₀, which in a continuation is the newest point. Scalar
/// unknowns are c, T and p, in this order.
/// With one parameter the problem lacks one condition, and [`Continuation`](crate::Continuation) follows the orbit in it. Without
/// parameters the problem is square, for [`solve`](crate::solve).
///
/// # Examples
/// The limit cycle of van der Pol's equation u″ − μ(1 − u²)u′ + u = 0, with the period 6.6632868593 at μ = 1:
///
/// ```
/// use furrow_bvp::{Continuation, Gauss, Metric, Number, PeriodicOrbit, VectorField, mesh};
/// use std::f64::consts::TAU;
///
/// #[derive(Clone)]
/// struct VanDerPol;
///
/// impl VectorField for VanDerPol {
///     fn components(&self) -> usize {
///         2
///     }
///     fn parameters(&self) -> usize {
///         1
///     }
///     fn velocity<D: Number>(&self, y: &[D], p: &[D], v: &mut [D]) {
///         v[0] = y[1];
///         v[1] = p[0] * (-y[0].powi(2) + 1.0) * y[1] - y[0];
///     }
/// }
///
/// // For μ → 0 the cycle is a circle of radius 2.
/// let circle = |x: f64, y: &mut [f64]| y.copy_from_slice(&[2.0 * (TAU * x).cos(), -2.0 * (TAU * x).sin()]);
/// let (gauss, grid) = (Gauss::new(4)?, mesh::uniform(0.0, 1.0, 30));
/// let (problem, guess) = PeriodicOrbit::near(VanDerPol, &gauss, &grid, TAU, &[0.1], circle)?;
/// let mut cycle = Continuation::start(problem, guess, Metric::unit(2, 4), Default::default(), true)?;
/// cycle.follow([0.0, 1.0], 100, |_, _| true)?;
/// let period = PeriodicOrbit::<VanDerPol>::period(&cycle.state.solution);
/// assert!((period - 6.6632868593).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct PeriodicOrbit<V> {
    field: V,
    /// The reference orbit y₀ on \[0, 1\].
    reference: Solution,
    gauss: Gauss,
}

/// The mean square of what changes along an orbit, of values that are 1 on average: less is an equilibrium but for rounding.
const STILL: f64 = 1e-14;

/// The mean square of values that count as 0.
const ZERO: f64 = 1e-4;

impl<V: VectorField> PeriodicOrbit<V> {
    /// The problem with a reference orbit given on \[0, 1\] as `orbit`, which writes y at x, and this orbit as a guess: with its
    /// period and the parameters p.
    ///
    /// # Errors
    /// [`InvalidInput`] if the mesh is invalid.
    pub fn near(
        field: V,
        gauss: &Gauss,
        mesh: &[f64],
        period: f64,
        parameters: &[f64],
        orbit: impl FnMut(f64, &mut [f64]),
    ) -> Result<(Auto<PeriodicOrbit<V>>, Solution), InvalidInput> {
        let reference = Solution::from_fn(gauss, mesh, field.components(), &[], orbit)?;
        let scalars = [reference.node(0), &[period], parameters].concat();
        let guess = Solution { scalars, ..reference.clone() };
        Ok((Auto(PeriodicOrbit { field, reference, gauss: gauss.clone() }), guess))
    }

    /// The vector field.
    pub fn field(&self) -> &V {
        &self.field
    }

    /// The period T of an orbit; NaN for a solution of another problem.
    pub fn period(orbit: &Solution) -> f64 {
        orbit.scalars.get(orbit.components).copied().unwrap_or(f64::NAN)
    }
}

impl<V: VectorField> Auto<PeriodicOrbit<V>> {
    /// How a disturbance at the left end of every interval of an orbit has changed at its right end: see [`System::transitions`].
    ///
    /// # Errors
    /// [`FactorisationError`] if the orbit has other sizes, or a stage matrix is singular.
    pub fn transitions(&mut self, orbit: &Solution) -> Result<Vec<Vec<f64>>, FactorisationError> {
        let mut system = System::new(self.dimensions(), orbit.m);
        system.evaluate(self, orbit, &[], true)?;
        system.condense()?;
        system.transitions()
    }

    /// The monodromy matrix of an orbit, n × n, row-major: how a disturbance at its start has changed after a period. Its eigenvalues,
    /// the Floquet multipliers, include 1. Where some disturbances have grown by 1e8 and more, rounding spoils the others; their
    /// multipliers follow from the [`transitions`](Self::transitions).
    ///
    /// # Errors
    /// As [`transitions`](Self::transitions).
    pub fn monodromy(&mut self, orbit: &Solution) -> Result<Vec<f64>, FactorisationError> {
        let n = self.0.field.components();
        let mut product: Vec<f64> = (0..n * n).map(|k| if k % (n + 1) == 0 { 1.0 } else { 0.0 }).collect();
        for transition in self.transitions(orbit)? {
            let mut next = vec![0.0; n * n];
            for (next, row) in next.chunks_exact_mut(n).zip(transition.chunks_exact(n)) {
                for (entry, from) in row.iter().zip(product.chunks_exact(n)) {
                    next.iter_mut().zip(from).for_each(|(next, from)| *next += entry * from);
                }
            }
            product = next;
        }
        Ok(product)
    }

    /// T ∫ div v dx over an orbit, the logarithm of the product of its Floquet multipliers (Liouville). In the plane one multiplier is 1,
    /// so that this is the logarithm of the other. NaN for a solution of another problem.
    pub fn divergence(&self, orbit: &Solution) -> f64 {
        let PeriodicOrbit { field, gauss, .. } = &self.0;
        let (n, np) = (field.components(), orbit.scalars.len());
        if orbit.m != gauss.m || orbit.components != n || np != n + 1 + field.parameters() {
            return f64::NAN;
        }
        let (mut f, mut by_y, mut by_p) = (vec![0.0; n], vec![0.0; n * n], vec![0.0; n * np]);
        let mut integral = 0.0;
        for (i, ends) in orbit.mesh.windows(2).enumerate() {
            for (j, weight) in gauss.b.iter().enumerate() {
                let (x, y) = (orbit.stage_x(gauss, i, j), orbit.stage(i, j));
                let outputs = [&mut f[..], &mut by_y, &mut by_p];
                self.local(x, y, &orbit.scalars).jacobian(Part::Rhs, y, &orbit.scalars, outputs);
                let trace: f64 = by_y.iter().step_by(n + 1).sum();
                integral += (ends[1] - ends[0]) * weight * trace;
            }
        }
        integral
    }

    /// The problem of orbits that take `times` times as long, and an orbit passed through so often, on as many copies of its mesh:
    /// where a period doubles, these orbits branch from it.
    pub fn repeated(&self, orbit: &Solution, times: usize) -> (Auto<PeriodicOrbit<V>>, Solution)
    where
        V: Clone,
    {
        let PeriodicOrbit { field, reference, gauss } = &self.0;
        let (count, n) = (times.max(1), orbit.components);
        let again = |y: &Solution| {
            let mut long = y.clone();
            long.mesh =
                (0..count).flat_map(|k| y.mesh.iter().skip(usize::from(k > 0)).map(move |x| x + k as f64)).collect();
            long.mesh.iter_mut().for_each(|x| *x /= count as f64);
            long.nodes = (0..count).flat_map(|k| y.nodes.iter().skip(if k > 0 { n } else { 0 })).copied().collect();
            long.stages = y.stages.repeat(count);
            long
        };
        let mut long = again(orbit);
        long.scalars.iter_mut().skip(n).take(1).for_each(|period| *period *= count as f64);
        (Auto(PeriodicOrbit { field: field.clone(), reference: again(reference), gauss: gauss.clone() }), long)
    }
}

impl<V: VectorField> Equations for PeriodicOrbit<V> {
    fn dimensions(&self) -> Dimensions {
        let n = self.field.components();
        let scalars = n + 1 + self.field.parameters();
        let quadratures = self.field.quadratures();
        Dimensions { components: n, quadratures, scalars, left: n, right: n, integrals: 1, ..Dimensions::default() }
    }

    fn accepted(&mut self, y: &Solution) {
        if y.fits(self.dimensions()).is_ok() && y.m == self.gauss.m {
            self.reference.clone_from(y);
        }
    }

    /// An equilibrium has any period. Beyond a Hopf point the orbits of the branch come back, shifted by half a period: then the product of
    /// what changes along the orbit and along its reference, which the phase condition holds it next to, is negative.
    fn is_degenerate(&self, y: &Solution) -> bool {
        if y.fits(self.dimensions()).is_err() || y.m != self.gauss.m {
            return false;
        }
        let mut at = vec![0.0; y.components];
        let mut means = vec![[0.0; 4]; y.components];
        for (i, ends) in y.mesh.windows(2).enumerate() {
            for (j, weight) in self.gauss.b.iter().enumerate() {
                self.reference.eval(&self.gauss, y.stage_x(&self.gauss, i, j), &mut at);
                for (mean, (y, before)) in means.iter_mut().zip(y.stage(i, j).iter().zip(&at)) {
                    let values = [*y, *before, y * before, y * y];
                    mean.iter_mut().zip(values).for_each(|(mean, value)| *mean += weight * (ends[1] - ends[0]) * value);
                }
            }
        }
        let common = means.iter().map(|[y, before, product, square]| (product - y * before) / (ZERO + square));
        common.sum::<f64>() < STILL
    }

    fn rhs<D: Number>(&self, _: f64, y: &[D], p: &[D], f: &mut [D]) {
        let n = y.len();
        self.field.velocity(y, &p[n + 1..], f);
        f.iter_mut().for_each(|f| *f *= p[n]);
    }

    fn integrands<D: Number>(&self, x: f64, y: &[D], _: &[D], g: &mut [D]) {
        let mut slope = [0.0; crate::MAX_UNKNOWNS];
        let i = self.reference.interval_of(x);
        let theta = (x - self.reference.mesh[i]) / (self.reference.mesh[i + 1] - self.reference.mesh[i]);
        self.reference.slope_in(&self.gauss, i, theta, &mut slope[..y.len()]);
        g[0] = y.iter().zip(&slope).map(|(y, slope)| *y * *slope).sum();
    }

    fn left<D: Number>(&self, y: &[D], p: &[D], r: &mut [D]) {
        r.iter_mut().zip(y.iter().zip(p)).for_each(|(r, (y, c))| *r = *y - *c);
    }

    fn right<D: Number>(&self, y: &[D], p: &[D], r: &mut [D]) {
        self.left(y, p, r);
    }
}
