//! The boundary-value problem of one cell: a stationary shape, or one implicit time step.

use std::f64::consts::PI;

use furrow_bvp::{
    BoundaryJacobian, BoundaryValueProblem, CollocationPoint, CollocationPoints, Dimensions, Kernels, PointJacobian,
};
use num_dual::Dual64;

use super::coefficients::CoefficientCache;
use super::columns::Column;
use super::equations::{
    BdfTerm, COMPONENTS, Carried, Constants, Domain, J, LENGTH, LocalCoefficients, M, PHI, PSI, Q, R, REGULATED, T, V,
};
use super::lanes::sin_cos;
use super::own;
use super::sweep::{self, Sweep};
use super::symmetry::{CENTRE, odd};
use furrow_cell::cue::{Term, Width};
use furrow_cell::{Cell, Parameter};

/// The first three components, r, z and m, are quadratures, see [`Dimensions::quadratures`]; so is φ, which comes last.
pub(crate) const QUADRATURES: usize = 3;

/// Quadratures with a regulator.
const ALL_QUADRATURES: usize = QUADRATURES + 1;

/// Conditions at the pole u = 0, and the same number at the other end; a regulator adds one at each.
const LEFT: usize = 4;

/// Number of scalar unknowns before the free parameters: L and p.
pub(crate) const SHAPE_SCALARS: usize = 2;

/// The boundary-value problem of one cell: stationary (`rate` = 0) or one implicit time step.
///
/// # Examples
/// ```
/// use furrow_bvp::BoundaryValueProblem;
/// use furrow_cell::{Cell, Parameter};
/// use furrow_mechanics::cortex::{Cortex, Domain};
/// // The stationary shapes of a half cell, with ξ_s free: one condition short, and so a curve.
/// let cortex = Cortex::new(&Cell::new(2.0), Domain::Half, &[Parameter::XiS]);
/// assert_eq!(cortex.dimensions().missing_conditions(), 1);
/// assert_eq!(cortex.get(Parameter::XiS), 25.0);
/// ```
#[derive(Clone, Debug)]
pub struct Cortex {
    /// The cell.
    pub cell: Cell,
    /// Part of the contour.
    pub domain: Domain,
    /// Parameters that are scalar unknowns, in the order they follow (L, p).
    pub free: Vec<Parameter>,
    /// 1/Δt of the implicit step; 0 for stationary shapes.
    pub rate: f64,
    /// Past (r, z) at every collocation point; may be empty if `rate` = 0.
    pub past: Vec<[f64; 2]>,
    /// The past of a regulator at every collocation point; may be empty if `rate` = 0 or without a regulator.
    pub carried_past: Vec<Carried>,
    /// Factor on the activity at every collocation point; empty if it is 1 everywhere.
    pub noise: Vec<f64>,
    /// Whether a linear condition on the amount of a conserved regulator replaces j = 0 at the far end, which at rest
    /// follows from j = 0 at the near end.
    pub(crate) amount_is_given: bool,
    constants: Constants<f64>,
    /// The constants with their derivatives by each free parameter.
    sensitivities: Vec<Constants<Dual64>>,
    /// The constants with derivatives, if the length of the contour enters through the cue's widths.
    along_length: Option<Constants<Dual64>>,
    /// Cached coefficients at the points of the last prepared sweep, if they are not uniform.
    coefficients: CoefficientCache,
}

impl Cortex {
    /// The stationary problem.
    pub fn new(cell: &Cell, domain: Domain, free: &[Parameter]) -> Cortex {
        let mut cortex = Cortex {
            cell: cell.clone(),
            domain,
            free: free.to_vec(),
            rate: 0.0,
            past: Vec::new(),
            carried_past: Vec::new(),
            noise: Vec::new(),
            amount_is_given: false,
            constants: Constants::new(cell, |_, v| v),
            sensitivities: Vec::new(),
            along_length: None,
            coefficients: CoefficientCache::default(),
        };
        cortex.refresh();
        cortex
    }

    /// Sizes for a cell and a number of free parameters; the same on both domains.
    pub fn dimensions_for(cell: &Cell, free: usize) -> Dimensions {
        let regulator = usize::from(cell.cue.regulator().is_some());
        Dimensions {
            components: COMPONENTS + 2 * regulator,
            quadratures: QUADRATURES,
            trailing_quadratures: regulator,
            scalars: SHAPE_SCALARS + free,
            left: LEFT + regulator,
            right: LEFT + regulator,
            integrals: 1,
        }
    }

    /// Whether the cell has a regulator, which adds two components.
    pub fn is_regulated(&self) -> bool {
        self.cell.cue.regulator().is_some()
    }

    /// Whether the amount of a regulator, ∫ c dA, is conserved.
    pub(crate) fn conserves_regulator(&self) -> bool {
        self.cell.cue.regulator().is_some_and(|regulator| regulator.diluted && regulator.turnover == 0.0)
    }

