//! The statement of a boundary-value problem.

use crate::dimensions::Dimensions;
use crate::kernels::Kernels;
use crate::solution::Solution;

/// Where the right-hand side is evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CollocationPoint {
    /// Independent variable.
    pub x: f64,
    /// Running index interval · m + stage of the collocation point, for data tabulated at the stages. Between the stages, where
    /// defects are sampled, it is the index of a stage of the same interval.
    pub index: usize,
}

/// Right-hand side, integrands and their derivatives at one point; all row-major, zeroed before each call.
pub struct PointJacobian<'a> {
    /// f; length n.
    pub f: &'a mut [f64],
    /// ∂f/∂y; n × n.
    pub fy: &'a mut [f64],
    /// ∂f/∂p; n × scalars.
    pub fp: &'a mut [f64],
    /// Integrands g; length integrals.
    pub g: &'a mut [f64],
    /// ∂g/∂y; integrals × n.
    pub gy: &'a mut [f64],
    /// ∂g/∂p; integrals × scalars.
    pub gp: &'a mut [f64],
}

impl PointJacobian<'_> {
    /// Of arrays over many points the part of point i, for n components, `scalars` and `integrals`.
    #[inline(always)]
    pub fn at(&mut self, i: usize, n: usize, scalars: usize, integrals: usize) -> PointJacobian<'_> {
        PointJacobian {
            f: &mut self.f[i * n..(i + 1) * n],
            fy: &mut self.fy[i * n * n..(i + 1) * n * n],
            fp: &mut self.fp[i * n * scalars..(i + 1) * n * scalars],
            g: &mut self.g[i * integrals..(i + 1) * integrals],
            gy: &mut self.gy[i * integrals * n..(i + 1) * integrals * n],
            gp: &mut self.gp[i * integrals * scalars..(i + 1) * integrals * scalars],
        }
    }
}

/// Collocation points one behind the other.
#[derive(Clone, Copy, Debug)]
pub struct CollocationPoints<'a> {
    /// Running index of the first, see [`CollocationPoint::index`].
    pub first: usize,
    /// Independent variable at each.
    pub x: &'a [f64],
    /// Values at each; points × n.
    pub y: &'a [f64],
}

/// Conditions at one end and their derivatives; row-major, zeroed before each call.
pub struct BoundaryJacobian<'a> {
    /// Residuals.
    pub r: &'a mut [f64],
    /// ∂r/∂y; conditions × n.
    pub ry: &'a mut [f64],
    /// ∂r/∂p; conditions × scalars.
    pub rp: &'a mut [f64],
}

/// One of the two ends.
#[derive(Clone, Copy)]
pub(crate) enum End {
    Left,
    Right,
}

/// Residuals of the conditions at an end, and their derivatives by y and by p, row-major.
pub(crate) fn conditions_at<P: BoundaryValueProblem + ?Sized>(
    problem: &P,
    end: End,
    y: &[f64],
    p: &[f64],
) -> [Vec<f64>; 3] {
    let Dimensions { components: n, scalars: np, left, right, .. } = problem.dimensions();
    let count = match end {
        End::Left => left,
        End::Right => right,
    };
    let [mut r, mut ry, mut rp] = [1, n, np].map(|width| vec![0.0; count * width]);
    let out = &mut BoundaryJacobian { r: &mut r, ry: &mut ry, rp: &mut rp };
    match end {
        End::Left => problem.left(y, p, out),
        End::Right => problem.right(y, p, out),
    }
    [r, ry, rp]
}

