//! Boundary-value problems the tests are made of.

use std::cell::Cell;
use std::ops::Range;

use super::Random;
use super::second_order::SecondOrder;
use crate::{
    BoundaryJacobian, BoundaryValueProblem, CollocationPoint, Dimensions, Kernels, LinearCondition, Newton,
    PointJacobian, Solution, System,
};

/// A quadratic polynomial in (y, p) with coefficients linear in x. Central differences of it are exact for every step,
/// so that a dense Jacobian without truncation error is at hand.
struct Form {
    constant: f64,
    linear: Vec<f64>,
    slope: Vec<f64>,
    factors: (usize, usize),
    weight: f64,
}

impl Form {
    /// Random coefficients for the unknowns from `first` to `end`, zero for the others.
    fn new(random: &mut Random, first: usize, end: usize, unknowns: usize) -> Form {
        let mut coefficients =
            || (0..unknowns).map(|k| if (first..end).contains(&k) { random.next() } else { 0.0 }).collect::<Vec<_>>();
        let (linear, slope) = (coefficients(), coefficients());
        if first == end {
            return Form { constant: random.next(), linear, slope, factors: (0, 0), weight: 0.0 };
        }
        let factors = (first + random.index(end - first), first + random.index(end - first));
        Form { constant: random.next(), linear, slope, factors, weight: random.next() }
    }

    fn value(&self, x: f64, u: &[f64]) -> f64 {
        let linear: f64 = (0..u.len()).map(|k| (self.linear[k] + x * self.slope[k]) * u[k]).sum();
        self.constant + linear + self.weight * u[self.factors.0] * u[self.factors.1]
    }

    fn gradient(&self, x: f64, u: &[f64], dy: &mut [f64], dp: &mut [f64]) {
        let mut gradient: Vec<f64> = (0..u.len()).map(|k| self.linear[k] + x * self.slope[k]).collect();
        gradient[self.factors.0] += self.weight * u[self.factors.1];
        gradient[self.factors.1] += self.weight * u[self.factors.0];
        dy.copy_from_slice(&gradient[..dy.len()]);
        dp.copy_from_slice(&gradient[dy.len()..]);
    }
}

/// A random problem of given sizes in which every equation is a [`Form`].
pub struct Quadratic {
    pub dims: Dimensions,
    /// Asks for kernels of the sizes in [`kernels`](BoundaryValueProblem::kernels).
    pub sized: bool,
    f: Vec<Form>,
    g: Vec<Form>,
    left: Vec<Form>,
    right: Vec<Form>,
    offset: Vec<Form>,
}

impl Quadratic {
    pub fn new(dims: Dimensions, random: &mut Random) -> Quadratic {
        let (n, all) = (dims.components, dims.components + dims.scalars);
        let mut forms = |count: usize, range: &dyn Fn(usize) -> Range<usize>| -> Vec<Form> {
            (0..count).map(|k| Form::new(random, range(k).start, range(k).end, all)).collect()
        };
        // Quadratures depend on the other components, and on the scalars that follow them.
        let others = dims.quadratures..if dims.trailing_quadratures > 0 { n - dims.trailing_quadratures } else { all };
        let is_quadrature = |k: usize| k < dims.quadratures || k >= n - dims.trailing_quadratures;
        Quadratic {
            dims,
            sized: true,
            f: forms(n, &|k| if is_quadrature(k) { others.clone() } else { 0..all }),
            g: forms(dims.integrals, &|_| 0..all),
            left: forms(dims.left, &|_| 0..all),
            right: forms(dims.right, &|_| 0..all),
            offset: forms(dims.integrals, &|_| n..all),
        }
    }

    fn end(forms: &[Form], y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        let (n, np, u) = (y.len(), p.len(), [y, p].concat());
        for (k, form) in forms.iter().enumerate() {
            out.r[k] = form.value(0.0, &u);
            form.gradient(0.0, &u, &mut out.ry[k * n..(k + 1) * n], &mut out.rp[k * np..(k + 1) * np]);
        }
    }
}

impl BoundaryValueProblem for Quadratic {
    fn dimensions(&self) -> Dimensions {
        self.dims
    }

