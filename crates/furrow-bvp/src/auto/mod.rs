//! Problems with derivatives by automatic differentiation: write the equations once, for any number type.
//!
//! | type | role |
//! |---|---|
//! | [`Equations`], [`Auto`] | the equations as a trait, and the problem made from them |
//! | [`SimpleProblem`] | the same from closures |
//! | [`VectorField`], [`PeriodicOrbit`] | periodic orbits of y′ = v(y, p) |

mod numbers;
mod periodic;
mod simple;

use num_dual::{Dual3_64, Dual64, HyperDual64};

use crate::dimensions::{Dimensions, MAX_UNKNOWNS};
use crate::kernels::Kernels;
use crate::problem::{
    BoundaryJacobian, BoundaryValueProblem, CollocationPoint, Directional, EndDerivatives, EndValues, MirrorSymmetric,
    PointDirection, PointJacobian, PointValues,
};
use crate::solution::Solution;

pub use num_dual::DualNum;
pub use numbers::{Jet, Number};
pub use periodic::{PeriodicOrbit, VectorField};
pub use simple::{Closures, SimpleProblem};

/// The equations of a boundary-value problem, written once for any number type. Outputs are zero before every call.
///
/// # Examples
/// A rod of length 1 that carries the load p = λ and is held by a spring at its left end: u″ + λ sin u = 0, u′(0) = u(0)³,
/// u(1) = 0.
///
/// ```
/// use furrow_bvp::{Dimensions, Equations, Number};
///
/// struct Rod;
///
/// impl Equations for Rod {
///     fn dimensions(&self) -> Dimensions {
///         Dimensions { components: 2, scalars: 1, left: 1, right: 1, ..Dimensions::default() }
///     }
///     fn rhs<D: Number>(&self, _: f64, y: &[D], p: &[D], f: &mut [D]) {
///         f[0] = y[1];
///         f[1] = -p[0] * y[0].sin();
///     }
///     fn left<D: Number>(&self, y: &[D], _: &[D], r: &mut [D]) {
///         r[0] = y[1] - y[0].powi(3);
///     }
///     fn right<D: Number>(&self, y: &[D], _: &[D], r: &mut [D]) {
///         r[0] = y[0];
///     }
/// }
/// ```
pub trait Equations {
    /// Sizes.
    fn dimensions(&self) -> Dimensions;

    /// f(x, y, p).
    fn rhs<D: Number>(&self, x: f64, y: &[D], p: &[D], f: &mut [D]);

    /// Integrands g(x, y, p).
    fn integrands<D: Number>(&self, _x: f64, _y: &[D], _p: &[D], _g: &mut [D]) {}

    /// Residuals of the conditions at the left end.
    fn left<D: Number>(&self, y: &[D], p: &[D], r: &mut [D]);

    /// Residuals of the conditions at the right end.
    fn right<D: Number>(&self, y: &[D], p: &[D], r: &mut [D]);

    /// The parts h(p) of the integral conditions.
    fn offsets<D: Number>(&self, _p: &[D], _h: &mut [D]) {}

    /// As [`BoundaryValueProblem::accepted`].
    fn accepted(&mut self, _y: &Solution) {}

    /// As [`BoundaryValueProblem::is_degenerate`].
    fn is_degenerate(&self, _y: &Solution) -> bool {
        false
    }

    /// As [`BoundaryValueProblem::kernels`].
    fn kernels(&self, _stages: usize) -> Kernels {
        Kernels::general()
    }
}

/// The problem of [`Equations`], with derivatives to third order exact to rounding: also of boundary conditions, which may be
/// nonlinear.
#[derive(Clone, Debug, Default)]
pub struct Auto<E>(pub E);

/// Numbers for all unknowns of one point.
type Numbers<D> = [D; MAX_UNKNOWNS];

/// `make` of every index below `count`, and zeros.
fn numbers<D: Number>(count: usize, make: impl Fn(usize) -> D) -> Numbers<D> {
    let mut out = [D::from(0.0); MAX_UNKNOWNS];
    out[..count].iter_mut().enumerate().for_each(|(k, v)| *v = make(k));
    out
}

