//! The force of a shell of any profile, and the balances of cells that have one.
//!
//! With E and its gradient of M.30,
//!
//! * \[M.31 force of a profile\] f_c = −(P0/w²) exp\[(E − 1)/w²\] (sinψ ∂_rE + cosψ ∂_zE),
//!
//! which is M.9 in an ellipsoidal shell.

use furrow_cell::law::{Algebra, LawValues};
use furrow_cell::profile::Factor;

use super::{Lawful, Prepared, Spot};
use crate::cortex::equations::{
    self, Balance, BdfTerm, COMPONENTS, Constants, LocalCoefficients, PSI, Q, R, ShellCoefficients, Z,
};
use crate::cortex::lanes::Arithmetic;

/// f_c of M.31 at (r, z), where the normal is (sinψ, cosψ).
pub fn force<D: Arithmetic + Algebra>(
    factor: &Factor,
    c: &ShellCoefficients<D>,
    place: [D; 2],
    [sin, cos]: [D; 2],
) -> D {
    let (level, [by_r, by_z]) = factor.level(place, [c.inverse_b2, c.inverse_a2]);
    let inside = ((level - 1.0) * c.inverse_w2).exp();
    -(c.shell_force * inside * (by_r * sin + by_z * cos))
}

/// The balances at places of a cell with a law or a shell of its own.
pub(crate) struct Balances<D> {
    law: Option<Prepared<D>>,
    factor: Option<Factor>,
}

impl<D: Lawful> Balances<D> {
    /// The balances with a law and a shell, in numbers with derivatives up to an order.
    pub fn of(law: Option<LawValues<D>>, factor: Option<&Factor>, order: usize) -> Balances<D> {
        Balances { law: law.map(|law| Prepared::of(&law, order)), factor: factor.cloned() }
    }

    /// The force balances at one place.
    pub fn at(
        &mut self,
        c: &ShellCoefficients<D>,
        here: &LocalCoefficients<D>,
        spot: &Spot<D>,
        motion: BdfTerm<D>,
        y: &[D; COMPONENTS],
        length: D,
        pressure: D,
    ) -> Balance<D> {
        let zero = D::from(0.0);
        let shell = match self.factor {
            Some(_) => ShellCoefficients { shell_force: zero, inverse_w2: zero, ..*c },
            None => *c,
        };
        let mut balance = match &mut self.law {
            Some(law) => law.balances(&shell, here, spot, motion, y, length, pressure),
            None => equations::balances(&shell, here, motion, spot.noise, y, length, pressure),
        };
        if let Some(factor) = &self.factor {
            let normal = [balance.place.sin, balance.place.cos];
            balance.f[Q] = balance.f[Q] - length * force(factor, c, [y[R], y[Z]], normal);
        }
        balance
    }
}

impl<D> Constants<D> {
    /// Whether the cell has a law or a shell of its own, for which there are no hand-written derivatives.
    pub fn is_own(&self) -> bool {
        self.law.is_some() || self.shell_factor.is_some()
    }
}

/// f_c of a cell's shell in a state.
pub(in crate::cortex) fn force_at(c: &Constants<f64>, y: &[f64]) -> f64 {
    let (sin, cos) = y[PSI].sin_cos();
    match &c.shell_factor {
        Some(factor) => force(factor, &c.shell, [y[R], y[Z]], [sin, cos]),
        None => {
            let (a, b) = (c.shell.inverse_a2, c.shell.inverse_b2);
            let inside = ((y[Z] * y[Z] * a + y[R] * y[R] * b - 1.0) * c.shell.inverse_w2).exp();
            -(c.shell.shell_force * inside * (y[R] * sin * b + y[Z] * cos * a))
        }
    }
}