    fn rhs(&self, at: CollocationPoint, y: &[f64], p: &[f64], f: &mut [f64], g: &mut [f64]) {
        let u = [y, p].concat();
        for (form, out) in self.f.iter().chain(&self.g).zip(f.iter_mut().chain(g)) {
            *out = form.value(at.x, &u);
        }
    }

    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        let (n, np, u) = (y.len(), p.len(), [y, p].concat());
        self.rhs(at, y, p, out.f, out.g);
        for (k, form) in self.f.iter().enumerate() {
            form.gradient(at.x, &u, &mut out.fy[k * n..(k + 1) * n], &mut out.fp[k * np..(k + 1) * np]);
        }
        for (k, form) in self.g.iter().enumerate() {
            form.gradient(at.x, &u, &mut out.gy[k * n..(k + 1) * n], &mut out.gp[k * np..(k + 1) * np]);
        }
    }

    fn left(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        Quadratic::end(&self.left, y, p, out);
    }

    fn right(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        Quadratic::end(&self.right, y, p, out);
    }

    fn integral_offset(&self, k: usize, p: &[f64], hp: &mut [f64]) -> f64 {
        let n = self.dims.components;
        let u = [&vec![0.0; n], p].concat();
        self.offset[k].gradient(0.0, &u, &mut vec![0.0; n], hp);
        self.offset[k].value(0.0, &u)
    }

    fn kernels(&self, stages: usize) -> Kernels {
        match (self.dims.components, stages, self.dims.scalars) {
            _ if !self.sized => Kernels::general(),
            (9, 3, 2) => Kernels::sized::<9, 4, 1, 3, 5, 2, 1>(),
            (9, 4, 2) => Kernels::sized::<9, 4, 1, 4, 5, 2, 1>(),
            (9, 4, 5) => Kernels::sized::<9, 4, 1, 4, 5, 5, 1>(),
            (7, 3, 2) => Kernels::sized::<7, 3, 0, 3, 4, 2, 1>(),
            (7, 4, 2) => Kernels::sized::<7, 3, 0, 4, 4, 2, 1>(),
            (7, 4, 3) => Kernels::sized::<7, 3, 0, 4, 4, 3, 1>(),
            (7, 4, 5) => Kernels::sized::<7, 3, 0, 4, 4, 5, 1>(),
            _ => Kernels::general(),
        }
    }
}

/// y″ = 3/2 y², y(0) = 4, y(1) = 1; one solution is 4/(1 + x)².
pub fn quadratic() -> SecondOrder {
    SecondOrder { force: Box::new(|_, [y, _]| [1.5 * y * y, 3.0 * y, 0.0]), ends: [4.0, 1.0] }
}

/// y″ = −λ eʸ, y = 0 at both ends. It has solutions for λ up to 3.5138 only.
pub fn bratu(lambda: f64) -> SecondOrder {
    let force = move |_: f64, [y, _]: [f64; 2]| [-lambda * y.exp(), -lambda * y.exp(), 0.0];
    SecondOrder { force: Box::new(force), ends: [0.0, 0.0] }
}

/// ε y″ = a y + b y y′ + c y′ with (a, b, c) in `terms`.
pub fn layer(epsilon: f64, [a, b, c]: [f64; 3], ends: [f64; 2]) -> SecondOrder {
    let force = move |_: f64, [y, slope]: [f64; 2]| {
        [a * y + b * y * slope + c * slope, a + b * slope, b * y + c].map(|term| term / epsilon)
    };
    SecondOrder { force: Box::new(force), ends }
}

/// y′ = rate · y with one nonlinear condition on y at the left end: one equation for one number, with known Newton iterates.
pub struct Initial {
    pub rate: f64,
    /// The condition and its derivative.
    pub condition: fn(f64) -> (f64, f64),
}

impl BoundaryValueProblem for Initial {
    fn dimensions(&self) -> Dimensions {
        Dimensions { components: 1, left: 1, ..Dimensions::default() }
    }

    fn rhs(&self, _: CollocationPoint, y: &[f64], _: &[f64], f: &mut [f64], _: &mut [f64]) {
        f[0] = self.rate * y[0];
    }

    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        self.rhs(at, y, p, out.f, out.g);
        out.fy[0] = self.rate;
    }

    fn left(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
        (out.r[0], out.ry[0]) = (self.condition)(y[0]);
    }

    fn right(&self, _: &[f64], _: &[f64], _: &mut BoundaryJacobian<'_>) {}
}

