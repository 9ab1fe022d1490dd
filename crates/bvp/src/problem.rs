//! The statement of a boundary-value problem.

/// Sizes of a boundary-value problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimensions {
    /// Components n of y.
    pub components: usize,
    /// The first `integrable` components have derivatives that depend on the other components and on p only (never on
    /// one another). They are integrated out of the stage equations, which makes a Newton step several times cheaper.
    /// Zero is always correct.
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

impl Dimensions {
    /// Conditions beyond those of the problem itself that a square system needs, e.g. one for pseudo-arclength.
    pub fn missing_conditions(&self) -> isize {
        (self.components + self.scalars) as isize - (self.left + self.right + self.integrals) as isize
    }
}

/// Where the right-hand side is evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CollocationPoint {
    /// Independent variable.
    pub x: f64,
    /// Running index interval · m + stage of the collocation point, for data tabulated at the stages.
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
pub trait BoundaryValueProblem {
    /// Sizes.
    fn dimensions(&self) -> Dimensions;

    /// Called once before every sweep over the mesh with the scalar unknowns of that sweep.
    fn prepare(&mut self, _p: &[f64]) {}

    /// f into `f` (length n) and the integrands into `g`.
    fn rhs(&self, at: CollocationPoint, y: &[f64], p: &[f64], f: &mut [f64], g: &mut [f64]);

    /// f, g and their derivatives.
    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>);

    /// Conditions at the left end.
    fn left(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>);

    /// Conditions at the right end.
    fn right(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>);

    /// The part h(p) of integral condition `k`, with ∂h/∂p added to `hp`.
    fn integral_offset(&self, _k: usize, _p: &[f64], _hp: &mut [f64]) -> f64 {
        0.0
    }
}
