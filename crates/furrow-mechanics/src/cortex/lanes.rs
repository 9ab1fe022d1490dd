//! Numbers for loops that the compiler vectorises.
//!
//! A call of the library's sine prevents vectorisation, and its last digit differs between machines. The functions here
//! are polynomials without branches, exact to about the last digit, and the same on every machine.

use std::f64::consts::{FRAC_2_PI, LOG2_E};
use std::ops::{Add, Div, Mul, Neg, Sub};

use num_dual::DualNum;

use furrow_cell::Number;

/// The arithmetic that the equations of the cortex use.
pub trait Arithmetic:
    Copy
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Mul<f64, Output = Self>
    + Sub<f64, Output = Self>
{
    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self);
    /// The exponential.
    fn exp(self) -> Self;
    /// 1/x.
    fn recip(self) -> Self;
}

impl<D: Number> Arithmetic for D {
    #[inline(always)]
    fn sin_cos(self) -> (D, D) {
        DualNum::sin_cos(&self)
    }

    #[inline(always)]
    fn exp(self) -> D {
        DualNum::exp(&self)
    }

    #[inline(always)]
    fn recip(self) -> D {
        DualNum::recip(&self)
    }
}

/// One of the numbers that a loop runs over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lane(pub f64);

impl From<f64> for Lane {
    #[inline(always)]
    fn from(value: f64) -> Lane {
        Lane(value)
    }
}

macro_rules! operation {
    ($trait:ident, $method:ident, $operator:tt) => {
        impl $trait for Lane {
            type Output = Lane;

            #[inline(always)]
            fn $method(self, other: Lane) -> Lane {
                Lane(self.0 $operator other.0)
            }
        }

        impl $trait<f64> for Lane {
            type Output = Lane;

            #[inline(always)]
            fn $method(self, other: f64) -> Lane {
                Lane(self.0 $operator other)
            }
        }
    };
}

operation!(Add, add, +);
operation!(Sub, sub, -);
operation!(Mul, mul, *);
operation!(Div, div, /);

impl Neg for Lane {
    type Output = Lane;

    #[inline(always)]
    fn neg(self) -> Lane {
        Lane(-self.0)
    }
}

impl Arithmetic for Lane {
    #[inline(always)]
    fn sin_cos(self) -> (Lane, Lane) {
        let (sin, cos) = sin_cos(self.0);
        (Lane(sin), Lane(cos))
    }

    #[inline(always)]
    fn exp(self) -> Lane {
        Lane(exp(self.0))
    }

    #[inline(always)]
    fn recip(self) -> Lane {
        Lane(1.0 / self.0)
    }
}

/// Adding 1.5 · 2⁵² rounds to an integer and leaves it in the lowest bits.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// π/2 in three parts; the first two have 33 bits, so that their multiples are exact.
const HALF_PI: [f64; 3] = [1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21];

/// ln 2 in two parts; the first has 40 bits.
const LN_2: [f64; 2] = [0.6931471805592082, 7.371002565167799e-13];

/// Σ c_k x^k by Horner's rule, the highest coefficient first.
#[inline(always)]
fn polynomial<const N: usize>(x: f64, coefficients: [f64; N]) -> f64 {
    coefficients.into_iter().fold(0.0, |sum, c| sum * x + c)
}

/// ± 1/k! for every second k from `first` on: `N` values with alternating signs, the highest k first.
const fn alternating<const N: usize>(first: u32) -> [f64; N] {
    let mut out = [0.0; N];
    let (mut k, mut factorial, mut j) = (0, 1.0, 0);
    while j < N {
        while k < first + 2 * j as u32 {
            k += 1;
            factorial *= k as f64;
        }
        out[N - 1 - j] = if j % 2 == 0 { 1.0 } else { -1.0 } / factorial;
        j += 1;
    }
    out
}

/// 1/k! for k < N, the highest first.
const fn factorials<const N: usize>() -> [f64; N] {
    let mut out = [0.0; N];
    let (mut factorial, mut k) = (1.0, 0);
    while k < N {
        factorial *= if k == 0 { 1.0 } else { k as f64 };
        out[N - 1 - k] = 1.0 / factorial;
        k += 1;
    }
    out
}

const SINE: [f64; 8] = alternating(3);
const COSINE: [f64; 8] = alternating(2);
const EXPONENTIAL: [f64; 14] = factorials();

/// Sine and cosine, to about the last digit below 10⁶; beyond, at angles that no contour has, accuracy decreases.
#[inline(always)]
pub fn sin_cos(x: f64) -> (f64, f64) {
    let rounded = x * FRAC_2_PI + ROUND;
    let (quarter, k) = (rounded.to_bits(), rounded - ROUND);
    let y = ((x - k * HALF_PI[0]) - k * HALF_PI[1]) - k * HALF_PI[2];
    let square = y * y;
    let sin = y - y * square * polynomial(square, SINE);
    let cos = 1.0 - square * polynomial(square, COSINE);
    let (sin, cos) = if quarter & 1 == 0 { (sin, cos) } else { (cos, sin) };
    let signed = |value: f64, turned: u64| f64::from_bits(value.to_bits() ^ ((turned & 2) << 62));
    (signed(sin, quarter), signed(cos, quarter.wrapping_add(1)))
}

/// The exponential, to about the last digit; arguments are clamped to the range with normal results.
#[inline(always)]
pub fn exp(x: f64) -> f64 {
    let x = if x < -708.0 { -708.0 } else { x };
    let x = if x > 709.0 { 709.0 } else { x };
    let rounded = x * LOG2_E + ROUND;
    let k = rounded - ROUND;
    let y = (x - k * LN_2[0]) - k * LN_2[1];
    polynomial(y, EXPONENTIAL) * f64::from_bits(rounded.to_bits().wrapping_add(1023) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers from 1e−9 to 1e6 of both signs.
    fn places() -> impl Iterator<Item = f64> {
        (0..30_000).map(|i| (if i % 2 == 0 { 1.0 } else { -1.0 }) * 10f64.powf(-9.0 + 15.0 * f64::from(i) / 30_000.0))
    }

    #[test]
    fn sines_and_cosines_are_those_of_the_library_to_the_last_digits() {
        for x in places().chain([0.0, std::f64::consts::PI, std::f64::consts::FRAC_PI_2, -0.0]) {
            let ((sin, cos), (a, b)) = (sin_cos(x), x.sin_cos());
            assert!((sin - a).abs() <= 2.0 * f64::EPSILON * a.abs().max(1e-16), "sin {x}: {sin} {a}");
            assert!((cos - b).abs() <= 2.0 * f64::EPSILON * b.abs().max(1e-10), "cos {x}: {cos} {b}");
        }
    }

    #[test]
    fn exponentials_are_those_of_the_library_to_the_last_digits() {
        for x in places().filter(|x| (-708.0..709.0).contains(x)) {
            assert!((exp(x) / x.exp() - 1.0).abs() <= 2.0 * f64::EPSILON, "{x}");
        }
        assert!(exp(-1e4) < 1e-300 && exp(1e300) > 1e300);
    }

    #[test]
    fn nan_propagates() {
        for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(sin_cos(x).0.is_nan() && sin_cos(x).1.is_nan());
        }
        assert!(exp(f64::NAN).is_nan());
    }
}
