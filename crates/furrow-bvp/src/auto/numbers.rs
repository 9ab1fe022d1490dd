//! The number types that equations are evaluated in.

use num_dual::{Dual3_64, Dual64, DualNum, HyperDual64, HyperHyperDual64};

/// A number that carries derivatives of every kind up to the third: the one number type of closures, see
/// [`SimpleProblem`](super::SimpleProblem).
pub type Jet = HyperHyperDual64;

/// Numbers in which equations are evaluated: plain, or with derivatives of first, second or third order. All functions are those
/// of [`DualNum`], as `y[0].exp()` or `y[0].powi(2)`; a constant is `D::from(2.0)`, or comes second as in `y[0] * 2.0`.
pub trait Number: DualNum<Primitive = f64> + Copy {
    /// With zeros for the derivatives it does not carry.
    fn to_jet(self) -> Jet;

    /// The derivatives it carries.
    fn from_jet(jet: Jet) -> Self;
}

impl Number for f64 {
    fn to_jet(self) -> Jet {
        Jet::from(self)
    }

    fn from_jet(jet: Jet) -> f64 {
        jet.re
    }
}

impl Number for Dual64 {
    fn to_jet(self) -> Jet {
        Jet { eps1: self.eps, ..Jet::from(self.re) }
    }

    fn from_jet(jet: Jet) -> Dual64 {
        Dual64::new(jet.re, jet.eps1)
    }
}

impl Number for HyperDual64 {
    fn to_jet(self) -> Jet {
        let HyperDual64 { re, eps1, eps2, eps1eps2 } = self;
        Jet { eps1, eps2, eps1eps2, ..Jet::from(re) }
    }

    fn from_jet(jet: Jet) -> HyperDual64 {
        HyperDual64::new(jet.re, jet.eps1, jet.eps2, jet.eps1eps2)
    }
}

impl Number for Dual3_64 {
    fn to_jet(self) -> Jet {
        let Dual3_64 { re, v1, v2, v3 } = self;
        Jet::new(re, v1, v1, v1, v2, v2, v2, v3)
    }

    fn from_jet(jet: Jet) -> Dual3_64 {
        Dual3_64::new(jet.re, jet.eps1, jet.eps1eps2, jet.eps1eps2eps3)
    }
}

impl Number for Jet {
    fn to_jet(self) -> Jet {
        self
    }

    fn from_jet(jet: Jet) -> Jet {
        jet
    }
}