    /// Components of y: seven, or nine with a regulator.
    pub fn components(&self) -> usize {
        if self.is_regulated() { REGULATED } else { COMPONENTS }
    }

    /// Constants at the current parameters.
    pub fn constants(&self) -> &Constants<f64> {
        &self.constants
    }

    /// An empty cache of coefficients, for other places than the collocation points.
    pub(super) fn coefficient_cache(&self) -> CoefficientCache {
        self.coefficients.for_others()
    }

    /// Changes one parameter.
    pub fn set(&mut self, parameter: Parameter, value: f64) {
        parameter.set(&mut self.cell, value);
        self.refresh();
    }

    /// Current value of a parameter.
    pub fn get(&self, parameter: Parameter) -> f64 {
        parameter.get(&self.cell)
    }

    /// Recomputes the constants after `cell` was changed directly.
    pub fn refresh(&mut self) {
        let before = std::mem::replace(&mut self.constants, Constants::new(&self.cell, |_, v| v));
        let with_slope =
            |which: &Parameter| Constants::new(&self.cell, |p, v| Dual64::new(v, if p == *which { 1.0 } else { 0.0 }));
        self.sensitivities = self.free.iter().map(with_slope).collect();
        // A term with amplitude 0 must have no effect, not even on rounding.
        let by_length = |term: &Term| term.amplitude != 0.0 && matches!(term.profile.width(), Some(Width::Length(_)));
        let sourced =
            matches!(self.constants.source().and_then(|source| source.profile.width()), Some(Width::Length(_)));
        let by_length = sourced || self.cell.cue.terms().iter().any(by_length);
        // A cell with its own law or shell has no hand-written derivatives by the length.
        let by_any = by_length || self.constants.is_own();
        self.along_length = by_any.then(|| Constants::new(&self.cell, |_, v| Dual64::from_re(v)));
        if (&before.cue, before.source()) != (&self.constants.cue, self.constants.source()) {
            self.coefficients = CoefficientCache::default();
        }
        self.coefficients.refresh(by_length);
    }

    /// Whether the coefficients are uniform and stay so when the free parameters change. Here too a term with amplitude
    /// 0 has no effect.
    pub(super) fn is_uniform(&self) -> bool {
        let cue = &self.cell.cue;
        let varies = self.free.iter().any(|free| free.is_of_cue()) || cue.regulator().is_some();
        !varies && cue.terms().iter().all(|term| term.amplitude == 0.0)
    }

    fn sweep<'a>(&'a self, local: &'a [LocalCoefficients<f64>], profiles: &'a [[f64; 2]]) -> Sweep<'a> {
        let Cortex { constants, rate, past, carried_past, noise, free, .. } = self;
        Sweep {
            constants,
            rate: *rate,
            past,
            carried_past,
            noise,
            local,
            profiles,
            scalars: SHAPE_SCALARS + free.len(),
        }
    }

    /// The scalar unknowns that enter through the coefficients: L, if the cue's widths depend on it, and the free
    /// parameters.
    fn columns(&self, length: f64) -> impl Iterator<Item = Column<'_>> {
        let along_length = self.along_length.iter().map(move |constants| Column {
            scalar: LENGTH,
            constants,
            length: Dual64::new(length, 1.0),
            paints: true,
        });
        let of_parameter = move |(k, (constants, free)): (usize, (_, &Parameter))| Column {
            scalar: SHAPE_SCALARS + k,
            constants,
            length: length.into(),
            paints: free.is_of_cue(),
        };
        along_length.chain(self.sensitivities.iter().zip(&self.free).enumerate().map(of_parameter))
    }

    /// The rates of change at a collocation point.
    pub(crate) fn motion(&self, at: CollocationPoint) -> BdfTerm {
        if self.rate == 0.0 {
            return BdfTerm::default();
        }
        let [r_past, z_past] = self.past[at.index];
        let carried_past = self.carried_past.get(at.index).copied().unwrap_or_default();
        BdfTerm { rate: self.rate, r_past, z_past, carried_past }
    }

    /// [`of_state`](Constants::of_state) at a collocation point.
    pub(crate) fn coefficients_at(&self, at: CollocationPoint, y: &[f64], length: f64) -> LocalCoefficients<f64> {
        self.constants.in_state(self.coefficients.at(&self.constants, at, length), y, length)
    }

    /// The derivatives of the right-hand sides at one point, with state `y` and contour length `length`, by the motion
    /// of the cortex; the equations are linear in the motion.
    pub fn response_to_motion(&self, at: CollocationPoint, y: &[f64], length: f64) -> MotionResponse {
        let here = self.coefficients_at(at, y, length);
        let (sin, cos) = sin_cos(y[PSI]);
        let c2 = sin / y[R];
        let c1 = here.mean(y[M]) - c2;
        let d_s_u = -here.eta_difference * c2 / here.eta_sum;
        let d_t_phi = here.eta_difference * d_s_u + here.eta_sum * c2;
        let drag = length * self.constants.shell.normal_friction;
        let normal = [length * c2 * d_t_phi + drag, length * (d_s_u - c1), length * cos / y[R] * d_t_phi];
        let (normal, d_s_u) = match self.constants.law.as_ref().filter(|law| law.viscous || law.bends) {
            Some(law) => own::points::response(&self.constants, law, at.x, self.motion(at), y, length),
            None => (normal, d_s_u),
        };
        let mut response = MotionResponse { normal, ..MotionResponse::default() };
        if let Some(regulator) = self.constants.regulator.as_ref().filter(|_| y.len() == REGULATED) {
            let per = length / regulator.diffusion;
            let dilution = if regulator.diluted { 1.0 + y[PHI] } else { 0.0 };
            response.strain = per * dilution * d_s_u;
            response.carried = [per * dilution * (d_s_u + c2), per];
        }
        response
    }

    /// The decrease of j′ at a point of state `y` with a change of the past of (r, z) and of the regulator, except
    /// through v_n.
    pub fn response_to_past(&self, y: &[f64], length: f64, [r, z]: [f64; 2], past: Carried) -> f64 {
        let Some(regulator) = self.cell.cue.regulator() else { return 0.0 };
        let (sin, cos) = sin_cos(y[PSI]);
        let per = self.rate * length / regulator.diffusion;
        let along = cos * r - sin * z;
        if !regulator.diluted {
            return per * (past.amount - y[J] * along);
        }
        let c = 1.0 + y[PHI];
        let stretched = (cos * past.r_u - sin * past.z_u) / length;
        per * (past.amount / (y[R] * length) - (y[J] + c * cos / y[R]) * along - c * stretched)
    }
}

