//! The equations of both antagonists as a boundary-value problem.
//!
//! With u the fraction of the contour from the posterior pole, ℓ the scale of the cell (1 for the cell itself) and L its
//! contour length, components (A, P, a, p) and scalars (Ā, P̄, ℓ):
//!
//! * A′ = a, P′ = p,
//! * \[P.2 stationary\] a′ = −(r′/r) a + (L²/D_A) \[ℓ²(k_offA A + k_AP Pⁿ A − k_onA ρ_A) + ℓ²ψ(ℓ) k_onA Ā\], and p′ likewise,
//! * ∫ (A − Ā) r du = 0, ∫ (P − P̄) r du = 0, and a = p = 0 at both poles.

use furrow_bvp::{
    BoundaryJacobian, BoundaryValueProblem, CollocationPoint, Dimensions, Directional, EndDerivatives, EndValues,
    PointDirection, PointJacobian, PointValues,
};

use super::membrane::Membrane;
use furrow_cell::cue::{ParConstants, SurfaceToVolume};

/// Index of A.
pub const A: usize = 0;
/// Index of P.
pub const P: usize = 1;
/// Index of ∂A/∂u.
pub(crate) const A_U: usize = 2;
/// Index of ∂P/∂u.
pub(crate) const P_U: usize = 3;
/// Number of components.
pub const COMPONENTS: usize = 4;
/// Index of Ā among the scalars; P̄ is the next.
pub(crate) const MEAN_A: usize = 0;
/// Index of the scale ℓ, if it is free.
pub(crate) const SCALE: usize = 2;

/// The past of an implicit step.
#[derive(Clone, Debug, Default)]
pub struct Past {
    /// 1/Δt of an implicit step, in 1/s; 0 for stationary states.
    pub rate: f64,
    /// A and P at the collocation points before the step.
    pub values: Vec<[f64; 2]>,
}

/// Both antagonists on a membrane.
#[derive(Clone, Debug)]
pub struct Polarity {
    /// Constants.
    pub constants: ParConstants,
    /// The surface.
    pub membrane: Membrane,
    /// The scale, if it is not a scalar unknown.
    pub fixed_scale: Option<f64>,
    /// The time step.
    pub past: Past,
    /// u, (1/r) ∂r/∂u and r/∫ r du at the collocation points of the last sweep.
    points: Vec<[f64; 3]>,
}

/// ℓ², ℓ²ψ(ℓ) with their first two derivatives.
#[derive(Clone, Copy, Debug)]
pub struct Scaling {
    square: [f64; 3],
    pool: [f64; 3],
}

impl Polarity {
    /// Stationary states at a fixed scale, or with a free scale.
    pub fn new(constants: ParConstants, membrane: Membrane, fixed_scale: Option<f64>) -> Polarity {
        Polarity { constants, membrane, fixed_scale, past: Past::default(), points: Vec::new() }
    }

    /// The scale at scalars `p`.
    pub fn scale(&self, p: &[f64]) -> f64 {
        self.fixed_scale.unwrap_or_else(|| p[SCALE])
    }

    fn scaling(&self, scale: f64) -> Scaling {
        let square = [scale * scale, 2.0 * scale, 2.0];
        let pool = match self.constants.surface_to_volume {
            SurfaceToVolume::Shape => [scale, 1.0, 0.0].map(|x| x * self.membrane.surface_to_volume),
            SurfaceToVolume::Fixed(psi) => square.map(|x| x * psi),
        };
        Scaling { square, pool }
    }

    /// L²/D of A and P.
    fn stiffness(&self) -> [f64; 2] {
        let length = self.membrane.length;
        [length * length / self.constants.d_a, length * length / self.constants.d_p]
    }

    /// k_on of A and P.
    fn attachment(&self) -> [f64; 2] {
        [self.constants.k_on_a, self.constants.k_on_p]
    }

    /// P to its power in the removal of A, with its first two derivatives.
    fn power(&self, p: f64) -> [f64; 3] {
        if self.constants.n_p == 1 { [p, 1.0, 0.0] } else { [p * p, 2.0 * p, 2.0] }
    }

    /// Loss from the membrane at concentrations (A, P), less the attachment from a full pool; with its derivatives by A
    /// and P.
    fn loss(&self, a: f64, p: f64) -> [[f64; 3]; 2] {
        let (c, [power, slope, _]) = (&self.constants, self.power(p));
        [
            [c.k_off_a * a + c.k_ap * power * a - c.k_on_a * c.rho_a, c.k_off_a + c.k_ap * power, c.k_ap * a * slope],
            [c.k_off_p * p + c.k_pa * a * a * p - c.k_on_p * c.rho_p, 2.0 * c.k_pa * a * p, c.k_off_p + c.k_pa * a * a],
        ]
    }

    /// (1/r) ∂r/∂u and r/∫ r du.
    fn place(&self, at: CollocationPoint) -> [f64; 2] {
        match self.points.get(at.index) {
            Some(&[u, widening, weight]) if u == at.x => [widening, weight],
            _ => self.membrane.at(at.x),
        }
    }

    /// The value before the step at a point, and the rate of the step; zeros for stationary states.
    fn held(&self, index: usize, species: usize) -> [f64; 2] {
        if self.past.rate == 0.0 { [0.0; 2] } else { [self.past.values[index][species], self.past.rate] }
    }
}

impl BoundaryValueProblem for Polarity {
    fn dimensions(&self) -> Dimensions {
        let scalars = if self.fixed_scale.is_some() { 2 } else { 3 };
        Dimensions {
            components: COMPONENTS,
            quadratures: 2,
            scalars,
            left: 2,
            right: 2,
            integrals: 2,
            ..Dimensions::default()
        }
    }

