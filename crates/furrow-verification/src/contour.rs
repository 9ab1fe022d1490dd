//! A computed shape as a surface of revolution.
//!
//! Curvatures come from the derivative of ψ, strain rates from the derivative of v and the motion of the contour. The solver's bending
//! moment m and tension T are not used.

use std::f64::consts::PI;

use furrow_bvp::{Gauss, Solution};
use furrow_cell::Cell;
use furrow_mechanics::cortex::equations::{COMPONENTS, J, LENGTH, M, PHI, PRESSURE, PSI, Q, R, T, V, Z};

use crate::balance;
use crate::coefficients::{Coefficients, coefficients, shell_force};

/// A shape of the whole contour and its motion.
#[derive(Clone, Debug)]
pub struct Computed {
    /// The cell.
    pub cell: Cell,
    /// The shape with (L, p).
    pub shape: Solution,
    /// ∂_t(r, z) at fixed u at every collocation point; empty at rest.
    pub motion: Vec<[f64; 2]>,
    /// Factor on the activity at every collocation point; empty without noise.
    pub noise: Vec<f64>,
}

/// One collocation point.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Arclength fraction u.
    pub u: f64,
    /// Quadrature weight of the point in area: 2πr times its part of the arclength.
    pub area: f64,
    /// Distance from the axis.
    pub r: f64,
    /// Position along the axis.
    pub z: f64,
    /// Length of the whole contour.
    pub length: f64,
    /// The regulator φ, 0 without one.
    pub phi: f64,
    /// (sinψ, cosψ).
    pub normal: [f64; 2],
    /// (c1, c2).
    pub curvature: [f64; 2],
    /// Tangential velocity.
    pub v: f64,
    /// Normal velocity.
    pub v_n: f64,
    /// (S_uu, S_φφ).
    pub strain: [f64; 2],
    /// Viscous stress (uu, φφ).
    pub viscous: [f64; 2],
    /// Active stress (uu, φφ).
    pub active: [f64; 2],
    /// Coefficients.
    pub here: Coefficients<f64>,
    /// f_c.
    pub shell: f64,
    /// The solver's bending moment and shear.
    pub bending: [f64; 2],
    /// The solver's T_uu.
    pub tension: f64,
    /// Differences of r_s, z_s and m from cosψ, −sinψ and κ(C − C0).
    pub geometry: [f64; 3],
}

impl Computed {
    /// Contour length L.
    pub fn length(&self) -> f64 {
        self.shape.scalars[LENGTH]
    }

    /// Pressure p.
    pub fn pressure(&self) -> f64 {
        self.shape.scalars[PRESSURE]
    }

    /// All collocation points, pole to pole.
    pub fn places(&self) -> Vec<Place> {
        let gauss = self.shape.gauss();
        let points = 0..self.shape.intervals() * self.shape.m;
        points.map(|k| self.place(&gauss, k / self.shape.m, k % self.shape.m)).collect()
    }

    /// The integral over the surface of a density per area.
    pub fn integral(&self, density: impl Fn(&Place) -> f64) -> f64 {
        self.places().iter().map(|place| place.area * density(place)).sum()
    }

    fn place(&self, gauss: &Gauss, i: usize, j: usize) -> Place {
        let (y, length) = (&self.shape, self.length());
        let (state, mut slope) = (y.stage(i, j), vec![0.0; y.components]);
        y.slope_in(gauss, i, gauss.c[j], &mut slope);
        slope.iter_mut().for_each(|by_u| *by_u /= length);
        let (k, u) = (i * y.m + j, y.stage_x(gauss, i, j));
        let carried = (y.components > COMPONENTS).then(|| [state[PHI], state[J] * length]);
        let here = coefficients(&self.cell, u, length, carried);
        let (sin, cos) = state[PSI].sin_cos();
        let [c1, c2] = [slope[PSI], sin / state[R]];
        let [r_t, z_t] = self.motion.get(k).copied().unwrap_or_default();
        let v_n = sin * r_t + cos * z_t;
        let strain = [slope[V] + c1 * v_n, cos / state[R] * state[V] + c2 * v_n];
        let noise = self.noise.get(k).copied().unwrap_or(1.0);
        Place {
            u,
            area: 2.0 * PI * state[R] * length * (y.mesh[i + 1] - y.mesh[i]) * gauss.b[j],
            r: state[R],
            z: state[Z],
            length,
            phi: carried.map_or(0.0, |[phi, _]| phi),
            normal: [sin, cos],
            curvature: [c1, c2],
            v: state[V],
            v_n,
            strain,
            viscous: balance::stress([here.eta_b, here.eta_s, 0.0, 0.0], strain, [c1, c2]),
            active: balance::stress([0.0, 0.0, noise * here.xi_s, noise * here.xi_b], [0.0; 2], [c1, c2]),
            here,
            shell: shell_force(&self.cell, state[R], state[Z], state[PSI]),
            bending: [state[M], state[Q]],
            tension: state[T],
            geometry: [slope[R] - cos, slope[Z] + sin, state[M] - here.kappa * (c1 + c2 - here.spontaneous)],
        }
    }
}
