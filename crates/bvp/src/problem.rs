//! The statement of a boundary-value problem.

use crate::dense::{LANE, MAX_LANES, lanes_for};
use crate::gauss::MAX_STAGES;
use crate::kernels::Kernels;

/// Sizes of a boundary-value problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimensions {
    /// Components n of y.
    pub components: usize,
    /// The first `integrable` components have derivatives that depend on the other components and on p only (never on
    /// one another). They are integrated out of the stage equations, which makes a Newton step several times cheaper.
    /// Zero is always correct; all of them may be.
    pub integrable: usize,
    /// Scalar unknowns p.
    pub scalars: usize,
    /// Conditions at the left end.
    pub left: usize,
    /// Conditions at the right end.
    pub right: usize,
    /// Integral conditions ∫ g dx + h(p) = 0.
    pub integrals: usize,
}

/// Most unknowns at one point, components and scalars together.
pub const MAX_UNKNOWNS: usize = 32;

/// Most unknowns at the stages of one interval, those of integrable components left out.
pub const MAX_STAGE_UNKNOWNS: usize = MAX_LANES * LANE;

/// Most linear conditions beside those of the problem.
pub const MAX_CONDITIONS: usize = 8;

/// Why a problem does not fit the kernels, which work on blocks of bounded size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TooLarge {
    /// A number of stages that is not offered.
    #[error("collocation is offered with 1 to {MAX_STAGES} stages, not {stages}")]
    Stages {
        /// Stages asked for.
        stages: usize,
    },
    /// No components, or more integrable ones than components.
    #[error("{integrable} of {components} components cannot be integrable")]
    Components {
        /// Components of y.
        components: usize,
        /// Those of them said to be integrable.
        integrable: usize,
    },
    /// More than [`MAX_UNKNOWNS`] components and scalar unknowns.
    #[error("{unknowns} components and scalar unknowns are more than {MAX_UNKNOWNS}")]
    Unknowns {
        /// Components and scalar unknowns.
        unknowns: usize,
    },
    /// The stage equations of an interval are wider than the kernels are built for.
    #[error(
        "{stage_unknowns} stage unknowns are more than {MAX_STAGE_UNKNOWNS}: fewer stages, or more integrable components"
    )]
    StageUnknowns {
        /// Stages times components that are not integrable.
        stage_unknowns: usize,
    },
    /// The problem has more conditions than unknowns, or lacks more than [`MAX_CONDITIONS`].
    #[error("{missing} further conditions would make the system square; possible are 0 to {MAX_CONDITIONS}")]
    Conditions {
        /// Unknowns less conditions.
        missing: isize,
    },
}

impl Dimensions {
    /// Conditions beyond those of the problem itself that a square system needs, e.g. one for pseudo-arclength.
    pub fn missing_conditions(&self) -> isize {
        (self.components + self.scalars) as isize - (self.left + self.right + self.integrals) as isize
    }

    /// Whether problems of these sizes can be solved with the given number of stages. This is the one place where limits
    /// are checked: [`System`](crate::System) and all that is built on it rely on it.
    ///
    /// # Errors
    /// [`TooLarge`] says which limit is exceeded.
    pub fn check(&self, stages: usize) -> Result<(), TooLarge> {
        let Dimensions { components, integrable, .. } = *self;
        if !(1..=MAX_STAGES).contains(&stages) {
            return Err(TooLarge::Stages { stages });
        }
        if components == 0 || integrable > components {
            return Err(TooLarge::Components { components, integrable });
        }
        let unknowns = components + self.scalars;
        if unknowns > MAX_UNKNOWNS {
            return Err(TooLarge::Unknowns { unknowns });
        }
        // Blocks of nodes are no wider: with as many conditions as unknowns they need no more than 2 · MAX_UNKNOWNS rows and
        // columns.
        let stage_unknowns = stages * (components - integrable);
        if stage_unknowns > MAX_STAGE_UNKNOWNS {
            return Err(TooLarge::StageUnknowns { stage_unknowns });
        }
        let missing = self.missing_conditions();
        if !(0..=MAX_CONDITIONS as isize).contains(&missing) {
            return Err(TooLarge::Conditions { missing });
        }
        Ok(())
    }
}

/// Rows of one block of nodes: conditions carried on, those of the interval and borders.
pub(crate) const MAX_ROWS: usize = 2 * MAX_UNKNOWNS;

/// Lanes that hold all unknowns of one point.
pub(crate) const MAX_UNKNOWN_LANES: usize = lanes_for(MAX_UNKNOWNS);

const _: () =
    assert!(MAX_ROWS <= MAX_LANES * LANE, "a row of a block of nodes has no more columns than it may have rows");

/// Where the right-hand side is evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CollocationPoint {
    /// Independent variable.
    pub x: f64,
    /// Running index interval · m + stage of the collocation point, for data tabulated at the stages. Where a defect is
    /// sampled, between the stages, it is that of the first stage of the interval.
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

/// y′ = f(x, y, p) with separated boundary conditions, integral conditions and scalar unknowns.
///
/// # Examples
/// Bratu's problem u″ + λeᵘ = 0, u(0) = u(1) = 0 with λ as a scalar unknown. It lacks one condition, for λ: see
/// [`Newton`](crate::Newton) and [`Continuation`](crate::Continuation).
///
/// ```
/// use bvp::{BoundaryJacobian, BoundaryValueProblem, CollocationPoint, Dimensions, PointJacobian};
///
/// struct Bratu;
///
/// impl BoundaryValueProblem for Bratu {
///     fn dimensions(&self) -> Dimensions {
///         // u′ depends on the other component alone: it is integrable.
///         Dimensions { components: 2, integrable: 1, scalars: 1, left: 1, right: 1, integrals: 0 }
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

    /// f into `f` (length n) and the integrands into `g`.
    fn rhs(&self, at: CollocationPoint, y: &[f64], p: &[f64], f: &mut [f64], g: &mut [f64]);

    /// f, g and their derivatives.
    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>);

    /// [`rhs`](Self::rhs) at many points: f into `f` (points × n), the integrands into `g` (points × integrals). A problem whose
    /// evaluation is worth it may run over them side by side.
    fn rhs_many(&self, points: CollocationPoints<'_>, p: &[f64], f: &mut [f64], g: &mut [f64]) {
        let Dimensions { components: n, integrals: ni, .. } = self.dimensions();
        for (i, (&x, y)) in points.x.iter().zip(points.y.chunks_exact(n)).enumerate() {
            let at = CollocationPoint { x, index: points.first + i };
            self.rhs(at, y, p, &mut f[i * n..(i + 1) * n], &mut g[i * ni..(i + 1) * ni]);
        }
    }

    /// [`rhs_jacobian`](Self::rhs_jacobian) at many points, each array holding that of one point behind that of another.
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
    /// [`Kernels::sized`] for the sizes of this problem makes it faster with the same results.
    fn kernels(&self, _stages: usize) -> Kernels {
        Kernels::general()
    }
}