/// Derivatives of the right-hand sides at a place by the motion of the cortex.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotionResponse {
    /// ∂(q′, v′, T′)/∂v_n.
    pub normal: [f64; 3],
    /// ∂j′/∂v_n through the stretching of the surface, and ∂j′ by ∂_tφ − w j, the change of the regulator in the frame
    /// of the cortex's own tangential motion w.
    pub carried: [f64; 2],
    /// ∂j′/∂v_n through S_uu alone.
    pub strain: f64,
}

impl MotionResponse {
    /// The response multiplied by `factor`.
    pub fn scaled(self, factor: f64) -> MotionResponse {
        MotionResponse {
            normal: self.normal.map(|r| r * factor),
            carried: self.carried.map(|r| r * factor),
            strain: self.strain * factor,
        }
    }

    /// Writes the response to a normal velocity, and to a change ∂_tφ − w j of the regulator, into the right-hand sides
    /// of a point. Right-hand sides without a response are left unchanged.
    pub fn put(&self, normal: f64, carried: f64, to: &mut [f64]) {
        for (k, response) in [Q, V, T].into_iter().zip(self.normal) {
            to[k] = normal * response;
        }
        if let Some(to) = to.get_mut(J) {
            *to = normal * self.carried[0] + carried * self.carried[1];
        }
    }
}

impl BoundaryValueProblem for Cortex {
    fn dimensions(&self) -> Dimensions {
        let mut dimensions = Cortex::dimensions_for(&self.cell, self.free.len());
        dimensions.right -= usize::from(self.amount_is_given);
        dimensions
    }

    /// Compiled for the most frequent sizes: steps and shapes at rest, branches, and curves of cells without a
    /// regulator. Never inlined, so that crates that use this one do not compile the kernels again with their own
    /// optimisation.
    #[inline(never)]
    fn kernels(&self, stages: usize) -> Kernels {
        match (self.is_regulated(), stages, self.free.len()) {
            (false, 3, 0) => Kernels::sized::<COMPONENTS, QUADRATURES, 0, 3, LEFT, SHAPE_SCALARS, 1>(),
            (false, 3, 1) => Kernels::sized::<COMPONENTS, QUADRATURES, 0, 3, LEFT, { SHAPE_SCALARS + 1 }, 1>(),
            (false, 4, 0) => Kernels::sized::<COMPONENTS, QUADRATURES, 0, 4, LEFT, SHAPE_SCALARS, 1>(),
            (false, 4, 1) => Kernels::sized::<COMPONENTS, QUADRATURES, 0, 4, LEFT, { SHAPE_SCALARS + 1 }, 1>(),
            (false, 4, 2) => Kernels::sized::<COMPONENTS, QUADRATURES, 0, 4, LEFT, { SHAPE_SCALARS + 2 }, 1>(),
            (true, 4, 0) => Kernels::sized::<REGULATED, ALL_QUADRATURES, 1, 4, { LEFT + 1 }, SHAPE_SCALARS, 1>(),
            (true, 4, 1) => {
                Kernels::sized::<REGULATED, ALL_QUADRATURES, 1, 4, { LEFT + 1 }, { SHAPE_SCALARS + 1 }, 1>()
            }
            _ => Kernels::general(),
        }
    }

