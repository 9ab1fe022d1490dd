//! The balance of forces in its weak form: the power of all forces on any virtual motion vanishes.
//!
//! Bending enters only through the first variation of its energy ∫ ½κ(C − C0)² dA, of a material that carries its κ along:
//! under a motion δv along the contour and δn outwards, δC = −Δδn − (c1² + c2²) δn + δv ∂_sC and
//! δ(dA) = (∂_sδv + (cosψ/r) δv + C δn) dA, so that after an integration by parts
//!
//! δE = ∫ \[κ(C − C0)(−Δδn − (c1² + c2²) δn) + ½κ(C − C0)²C δn − ½(C − C0)²∂_sκ δv\] dA.
//!
//! Neither the shear q nor the moment m nor the elastic stress of the model occurs in it.

use furrow_cell::RigidityGradient;

use crate::contour::{Computed, Place};

/// A virtual motion at one point: values and derivatives by u.
#[derive(Clone, Copy, Debug, Default)]
pub struct Motion {
    /// δn, δn′, δn″.
    pub outwards: [f64; 3],
    /// δv, δv′.
    pub along: [f64; 2],
}

/// Smooth motions of the whole surface, even about both poles: cos kπu outwards for k = 0 … 5, and sin kπu along it for
/// k = 1 … 5.
pub fn motions() -> Vec<Box<dyn Fn(f64) -> Motion>> {
    let mut out: Vec<Box<dyn Fn(f64) -> Motion>> = Vec::new();
    for k in 0..6 {
        let n = f64::from(k) * std::f64::consts::PI;
        let outwards = move |u: f64| {
            let (sin, cos) = (n * u).sin_cos();
            Motion { outwards: [cos, -n * sin, -n * n * cos], along: [0.0; 2] }
        };
        out.push(Box::new(outwards));
        let along = move |u: f64| {
            let (sin, cos) = (n * u).sin_cos();
            Motion { outwards: [0.0; 3], along: [sin, n * cos] }
        };
        if k > 0 {
            out.push(Box::new(along));
        }
    }
    out
}

/// Powers of the forces on a motion, by origin; their sum is 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct Power {
    /// Change of the bending energy.
    pub bending: f64,
    /// Of passive tension.
    pub tension: f64,
    /// Of viscous stress.
    pub viscous: f64,
    /// Of active stress.
    pub active: f64,
    /// Of friction.
    pub friction: f64,
    /// Minus the power of the pressure.
    pub pressure: f64,
    /// Minus the power of the shell.
    pub shell: f64,
}

impl Power {
    /// All parts.
    pub fn parts(&self) -> [f64; 7] {
        [self.bending, self.tension, self.viscous, self.active, self.friction, self.pressure, self.shell]
    }

    /// The imbalance.
    pub fn imbalance(&self) -> f64 {
        self.parts().iter().sum::<f64>().abs()
    }
}

/// The power of all forces of a state on a virtual motion.
pub fn power(state: &Computed, motion: impl Fn(f64) -> Motion) -> Power {
    let mut sum = Power::default();
    for place in state.places() {
        let Motion { outwards: [n, n_u, n_uu], along: [v, v_u] } = motion(place.u);
        let length = state.length();
        let Place { area, curvature: [c1, c2], here, .. } = place;
        let (mean, cot) = (c1 + c2, place.normal[1] / place.r);
        let laplacian = n_uu / (length * length) + cot * n_u / length;
        let strain = [v_u / length + c1 * n, cot * v + c2 * n];
        let on = |stress: [f64; 2]| area * (stress[0] * strain[0] + stress[1] * strain[1]);
        let bent = mean - here.spontaneous;
        sum.bending += area * here.kappa * bent * (-laplacian - (c1 * c1 + c2 * c2) * n);
        sum.bending += area * 0.5 * here.kappa * bent * bent * mean * n;
        if state.cell.material.rigidity_gradient == RigidityGradient::Full {
            sum.bending -= area * 0.5 * bent * bent * here.kappa_s * v;
        }
        sum.tension += on([here.tension; 2]);
        sum.viscous += on(place.viscous);
        sum.active += on(place.active);
        sum.friction += area * (here.friction * place.v * v + state.cell.material.normal_friction * place.v_n * n);
        sum.pressure -= area * state.pressure() * n;
        sum.shell -= area * place.shell * n;
    }
    sum
}
