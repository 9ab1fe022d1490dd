//! Problems of two closures, solved by one call.

use crate::auto::Jet;
use crate::newton::{Settings, SolveError, Solved};
use crate::problem::{CollocationPoints, PointJacobian};

use super::{TwoPoint, TwoPointJacobian, solve_two_point};

/// Closures of [`solve_bvp`].
struct Closures<F, G> {
    sizes: [usize; 2],
    rhs: F,
    conditions: G,
}

/// Jets of `values`; the three unknowns from `first` on are varied.
fn jets(values: &[f64], first: usize, offset: usize) -> Vec<Jet> {
    let varied = |k: usize, which: usize| if k + offset == first + which { 1.0 } else { 0.0 };
    let jet =
        |(k, v): (usize, &f64)| Jet { eps1: varied(k, 0), eps2: varied(k, 1), eps3: varied(k, 2), ..Jet::from(*v) };
    values.iter().enumerate().map(jet).collect()
}

/// The derivatives of a jet by the unknowns that are varied.
fn slopes(jet: &Jet) -> [f64; VARIED] {
    [jet.eps1, jet.eps2, jet.eps3]
}

/// Unknowns that one evaluation varies.
const VARIED: usize = 3;

impl<F, G> TwoPoint for Closures<F, G>
where
    F: Fn(f64, &[Jet], &[Jet], &mut [Jet]),
    G: Fn(&[Jet], &[Jet], &[Jet], &mut [Jet]),
{
    fn sizes(&self) -> [usize; 2] {
        self.sizes
    }

    fn rhs(&self, points: CollocationPoints<'_>, p: &[f64], f: &mut [f64]) {
        let [n, _] = self.sizes;
        let p: Vec<Jet> = p.iter().map(|p| Jet::from(*p)).collect();
        for ((x, y), f) in points.x.iter().zip(points.y.chunks_exact(n)).zip(f.chunks_exact_mut(n)) {
            let y: Vec<Jet> = y.iter().map(|y| Jet::from(*y)).collect();
            let mut out = vec![Jet::from(0.0); n];
            (self.rhs)(*x, &y, &p, &mut out);
            f.iter_mut().zip(&out).for_each(|(f, out)| *f = out.re);
        }
    }

    fn rhs_jacobian(&self, points: CollocationPoints<'_>, p: &[f64], out: &mut PointJacobian<'_>) {
        let [n, np] = self.sizes;
        for (i, (x, y)) in points.x.iter().zip(points.y.chunks_exact(n)).enumerate() {
            let out = out.at(i, n, np, 0);
            for first in (0..n + np).step_by(VARIED) {
                let mut f = vec![Jet::from(0.0); n];
                (self.rhs)(*x, &jets(y, first, 0), &jets(p, first, n), &mut f);
                for (row, jet) in f.iter().enumerate() {
                    out.f[row] = jet.re;
                    for (k, slope) in (first..n + np).zip(slopes(jet)) {
                        if k < n { out.fy[row * n + k] = slope } else { out.fp[row * np + k - n] = slope }
                    }
                }
            }
        }
    }

    fn conditions(&self, [left, right]: [&[f64]; 2], p: &[f64], out: TwoPointJacobian<'_>) {
        let [n, np] = self.sizes;
        for first in (0..2 * n + np).step_by(VARIED) {
            let mut r = vec![Jet::from(0.0); n + np];
            (self.conditions)(&jets(left, first, 0), &jets(right, first, n), &jets(p, first, 2 * n), &mut r);
            for (row, jet) in r.iter().enumerate() {
                out.r[row] = jet.re;
                for (k, slope) in (first..2 * n + np).zip(slopes(jet)) {
                    match k {
                        k if k < n => out.by_left[row * n + k] = slope,
                        k if k < 2 * n => out.by_right[row * n + k - n] = slope,
                        k => out.by_p[row * np + k - 2 * n] = slope,
                    }
                }
            }
        }
    }
}

/// Solves y′ = f(x, y, p) with conditions r(y(a), y(b), p) = 0, as many as there are components and scalar unknowns p. `rhs` takes x, y
/// and p and writes f, `conditions` takes y(a), y(b) and p and writes r. `guess` has a row of values at the nodes of `mesh` for every
/// component; `p` may be empty. Derivatives are exact. An implementation of
/// [`Equations`](crate::Equations) is faster, since it computes with plain numbers where no derivatives are needed.
///
/// # Examples
/// Bratu's problem u″ + eᵘ = 0 with u(0) = u(1) = 0:
///
/// ```
/// use furrow_bvp::{DualNum, Jet, Settings, solve_bvp};
///
/// let solved = solve_bvp(
///     |_, y: &[Jet], _, f: &mut [Jet]| { f[0] = y[1]; f[1] = -y[0].exp(); },
///     |ya, yb, _, r| { r[0] = ya[0]; r[1] = yb[0]; },
///     &[0.0, 0.25, 0.5, 0.75, 1.0], &[&[0.0; 5], &[0.0; 5]], &[], &Settings::default(),
/// )?;
/// assert!((solved.solution.node(0)[1] - 0.549352).abs() < 1e-6);
/// # Ok::<(), furrow_bvp::SolveError>(())
/// ```
///
/// # Errors
/// [`SolveError`].
pub fn solve_bvp(
    rhs: impl Fn(f64, &[Jet], &[Jet], &mut [Jet]),
    conditions: impl Fn(&[Jet], &[Jet], &[Jet], &mut [Jet]),
    mesh: &[f64],
    guess: &[&[f64]],
    p: &[f64],
    settings: &Settings,
) -> Result<Solved, SolveError> {
    solve_two_point(&Closures { sizes: [guess.len(), p.len()], rhs, conditions }, mesh, guess, p, settings)
}