    fn prepare(&mut self, p: &[f64]) {
        let values = self.free.iter().zip(&p[SHAPE_SCALARS..]);
        // At a singular point the same values are prepared for several directions.
        if values.clone().any(|(free, value)| free.get(&self.cell) != *value) {
            values.for_each(|(free, value)| free.set(&mut self.cell, *value));
            self.refresh();
        }
    }

    fn prepare_points(&mut self, x: &[f64], p: &[f64]) {
        if self.constants.vary() {
            self.coefficients.prepare(&self.constants, x, p[LENGTH]);
        }
    }

    fn rhs(&self, at: CollocationPoint, y: &[f64], p: &[f64], f: &mut [f64], g: &mut [f64]) {
        self.rhs_many(CollocationPoints { first: at.index, x: &[at.x], y }, p, f, g);
    }

    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        self.rhs_jacobian_many(CollocationPoints { first: at.index, x: &[at.x], y }, p, out);
    }

    fn rhs_many(&self, points: CollocationPoints<'_>, p: &[f64], f: &mut [f64], g: &mut [f64]) {
        let (coefficients, profiles) = self.coefficients.at_points(&self.constants, points, p[LENGTH]);
        let sweep = self.sweep(&coefficients, profiles);
        if self.constants.is_own() {
            return match self.is_regulated() {
                true => own::points::rhs_many::<REGULATED>(&sweep, points, p, f, g),
                false => own::points::rhs_many::<COMPONENTS>(&sweep, points, p, f, g),
            };
        }
        if self.is_regulated() {
            sweep::rhs_many::<REGULATED>(&sweep, points, p, f, g);
        } else {
            sweep::rhs_many::<COMPONENTS>(&sweep, points, p, f, g);
        }
    }

    fn rhs_jacobian_many(&self, points: CollocationPoints<'_>, p: &[f64], out: &mut PointJacobian<'_>) {
        let (coefficients, profiles) = self.coefficients.at_points(&self.constants, points, p[LENGTH]);
        let (sweep, columns) = (self.sweep(&coefficients, profiles), self.columns(p[LENGTH]));
        if let Some(along_length) = self.along_length.as_ref().filter(|_| self.constants.is_own()) {
            let columns = (along_length, self.sensitivities.as_slice());
            return match self.is_regulated() {
                true => own::points::jacobian_many::<REGULATED>(&sweep, points, p, columns, out),
                false => own::points::jacobian_many::<COMPONENTS>(&sweep, points, p, columns, out),
            };
        }
        if self.is_regulated() {
            sweep::jacobian_many::<REGULATED>(&sweep, points, p, columns, out);
        } else {
            sweep::jacobian_many::<COMPONENTS>(&sweep, points, p, columns, out);
        }
    }

    fn left(&self, y: &[f64], _p: &[f64], out: &mut BoundaryJacobian<'_>) {
        let conditions = [R, PSI, Q, V, J].into_iter().filter(|component| *component < y.len());
        for (k, component) in conditions.enumerate() {
            out.r[k] = y[component];
            out.ry[k * y.len() + component] = 1.0;
        }
    }

    /// At the far pole r = 0, ψ = π, q = 0, v = 0 \[M.13 poles\]; at the mirror every odd component is at its centre,
    /// M.14.
    fn right(&self, y: &[f64], _p: &[f64], out: &mut BoundaryJacobian<'_>) {
        // The condition that may be left out is the last one on either domain.
        let (n, conditions) = (y.len(), out.r.len());
        let mut put = |k: usize, component: usize, value: f64| {
            out.r[k] = y[component] - value;
            out.ry[k * n + component] = 1.0;
        };
        match self.domain {
            Domain::Full => {
                let values = [(R, 0.0), (PSI, PI), (Q, 0.0), (V, 0.0), (J, 0.0)].into_iter().take(conditions);
                values.enumerate().for_each(|(k, (component, value))| put(k, component, value));
            }
            Domain::Half => {
                let values = odd(n).iter().take(conditions);
                values.enumerate().for_each(|(k, &component)| put(k, component, CENTRE[component]));
            }
        }
    }

    fn integral_offset(&self, _k: usize, _p: &[f64], hp: &mut [f64]) -> f64 {
        let share = self.domain.end();
        for (k, constants) in self.sensitivities.iter().enumerate() {
            hp[SHAPE_SCALARS + k] = -share * constants.volume.eps;
        }
        -share * self.constants.volume
    }
}
