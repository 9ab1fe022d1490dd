//! Problems from closures.

use std::sync::Arc;

use crate::dimensions::Dimensions;

use super::numbers::{Jet, Number};
use super::{Auto, Equations};

/// A problem made of closures, with exact derivatives: no trait to implement.
///
/// Closures compute with [`Jet`]s. An implementation of [`Equations`] is cheaper, as it computes with plain numbers where no
/// derivatives are needed.
///
/// # Examples
/// u″ = 3/2 u² with u(0) = 4, u(1) = 1 is solved by 4/(1 + x)²:
///
/// ```
/// use furrow_bvp::{DualNum, Settings, SimpleProblem, Solution, mesh, solve};
///
/// let mut problem = SimpleProblem::new(2, |_x, y, _p, f| {
///     f[0] = y[1];
///     f[1] = y[0].powi(2) * 1.5;
/// })
/// .left_conditions(1, |y, _p, r| r[0] = y[0] - 4.0)
/// .right_conditions(1, |y, _p, r| r[0] = y[0] - 1.0);
/// let guess = Solution::constant(4, &mesh::uniform(0.0, 1.0, 4), &[2.0, 0.0], &[]);
/// let solved = solve(&mut problem, &guess, &Settings { tolerance: 1e-9, ..Settings::default() })?;
/// assert!((solved.solution.node(0)[1] + 8.0).abs() < 1e-6);
/// # Ok::<(), furrow_bvp::SolveError>(())
/// ```
///
/// The same with 4 as a scalar unknown, to be found from ∫u dx = 2:
///
/// ```
/// use furrow_bvp::{DualNum, Settings, SimpleProblem, Solution, mesh, solve};
///
/// let mut problem = SimpleProblem::new(2, |_x, y, _p, f| {
///     f[0] = y[1];
///     f[1] = y[0].powi(2) * 1.5;
/// })
/// .scalars(1)
/// .left_conditions(1, |y, p, r| r[0] = y[0] - p[0])
/// .right_conditions(1, |y, _p, r| r[0] = y[0] - 1.0)
/// .integrals(1, |_x, y, _p, g| g[0] = y[0])
/// .offsets(|_p, h| h[0] = (-2.0).into());
/// let guess = Solution::constant(4, &mesh::uniform(0.0, 1.0, 4), &[2.0, -3.0], &[3.0]);
/// let solved = solve(&mut problem, &guess, &Settings { tolerance: 1e-9, ..Settings::default() })?;
/// assert!((solved.solution.scalars[0] - 4.0).abs() < 1e-6);
/// # Ok::<(), furrow_bvp::SolveError>(())
/// ```
pub type SimpleProblem = Auto<Closures>;

/// x, y and p to f or g.
type AtPoint = Arc<dyn Fn(f64, &[Jet], &[Jet], &mut [Jet]) + Send + Sync>;

/// y and p to r.
type AtEnd = Arc<dyn Fn(&[Jet], &[Jet], &mut [Jet]) + Send + Sync>;

/// The equations of a [`SimpleProblem`].
#[derive(Clone)]
pub struct Closures {
    dimensions: Dimensions,
    rhs: AtPoint,
    integrands: AtPoint,
    left: AtEnd,
    right: AtEnd,
    /// Of p alone.
    offsets: AtEnd,
}

impl std::fmt::Debug for Closures {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Closures").field("dimensions", &self.dimensions).finish_non_exhaustive()
    }
}

impl SimpleProblem {
    /// y′ = f(x, y, p) for the given number of components, without scalar unknowns and conditions at first. `rhs` takes x, y and p and
    /// writes f.
    pub fn new(
        components: usize,
        rhs: impl Fn(f64, &[Jet], &[Jet], &mut [Jet]) + Send + Sync + 'static,
    ) -> SimpleProblem {
        Auto(Closures {
            dimensions: Dimensions { components, ..Dimensions::default() },
            rhs: Arc::new(rhs),
            integrands: Arc::new(|_, _, _, _| {}),
            left: Arc::new(|_, _, _| {}),
            right: Arc::new(|_, _, _| {}),
            offsets: Arc::new(|_, _, _| {}),
        })
    }