/// y′ = f(x, y, p) with separated boundary conditions, integral conditions and scalar unknowns.
///
/// # Examples
/// Bratu's problem u″ + λeᵘ = 0, u(0) = u(1) = 0 with λ as a scalar unknown. It lacks one condition, for λ: see
/// [`Newton`](crate::Newton) and [`Continuation`](crate::Continuation).
///
/// ```
/// use furrow_bvp::{BoundaryJacobian, BoundaryValueProblem, CollocationPoint, Dimensions, PointJacobian};
///
/// struct Bratu;
///
/// impl BoundaryValueProblem for Bratu {
///     fn dimensions(&self) -> Dimensions {
///         // u′ depends on the other component alone: u is a quadrature.
///         Dimensions { components: 2, quadratures: 1, scalars: 1, left: 1, right: 1, ..Dimensions::default() }
///     }
///     fn rhs(&self, _: CollocationPoint, y: &[f64], p: &[f64], f: &mut [f64], _: &mut [f64]) {
///         f.copy_from_slice(&[y[1], -p[0] * y[0].exp()]);
///     }
///     fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
///         self.rhs(at, y, p, out.f, out.g);
///         out.fy.copy_from_slice(&[0.0, 1.0, -p[0] * y[0].exp(), 0.0]);
///         out.fp.copy_from_slice(&[0.0, -y[0].exp()]);
///     }
///     fn left(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
///         (out.r[0], out.ry[0]) = (y[0], 1.0);
///     }
///     fn right(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
///         (out.r[0], out.ry[0]) = (y[0], 1.0);
///     }
/// }
///
/// assert_eq!(Bratu.dimensions().missing_conditions(), 1);
/// assert!(Bratu.dimensions().check(4).is_ok());
/// ```
pub trait BoundaryValueProblem {
    /// Sizes.
    fn dimensions(&self) -> Dimensions;

    /// Called once before every sweep over the mesh with the scalar unknowns of that sweep.
    fn prepare(&mut self, _p: &[f64]) {}

    /// Called after [`prepare`](Self::prepare) with the collocation points of a sweep, where what depends on them alone can be
    /// computed and kept.
    fn prepare_points(&mut self, _x: &[f64], _p: &[f64]) {}

    /// Called with every point that a continuation accepts, for conditions that refer to a solution nearby. The point has to
    /// fulfil the conditions that follow.
    fn accepted(&mut self, _y: &Solution) {}

    /// Whether a solution that a continuation is about to accept has degenerated since the last one, as a cycle that has shrunk to an
    /// equilibrium. The branch ends before it.
    fn is_degenerate(&self, _y: &Solution) -> bool {
        false
    }

    /// f into `f` (length n) and the integrands into `g`.
    fn rhs(&self, at: CollocationPoint, y: &[f64], p: &[f64], f: &mut [f64], g: &mut [f64]);

    /// f, g and their derivatives.
    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>);

    /// [`rhs`](Self::rhs) at many points: f into `f` (points × n), the integrands into `g` (points × integrals). A problem may
    /// evaluate several points at once.
    fn rhs_many(&self, points: CollocationPoints<'_>, p: &[f64], f: &mut [f64], g: &mut [f64]) {
        let Dimensions { components: n, integrals: ni, .. } = self.dimensions();
        for (i, (&x, y)) in points.x.iter().zip(points.y.chunks_exact(n)).enumerate() {
            let at = CollocationPoint { x, index: points.first + i };
            self.rhs(at, y, p, &mut f[i * n..(i + 1) * n], &mut g[i * ni..(i + 1) * ni]);
        }
    }

    /// [`rhs_jacobian`](Self::rhs_jacobian) at many points, with the points one after another in each array.
    fn rhs_jacobian_many(&self, points: CollocationPoints<'_>, p: &[f64], out: &mut PointJacobian<'_>) {
        let Dimensions { components: n, scalars: np, integrals: ni, .. } = self.dimensions();
        for (i, (&x, y)) in points.x.iter().zip(points.y.chunks_exact(n)).enumerate() {
            let at = CollocationPoint { x, index: points.first + i };
            self.rhs_jacobian(at, y, p, &mut out.at(i, n, np, ni));
        }
    }

    /// Conditions at the left end.
    fn left(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>);

    /// Conditions at the right end.
    fn right(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>);

    /// The part h(p) of integral condition `k`, with ∂h/∂p added to `hp`.
    fn integral_offset(&self, _k: usize, _p: &[f64], _hp: &mut [f64]) -> f64 {
        0.0
    }

    /// The kernels a system with the given number of stages works with: [`Kernels::general`] will always do, and
    /// [`Kernels::sized`] for the sizes of this problem makes it faster with the same results. Few components need no request, see
    /// [`Kernels`].
    fn kernels(&self, _stages: usize) -> Kernels {
        Kernels::general()
    }
}
