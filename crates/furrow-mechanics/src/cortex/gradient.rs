//! Numbers that carry their derivatives by all components of the state at a place, for the Jacobian of cells with a law of
//! their own.

use std::ops::{Add, Div, Mul, Neg, Sub};

use furrow_cell::law::{Algebra, Function};

use super::jets::Jet;
use super::lanes::{self, Arithmetic, Lane};

/// A number and its derivatives by N components.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gradient<const N: usize> {
    pub value: f64,
    pub by: [f64; N],
}

impl<const N: usize> Gradient<N> {
    /// Component `k`, with this value.
    #[inline(always)]
    pub fn component(k: usize, value: f64) -> Gradient<N> {
        Gradient { value, by: std::array::from_fn(|j| if j == k { 1.0 } else { 0.0 }) }
    }

    /// A function of it, by its value and its slope.
    #[inline(always)]
    fn chained(self, value: f64, slope: f64) -> Gradient<N> {
        Gradient { value, by: self.by.map(|d| d * slope) }
    }

    #[inline(always)]
    fn both(self, other: Gradient<N>, value: f64, of: impl Fn(f64, f64) -> f64) -> Gradient<N> {
        Gradient { value, by: std::array::from_fn(|k| of(self.by[k], other.by[k])) }
    }
}

impl<const N: usize> From<f64> for Gradient<N> {
    #[inline(always)]
    fn from(value: f64) -> Gradient<N> {
        Gradient { value, by: [0.0; N] }
    }
}

impl<const N: usize> Add for Gradient<N> {
    type Output = Gradient<N>;

    #[inline(always)]
    fn add(self, other: Gradient<N>) -> Gradient<N> {
        self.both(other, self.value + other.value, |a, b| a + b)
    }
}

impl<const N: usize> Sub for Gradient<N> {
    type Output = Gradient<N>;

    #[inline(always)]
    fn sub(self, other: Gradient<N>) -> Gradient<N> {
        self.both(other, self.value - other.value, |a, b| a - b)
    }
}

impl<const N: usize> Sub<f64> for Gradient<N> {
    type Output = Gradient<N>;

    #[inline(always)]
    fn sub(self, other: f64) -> Gradient<N> {
        Gradient { value: self.value - other, ..self }
    }
}

impl<const N: usize> Mul for Gradient<N> {
    type Output = Gradient<N>;

    #[expect(clippy::suspicious_arithmetic_impl, reason = "the product rule")]
    #[inline(always)]
    fn mul(self, other: Gradient<N>) -> Gradient<N> {
        self.both(other, self.value * other.value, |a, b| a * other.value + self.value * b)
    }
}

impl<const N: usize> Mul<f64> for Gradient<N> {
    type Output = Gradient<N>;

    #[inline(always)]
    fn mul(self, factor: f64) -> Gradient<N> {
        self.chained(self.value * factor, factor)
    }
}

impl<const N: usize> Div for Gradient<N> {
    type Output = Gradient<N>;

    #[inline(always)]
    fn div(self, other: Gradient<N>) -> Gradient<N> {
        let (inverse, value) = (1.0 / other.value, self.value / other.value);
        self.both(other, value, |a, b| (a - value * b) * inverse)
    }
}

impl<const N: usize> Neg for Gradient<N> {
    type Output = Gradient<N>;

    #[inline(always)]
    fn neg(self) -> Gradient<N> {
        self.chained(-self.value, -1.0)
    }
}

impl<const N: usize> Arithmetic for Gradient<N> {
    #[inline(always)]
    fn sin_cos(self) -> (Gradient<N>, Gradient<N>) {
        let (sin, cos) = lanes::sin_cos(self.value);
        (self.chained(sin, cos), self.chained(cos, -sin))
    }

    #[inline(always)]
    fn exp(self) -> Gradient<N> {
        let exp = lanes::exp(self.value);
        self.chained(exp, exp)
    }

    #[inline(always)]
    fn recip(self) -> Gradient<N> {
        let recip = 1.0 / self.value;
        self.chained(recip, -recip * recip)
    }
}

impl<const N: usize> Algebra for Gradient<N> {
    fn real(self) -> f64 {
        self.value
    }

    fn call(self, function: Function) -> Gradient<N> {
        let value = self.value.call(function);
        self.chained(value, function.slope(self.value, value))
    }

    fn whole_power(self, exponent: i32) -> Gradient<N> {
        self.chained(self.value.powi(exponent), self.value.power_slope(exponent))
    }
}

impl Algebra for Lane {
    fn real(self) -> f64 {
        self.0
    }

    fn call(self, function: Function) -> Lane {
        Lane(self.0.call(function))
    }

    fn whole_power(self, exponent: i32) -> Lane {
        Lane(self.0.powi(exponent))
    }
}

impl<T: Arithmetic + Algebra> Algebra for Jet<T> {
    fn real(self) -> f64 {
        self.value.real()
    }

    fn call(self, function: Function) -> Jet<T> {
        let value = self.value.call(function);
        Jet { value, slope: self.slope * function.slope(self.value, value) }
    }

    fn whole_power(self, exponent: i32) -> Jet<T> {
        Jet { value: self.value.whole_power(exponent), slope: self.slope * self.value.power_slope(exponent) }
    }
}