    fn prepare_points(&mut self, x: &[f64], _: &[f64]) {
        let known = self.points.len() == x.len() && self.points.iter().zip(x).all(|(point, x)| point[0] == *x);
        if !known {
            let Polarity { points, membrane, .. } = self;
            points.clear();
            points.extend(x.iter().map(|&u| {
                let [widening, weight] = membrane.at(u);
                [u, widening, weight]
            }));
        }
    }

    fn rhs(&self, at: CollocationPoint, y: &[f64], p: &[f64], f: &mut [f64], g: &mut [f64]) {
        let [widening, weight] = self.place(at);
        let Scaling { square, pool } = self.scaling(self.scale(p));
        let (loss, stiffness, attachment) = (self.loss(y[A], y[P]), self.stiffness(), self.attachment());
        for k in 0..2 {
            let [before, rate] = self.held(at.index, k);
            let (here, mean) = (y[A + k], p[MEAN_A + k]);
            let leaves = square[0] * (loss[k][0] + rate * (here - before)) + pool[0] * attachment[k] * mean;
            f[A + k] = y[A_U + k];
            f[A_U + k] = stiffness[k] * leaves - widening * y[A_U + k];
            g[k] = (here - mean) * weight;
        }
    }

    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        self.rhs(at, y, p, out.f, out.g);
        let [widening, weight] = self.place(at);
        let Scaling { square, pool } = self.scaling(self.scale(p));
        let (loss, stiffness, attachment) = (self.loss(y[A], y[P]), self.stiffness(), self.attachment());
        let scalars = p.len();
        for k in 0..2 {
            let [before, rate] = self.held(at.index, k);
            let (row, mean) = (A_U + k, p[MEAN_A + k]);
            out.fy[(A + k) * COMPONENTS + A_U + k] = 1.0;
            out.fy[row * COMPONENTS + A] = stiffness[k] * square[0] * loss[k][1];
            out.fy[row * COMPONENTS + P] = stiffness[k] * square[0] * loss[k][2];
            out.fy[row * COMPONENTS + A + k] += stiffness[k] * square[0] * rate;
            out.fy[row * COMPONENTS + row] = -widening;
            out.fp[row * scalars + MEAN_A + k] = stiffness[k] * pool[0] * attachment[k];
            if self.fixed_scale.is_none() {
                let leaves = square[1] * (loss[k][0] + rate * (y[A + k] - before)) + pool[1] * attachment[k] * mean;
                out.fp[row * scalars + SCALE] = stiffness[k] * leaves;
            }
            out.gy[k * COMPONENTS + A + k] = weight;
            out.gp[k * scalars + MEAN_A + k] = -weight;
        }
    }

    fn left(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
        for k in 0..2 {
            out.r[k] = y[A_U + k];
            out.ry[k * COMPONENTS + A_U + k] = 1.0;
        }
    }

    fn right(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        self.left(y, p, out);
    }
}

/// Second derivatives for stationary states.
impl Directional for Polarity {
    fn second(&self, PointValues { y, p, .. }: PointValues, [a, b]: [PointDirection; 2], [f, _]: [&mut [f64]; 2]) {
        let Scaling { square, pool } = self.scaling(self.scale(p));
        let (loss, stiffness, attachment) = (self.loss(y[A], y[P]), self.stiffness(), self.attachment());
        let along = |d: &PointDirection| if self.fixed_scale.is_some() { 0.0 } else { d.p[SCALE] };
        let (scale_a, scale_b) = (along(&a), along(&b));
        let mixed = a.y[A] * b.y[P] + a.y[P] * b.y[A];
        let ParConstants { k_ap, k_pa, .. } = self.constants;
        let [_, slope, bend] = self.power(y[P]);
        let removed = slope * mixed + bend * y[A] * a.y[P] * b.y[P];
        let curved = [k_ap * removed, 2.0 * k_pa * (y[P] * a.y[A] * b.y[A] + y[A] * mixed)];
        for k in 0..2 {
            let slope = |d: &PointDirection| loss[k][1] * d.y[A] + loss[k][2] * d.y[P];
            let mean = |d: &PointDirection| d.p[MEAN_A + k];
            let lost = square[0] * curved[k]
                + square[1] * (scale_a * slope(&b) + scale_b * slope(&a))
                + square[2] * scale_a * scale_b * loss[k][0];
            let pooled =
                pool[1] * (scale_a * mean(&b) + scale_b * mean(&a)) + pool[2] * scale_a * scale_b * p[MEAN_A + k];
            f[A_U + k] = stiffness[k] * (lost + attachment[k] * pooled);
        }
    }

    fn third(&self, point: PointValues, a: PointDirection, [[f2, g2], [f3, _]]: [[&mut [f64]; 2]; 2]) -> bool {
        self.second(point, [a, a], [f2, g2]);
        // Only directions in A and P, as for power series.
        let square = self.scaling(self.scale(point.p)).square[0];
        let [stiff_a, stiff_p] = self.stiffness();
        let [_, _, bend] = self.power(point.y[P]);
        f3[A_U] = stiff_a * square * 3.0 * bend * self.constants.k_ap * a.y[P] * a.y[P] * a.y[A];
        f3[P_U] = stiff_p * square * 6.0 * self.constants.k_pa * a.y[A] * a.y[A] * a.y[P];
        a.p.iter().all(|along| *along == 0.0)
    }

    /// Conditions are linear.
    fn second_at_ends(&mut self, _: EndValues, _: [EndValues; 2], _: EndDerivatives<'_>) {}

    fn third_at_ends(&mut self, _: EndValues, _: EndValues, _: EndDerivatives<'_>) {}
}