/// y′ = p y², y(0) = 1, ∫₀¹ y dx = 2 ln 2: the solution is 1/(1 − p x) with p = 1/2.
pub struct Growth;

impl BoundaryValueProblem for Growth {
    fn dimensions(&self) -> Dimensions {
        Dimensions { components: 1, scalars: 1, left: 1, integrals: 1, ..Dimensions::default() }
    }

    fn rhs(&self, _: CollocationPoint, y: &[f64], p: &[f64], f: &mut [f64], g: &mut [f64]) {
        f[0] = p[0] * y[0] * y[0];
        g[0] = y[0];
    }

    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        self.rhs(at, y, p, out.f, out.g);
        out.fy[0] = 2.0 * p[0] * y[0];
        out.fp[0] = y[0] * y[0];
        out.gy[0] = 1.0;
    }

    fn left(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
        out.r[0] = y[0] - 1.0;
        out.ry[0] = 1.0;
    }

    fn right(&self, _: &[f64], _: &[f64], _: &mut BoundaryJacobian<'_>) {}

    fn integral_offset(&self, _: usize, _: &[f64], _: &mut [f64]) -> f64 {
        -2.0 * std::f64::consts::LN_2
    }
}

/// A problem that counts its sweeps over the mesh, and the points at which derivatives were asked for.
pub struct Counted<P> {
    pub inner: P,
    pub sweeps: usize,
    pub derivatives: Cell<usize>,
}

impl<P> Counted<P> {
    pub fn new(inner: P) -> Counted<P> {
        Counted { inner, sweeps: 0, derivatives: Cell::new(0) }
    }
}

impl<P: BoundaryValueProblem> BoundaryValueProblem for Counted<P> {
    fn dimensions(&self) -> Dimensions {
        self.inner.dimensions()
    }

    fn prepare(&mut self, p: &[f64]) {
        self.sweeps += 1;
        self.inner.prepare(p);
    }

    fn rhs(&self, at: CollocationPoint, y: &[f64], p: &[f64], f: &mut [f64], g: &mut [f64]) {
        self.inner.rhs(at, y, p, f, g);
    }

    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        self.derivatives.set(self.derivatives.get() + 1);
        self.inner.rhs_jacobian(at, y, p, out);
    }

    fn left(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        self.inner.left(y, p, out);
    }

    fn right(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        self.inner.right(y, p, out);
    }
}

/// Random values on a mesh.
pub fn random_solution(dims: Dimensions, m: usize, mesh: Vec<f64>, random: &mut Random) -> Solution {
    let n = dims.components;
    Solution {
        components: n,
        m,
        nodes: random.vector(mesh.len() * n),
        stages: random.vector((mesh.len() - 1) * m * n),
        scalars: random.vector(dims.scalars),
        mesh,
    }
}

/// As many random linear conditions as the problem lacks.
pub fn random_conditions(dims: Dimensions, intervals: usize, random: &mut Random) -> Vec<LinearCondition> {
    (0..dims.missing_conditions())
        .map(|_| LinearCondition {
            nodes: random.vector((intervals + 1) * dims.components),
            scalars: random.vector(dims.scalars),
            value: random.next(),
        })
        .collect()
}

/// The workspace with the factors of `problem` at `y`.
pub fn factored<P: BoundaryValueProblem>(problem: &mut P, y: &Solution, conditions: &[LinearCondition]) -> System {
    let mut system = System::new(problem.dimensions(), y.m);
    system.factorise(problem, y, conditions).unwrap();
    system
}

/// Solves from `y` until only rounding is left: a second call takes one more Newton step from within the tolerance.
pub fn solve_fully<P: BoundaryValueProblem>(problem: &mut P, y: &mut Solution) {
    let mut system = System::new(problem.dimensions(), y.m);
    for _ in 0..2 {
        Newton::default().solve(&mut system, &mut Default::default(), problem, y, &[], false).unwrap();
    }
}

/// The solution of a second-order problem on a mesh, from the straight line between its ends.
pub fn solved(problem: &mut SecondOrder, m: usize, mesh: &[f64]) -> Solution {
    let mut y = problem.line(m, mesh);
    solve_fully(problem, &mut y);
    y
}