/// Equations at one place as functions of all unknowns there.
struct Local<'a, E> {
    equations: &'a E,
    x: f64,
    /// Components and scalar unknowns.
    sizes: [usize; 2],
}

/// The equations to evaluate.
#[derive(Clone, Copy)]
enum Part {
    Rhs,
    Integrands,
    Left,
    Right,
    Offsets,
}

impl<E: Equations> Local<'_, E> {
    fn evaluate<D: Number>(&self, part: Part, y: &[D], p: &[D], out: &mut [D]) {
        out.fill(D::from(0.0));
        match part {
            Part::Rhs => self.equations.rhs(self.x, y, p, out),
            // Equations without them need not define them.
            _ if out.is_empty() => {}
            Part::Integrands => self.equations.integrands(self.x, y, p, out),
            Part::Left => self.equations.left(y, p, out),
            Part::Right => self.equations.right(y, p, out),
            Part::Offsets => self.equations.offsets(p, out),
        }
    }

    /// Values of `part` into `value` and derivatives, row-major, into `by_y` and `by_p`.
    fn jacobian(&self, part: Part, y: &[f64], p: &[f64], [value, by_y, by_p]: [&mut [f64]; 3]) {
        let [n, np] = self.sizes;
        let mut dual_y = numbers(n, |k| Dual64::from(y[k]));
        let mut dual_p = numbers(np, |k| Dual64::from(p[k]));
        let mut out = [Dual64::from(0.0); MAX_UNKNOWNS];
        let out = &mut out[..value.len()];
        // h(p) does not depend on y, and may be evaluated without y.
        let first = if matches!(part, Part::Offsets) { n } else { 0 };
        for k in first..n + np {
            let seeded = if k < n { &mut dual_y[k] } else { &mut dual_p[k - n] };
            seeded.eps = 1.0;
            self.evaluate(part, &dual_y[..n], &dual_p[..np], out);
            let (column, width, by) = if k < n { (k, n, &mut *by_y) } else { (k - n, np, &mut *by_p) };
            for (i, v) in out.iter().enumerate() {
                by[i * width + column] = v.eps;
            }
            let seeded = if k < n { &mut dual_y[k] } else { &mut dual_p[k - n] };
            seeded.eps = 0.0;
        }
        if first == n + np {
            self.evaluate(part, &dual_y[..n], &dual_p[..np], out);
        }
        value.iter_mut().zip(out.iter()).for_each(|(value, v)| *value = v.re);
    }

    /// Second derivatives of `part` along a and b.
    fn second(&self, part: Part, [y, p]: [&[f64]; 2], [a, b]: [PointDirection; 2], out: &mut [f64]) {
        let [n, np] = self.sizes;
        let y = numbers(n, |k| HyperDual64::new(y[k], a.y[k], b.y[k], 0.0));
        let p = numbers(np, |k| HyperDual64::new(p[k], a.p[k], b.p[k], 0.0));
        let mut values = [HyperDual64::from(0.0); MAX_UNKNOWNS];
        let values = &mut values[..out.len()];
        self.evaluate(part, &y[..n], &p[..np], values);
        out.iter_mut().zip(values.iter()).for_each(|(out, v)| *out = v.eps1eps2);
    }

    /// Second and third derivatives of `part` along a.
    fn third(&self, part: Part, [y, p]: [&[f64]; 2], a: PointDirection, [second, third]: [&mut [f64]; 2]) {
        let [n, np] = self.sizes;
        let y = numbers(n, |k| Dual3_64::new(y[k], a.y[k], 0.0, 0.0));
        let p = numbers(np, |k| Dual3_64::new(p[k], a.p[k], 0.0, 0.0));
        let mut values = [Dual3_64::from(0.0); MAX_UNKNOWNS];
        let values = &mut values[..third.len()];
        self.evaluate(part, &y[..n], &p[..np], values);
        second.iter_mut().zip(values.iter()).for_each(|(out, v)| *out = v.v2);
        third.iter_mut().zip(values.iter()).for_each(|(out, v)| *out = v.v3);
    }
}

impl<E: Equations> Auto<E> {
    fn local(&self, x: f64, y: &[f64], p: &[f64]) -> Local<'_, E> {
        Local { equations: &self.0, x, sizes: [y.len(), p.len()] }
    }
}

