//! Number types for the balance at a point: plain numbers, numbers with derivatives, and [`Gradient`], which
//! the compiler vectorises.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

use furrow_cell::law::{Algebra, Function};

/// The arithmetic operations of the balance.
pub trait Number:
    Copy
    + From<f64>
    + AddAssign
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Mul<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Add<f64, Output = Self>
{
    /// The square root.
    fn sqrt(self) -> Self;
    /// The exponential.
    fn exp(self) -> Self;
    /// 1/x.
    fn recip(self) -> Self;
}

impl<D: furrow_cell::Number> Number for D {
    fn sqrt(self) -> D {
        num_dual::DualNum::sqrt(&self)
    }

    fn exp(self) -> D {
        num_dual::DualNum::exp(&self)
    }

    fn recip(self) -> D {
        num_dual::DualNum::recip(&self)
    }
}

/// A number with its derivatives with respect to N variables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gradient<const N: usize> {
    /// The number.
    pub value: f64,
    /// Its derivatives.
    pub by: [f64; N],
}

/// Like `std::array::from_fn`, which the compiler does not always inline.
#[inline(always)]
fn map<const N: usize>(each: impl Fn(usize) -> f64) -> [f64; N] {
    let mut out = [0.0; N];
    for (k, out) in out.iter_mut().enumerate() {
        *out = each(k);
    }
    out
}

impl<const N: usize> Gradient<N> {
    /// The k-th of the N variables.
    #[inline(always)]
    pub fn variable(value: f64, k: usize) -> Gradient<N> {
        let mut by = [0.0; N];
        by[k] = 1.0;
        Gradient { value, by }
    }

    /// Applies a function with the value f and the derivative f′.
    #[inline(always)]
    fn chain(self, value: f64, slope: f64) -> Gradient<N> {
        Gradient { value, by: map(|k| slope * self.by[k]) }
    }

    #[inline(always)]
    fn both(self, other: Gradient<N>, value: f64, [a, b]: [f64; 2]) -> Gradient<N> {
        Gradient { value, by: map(|k| a * self.by[k] + b * other.by[k]) }
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
        Gradient { value: self.value + other.value, by: map(|k| self.by[k] + other.by[k]) }
    }
}

impl<const N: usize> AddAssign for Gradient<N> {
    #[inline(always)]
    fn add_assign(&mut self, other: Gradient<N>) {
        *self = *self + other;
    }
}

impl<const N: usize> Sub for Gradient<N> {
    type Output = Gradient<N>;
    #[inline(always)]
    fn sub(self, other: Gradient<N>) -> Gradient<N> {
        Gradient { value: self.value - other.value, by: map(|k| self.by[k] - other.by[k]) }
    }
}

impl<const N: usize> Mul for Gradient<N> {
    type Output = Gradient<N>;
    #[inline(always)]
    fn mul(self, other: Gradient<N>) -> Gradient<N> {
        self.both(other, self.value * other.value, [other.value, self.value])
    }
}

impl<const N: usize> Div for Gradient<N> {
    type Output = Gradient<N>;
    #[inline(always)]
    fn div(self, other: Gradient<N>) -> Gradient<N> {
        let (value, slope) = (self.value / other.value, 1.0 / other.value);
        self.both(other, value, [slope, -value * slope])
    }
}

impl<const N: usize> Neg for Gradient<N> {
    type Output = Gradient<N>;
    #[inline(always)]
    fn neg(self) -> Gradient<N> {
        self.chain(-self.value, -1.0)
    }
}

impl<const N: usize> Mul<f64> for Gradient<N> {
    type Output = Gradient<N>;
    #[inline(always)]
    fn mul(self, factor: f64) -> Gradient<N> {
        self.chain(self.value * factor, factor)
    }
}

impl<const N: usize> Add<f64> for Gradient<N> {
    type Output = Gradient<N>;
    #[inline(always)]
    fn add(self, other: f64) -> Gradient<N> {
        Gradient { value: self.value + other, by: self.by }
    }
}

impl<const N: usize> Sub<f64> for Gradient<N> {
    type Output = Gradient<N>;
    #[inline(always)]
    fn sub(self, other: f64) -> Gradient<N> {
        Gradient { value: self.value - other, by: self.by }
    }
}

impl<const N: usize> Number for Gradient<N> {
    #[inline(always)]
    fn sqrt(self) -> Gradient<N> {
        let value = self.value.sqrt();
        self.chain(value, 0.5 / value)
    }

    #[inline(always)]
    fn exp(self) -> Gradient<N> {
        let value = self.value.exp();
        self.chain(value, value)
    }

    #[inline(always)]
    fn recip(self) -> Gradient<N> {
        let value = 1.0 / self.value;
        self.chain(value, -value * value)
    }
}

impl<const N: usize> Algebra for Gradient<N> {
    fn real(self) -> f64 {
        self.value
    }

    fn call(self, function: Function) -> Gradient<N> {
        let value = self.value.call(function);
        self.chain(value, function.slope(self.value, value))
    }

    fn whole_power(self, exponent: i32) -> Gradient<N> {
        self.chain(self.value.powi(exponent), self.value.power_slope(exponent))
    }
}