    /// Sets the number of scalar unknowns p.
    pub fn scalars(mut self, count: usize) -> SimpleProblem {
        self.0.dimensions.scalars = count;
        self
    }

    /// Sets the number of leading components with derivatives that depend on the other components and on p only, see
    /// [`Dimensions::quadratures`]. Newton's steps are then cheaper, and more components fit.
    pub fn quadratures(mut self, count: usize) -> SimpleProblem {
        self.0.dimensions.quadratures = count;
        self
    }

    /// Sets the number of conditions at the left end: `residuals` takes y there and p and writes the residuals.
    pub fn left_conditions(
        mut self,
        count: usize,
        residuals: impl Fn(&[Jet], &[Jet], &mut [Jet]) + Send + Sync + 'static,
    ) -> SimpleProblem {
        self.0.dimensions.left = count;
        self.0.left = Arc::new(residuals);
        self
    }

    /// Sets the number of conditions at the right end.
    pub fn right_conditions(
        mut self,
        count: usize,
        residuals: impl Fn(&[Jet], &[Jet], &mut [Jet]) + Send + Sync + 'static,
    ) -> SimpleProblem {
        self.0.dimensions.right = count;
        self.0.right = Arc::new(residuals);
        self
    }

    /// Sets the number of integral conditions ∫ g dx + h(p) = 0: `integrands` takes x, y and p and writes g.
    pub fn integrals(
        mut self,
        count: usize,
        integrands: impl Fn(f64, &[Jet], &[Jet], &mut [Jet]) + Send + Sync + 'static,
    ) -> SimpleProblem {
        self.0.dimensions.integrals = count;
        self.0.integrands = Arc::new(integrands);
        self
    }

    /// With the parts h(p) of the integral conditions, zero otherwise.
    pub fn offsets(mut self, offsets: impl Fn(&[Jet], &mut [Jet]) + Send + Sync + 'static) -> SimpleProblem {
        self.0.offsets = Arc::new(move |_, p, h| offsets(p, h));
        self
    }
}

/// Calls a closure of jets with other numbers.
fn with_jets<D: Number>(values: [&[D]; 2], out: &mut [D], call: impl FnOnce([&[Jet]; 2], &mut [Jet])) {
    let [y, p] = values.map(|values| super::numbers(values.len(), |k| values[k].to_jet()));
    let mut jets = [Jet::from(0.0); crate::MAX_UNKNOWNS];
    let jets = &mut jets[..out.len()];
    call([&y[..values[0].len()], &p[..values[1].len()]], jets);
    out.iter_mut().zip(jets.iter()).for_each(|(out, jet)| *out = D::from_jet(*jet));
}

impl Equations for Closures {
    fn dimensions(&self) -> Dimensions {
        self.dimensions
    }

    fn rhs<D: Number>(&self, x: f64, y: &[D], p: &[D], f: &mut [D]) {
        with_jets([y, p], f, |[y, p], f| (self.rhs)(x, y, p, f));
    }

    fn integrands<D: Number>(&self, x: f64, y: &[D], p: &[D], g: &mut [D]) {
        with_jets([y, p], g, |[y, p], g| (self.integrands)(x, y, p, g));
    }

    fn left<D: Number>(&self, y: &[D], p: &[D], r: &mut [D]) {
        with_jets([y, p], r, |[y, p], r| (self.left)(y, p, r));
    }

    fn right<D: Number>(&self, y: &[D], p: &[D], r: &mut [D]) {
        with_jets([y, p], r, |[y, p], r| (self.right)(y, p, r));
    }

    fn offsets<D: Number>(&self, p: &[D], h: &mut [D]) {
        with_jets([&[], p], h, |[y, p], h| (self.offsets)(y, p, h));
    }
}