impl<E: Equations> BoundaryValueProblem for Auto<E> {
    fn dimensions(&self) -> Dimensions {
        self.0.dimensions()
    }

    fn accepted(&mut self, y: &Solution) {
        self.0.accepted(y);
    }

    fn is_degenerate(&self, y: &Solution) -> bool {
        self.0.is_degenerate(y)
    }

    fn rhs(&self, at: CollocationPoint, y: &[f64], p: &[f64], f: &mut [f64], g: &mut [f64]) {
        let local = self.local(at.x, y, p);
        local.evaluate(Part::Rhs, y, p, f);
        local.evaluate(Part::Integrands, y, p, g);
    }

    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        let local = self.local(at.x, y, p);
        local.jacobian(Part::Rhs, y, p, [out.f, out.fy, out.fp]);
        if !out.g.is_empty() {
            local.jacobian(Part::Integrands, y, p, [out.g, out.gy, out.gp]);
        }
    }

    fn left(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        self.local(0.0, y, p).jacobian(Part::Left, y, p, [out.r, out.ry, out.rp]);
    }

    fn right(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        self.local(0.0, y, p).jacobian(Part::Right, y, p, [out.r, out.ry, out.rp]);
    }

    fn integral_offset(&self, k: usize, p: &[f64], hp: &mut [f64]) -> f64 {
        let integrals = self.0.dimensions().integrals;
        let (mut h, mut by_p) = ([0.0; MAX_UNKNOWNS], vec![0.0; integrals * p.len()]);
        self.local(0.0, &[], p).jacobian(Part::Offsets, &[], p, [&mut h[..integrals], &mut [], &mut by_p]);
        hp.iter_mut().zip(&by_p[k * p.len()..]).for_each(|(hp, by_p)| *hp += by_p);
        h[k]
    }

    fn kernels(&self, stages: usize) -> Kernels {
        self.0.kernels(stages)
    }
}

impl<E: Equations> Directional for Auto<E> {
    fn second(&self, PointValues { at, y, p }: PointValues, along: [PointDirection; 2], [f, g]: [&mut [f64]; 2]) {
        let local = self.local(at.x, y, p);
        local.second(Part::Rhs, [y, p], along, f);
        local.second(Part::Integrands, [y, p], along, g);
    }

    fn third(&self, point: PointValues, along: PointDirection, [[f2, g2], [f3, g3]]: [[&mut [f64]; 2]; 2]) -> bool {
        let PointValues { at, y, p } = point;
        let local = self.local(at.x, y, p);
        local.third(Part::Rhs, [y, p], along, [f2, f3]);
        local.third(Part::Integrands, [y, p], along, [g2, g3]);
        true
    }

    fn second_at_ends(&mut self, at: EndValues, [a, b]: [EndValues; 2], out: EndDerivatives<'_>) {
        let local = self.local(0.0, at.left, at.p);
        let along = |y: fn(EndValues<'_>) -> &[f64]| [a, b].map(|d| PointDirection { y: y(d), p: d.p });
        local.second(Part::Left, [at.left, at.p], along(|d| d.left), out.left);
        local.second(Part::Right, [at.right, at.p], along(|d| d.right), out.right);
        local.second(Part::Offsets, [at.left, at.p], along(|d| d.left), out.offsets);
    }

    fn third_at_ends(&mut self, at: EndValues, a: EndValues, out: EndDerivatives<'_>) {
        let local = self.local(0.0, at.left, at.p);
        let [left, right] = [a.left, a.right].map(|y| PointDirection { y, p: a.p });
        local.third(Part::Left, [at.left, at.p], left, [&mut [], out.left]);
        local.third(Part::Right, [at.right, at.p], right, [&mut [], out.right]);
        local.third(Part::Offsets, [at.left, at.p], left, [&mut [], out.offsets]);
    }
}

impl<E: MirrorSymmetric> MirrorSymmetric for Auto<E> {
    fn vanishing_at_mirror(&self) -> &[usize] {
        self.0.vanishing_at_mirror()
    }

    fn free_at_mirror(&self) -> &[usize] {
        self.0.free_at_mirror()
    }
}
