//! Derivatives of the equations along given directions, at many points side by side: for stationary shapes of cells without a cue,
//! whose coefficients are the same everywhere. Points go through in groups, as in `sweep`, so that the loop becomes vector code.

use std::ops::{Add, Div, Mul, Neg, Sub};

use furrow_bvp::CollocationPoints;
use furrow_bvp::derivatives::PointDirection;
use multiversion::multiversion;
use num_dual::{Dual64, HyperDual64};

use super::equations::{
    Balance, BdfTerm, COMPONENTS, Constants, LENGTH, LocalCoefficients, PRESSURE, ShellCoefficients, balances,
};
use super::lanes::{Arithmetic, Each};

/// A number with its derivatives along two directions, and the mixed second one. What is not read is not computed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Hyper {
    value: f64,
    a: f64,
    b: f64,
    ab: f64,
}

impl Hyper {
    /// A function of it, from the function's value and its first two derivatives.
    #[inline(always)]
    fn chain(self, value: f64, first: f64, second: f64) -> Hyper {
        let Hyper { a, b, ab, .. } = self;
        Hyper { value, a: first * a, b: first * b, ab: first * ab + second * a * b }
    }

    #[inline(always)]
    fn scaled(self, factor: f64) -> Hyper {
        Hyper { value: self.value * factor, a: self.a * factor, b: self.b * factor, ab: self.ab * factor }
    }
}

impl From<f64> for Hyper {
    #[inline(always)]
    fn from(value: f64) -> Hyper {
        Hyper { value, a: 0.0, b: 0.0, ab: 0.0 }
    }
}

impl From<HyperDual64> for Hyper {
    fn from(number: HyperDual64) -> Hyper {
        Hyper { value: number.re, a: number.eps1, b: number.eps2, ab: number.eps1eps2 }
    }
}

impl From<Dual64> for Hyper {
    fn from(number: Dual64) -> Hyper {
        Hyper { value: number.re, a: number.eps, b: 0.0, ab: 0.0 }
    }
}

impl Add for Hyper {
    type Output = Hyper;

    #[inline(always)]
    fn add(self, other: Hyper) -> Hyper {
        let Hyper { value, a, b, ab } = other;
        Hyper { value: self.value + value, a: self.a + a, b: self.b + b, ab: self.ab + ab }
    }
}

impl Neg for Hyper {
    type Output = Hyper;

    #[inline(always)]
    fn neg(self) -> Hyper {
        Hyper { value: -self.value, a: -self.a, b: -self.b, ab: -self.ab }
    }
}

impl Sub for Hyper {
    type Output = Hyper;

    #[inline(always)]
    fn sub(self, other: Hyper) -> Hyper {
        let Hyper { value, a, b, ab } = other;
        Hyper { value: self.value - value, a: self.a - a, b: self.b - b, ab: self.ab - ab }
    }
}

impl Sub<f64> for Hyper {
    type Output = Hyper;

    #[inline(always)]
    fn sub(self, other: f64) -> Hyper {
        Hyper { value: self.value - other, ..self }
    }
}

impl Mul for Hyper {
    type Output = Hyper;

    #[inline(always)]
    fn mul(self, other: Hyper) -> Hyper {
        Hyper {
            value: self.value * other.value,
            a: self.a * other.value + self.value * other.a,
            b: self.b * other.value + self.value * other.b,
            ab: self.ab * other.value + self.a * other.b + self.b * other.a + self.value * other.ab,
        }
    }
}

impl Mul<f64> for Hyper {
    type Output = Hyper;

    #[inline(always)]
    fn mul(self, factor: f64) -> Hyper {
        self.scaled(factor)
    }
}

impl Div for Hyper {
    type Output = Hyper;

    #[inline(always)]
    fn div(self, other: Hyper) -> Hyper {
        self * other.recip()
    }
}

impl Arithmetic for Hyper {
    #[inline(always)]
    fn sin_cos(self) -> (Hyper, Hyper) {
        let (Each(sin), Each(cos)) = Each(self.value).sin_cos();
        (self.chain(sin, cos, -sin), self.chain(cos, -sin, -cos))
    }

    #[inline(always)]
    fn exp(self) -> Hyper {
        let Each(exp) = Each(self.value).exp();
        self.chain(exp, exp, exp)
    }

    #[inline(always)]
    fn recip(self) -> Hyper {
        let recip = 1.0 / self.value;
        let square = recip * recip;
        self.chain(recip, -square, 2.0 * square * recip)
    }
}

/// Points of a group.
const GROUP: usize = 8;

/// A quantity at the points of a group.
type Values = [f64; GROUP];

/// The state at the points of a group, and its derivatives along both directions.
type Group = [[Values; COMPONENTS]; 3];

/// What is the same at all points.
struct Shared {
    shell: ShellCoefficients<Hyper>,
    local: LocalCoefficients<Hyper>,
    length: Hyper,
    pressure: Hyper,
}

impl Shared {
    fn of<D: Copy + Into<Hyper>>(constants: &Constants<D>, [length, pressure]: [D; 2]) -> Shared {
        let Constants { shell, uniform, .. } = constants;
        let (length, pressure) = (length.into(), pressure.into());
        Shared { shell: shell.map(D::into), local: uniform.map(D::into), length, pressure }
    }

    /// f at point i of a group, and the integrand of the volume.
    #[inline(always)]
    fn at(&self, [y, a, b]: &Group, i: usize) -> ([Hyper; COMPONENTS], Hyper) {
        let state = std::array::from_fn(|k| Hyper { value: y[k][i], a: a[k][i], b: b[k][i], ab: 0.0 });
        let (motion, noise) = (BdfTerm::<f64>::default().map(Hyper::from), Hyper::from(1.0));
        let Shared { shell, local, length, pressure } = self;
        let Balance { f, volume, .. } = balances(shell, local, motion, noise, &state, *length, *pressure);
        (f, volume)
    }
}

/// Mixed second derivatives of f, and behind them that of the integrand of the volume.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn mixed(shared: &Shared, group: &Group, out: &mut [Values; COMPONENTS + 1]) {
    for i in 0..GROUP {
        let (f, volume) = shared.at(group, i);
        for k in 0..COMPONENTS {
            out[k][i] = f[k].ab;
        }
        out[COMPONENTS][i] = volume.ab;
    }
}

/// First derivatives of f.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn first(shared: &Shared, group: &Group, out: &mut [Values; COMPONENTS]) {
    for i in 0..GROUP {
        let (f, _) = shared.at(group, i);
        for k in 0..COMPONENTS {
            out[k][i] = f[k].a;
        }
    }
}

/// Reads the values of the group that starts at point `from`; behind the last point it is repeated.
fn read(values: &[f64], from: usize, group: &mut [Values; COMPONENTS]) {
    let last = values.len() / COMPONENTS - 1;
    for i in 0..GROUP {
        let point = (from + i).min(last);
        for (k, value) in values[point * COMPONENTS..(point + 1) * COMPONENTS].iter().enumerate() {
            group[k][i] = *value;
        }
    }
}

/// D²f\[a, b\] and that of the integrand of the volume at all points, with constants, length and pressure along both directions.
pub(super) fn second_many(
    constants: &Constants<HyperDual64>,
    length_and_pressure: [HyperDual64; 2],
    points: CollocationPoints<'_>,
    [a, b]: [PointDirection; 2],
    [f, g]: [&mut [f64]; 2],
) {
    let shared = Shared::of(constants, length_and_pressure);
    let mut group = [[[0.0; GROUP]; COMPONENTS]; 3];
    let mut out = [[0.0; GROUP]; COMPONENTS + 1];
    for (j, (f, g)) in f.chunks_mut(GROUP * COMPONENTS).zip(g.chunks_mut(GROUP)).enumerate() {
        for (values, group) in [points.y, a.y, b.y].into_iter().zip(&mut group) {
            read(values, j * GROUP, group);
        }
        mixed(&shared, &group, &mut out);
        for (i, (f, g)) in f.chunks_exact_mut(COMPONENTS).zip(g).enumerate() {
            f.iter_mut().zip(&out).for_each(|(f, values)| *f = values[i]);
            *g = out[COMPONENTS][i];
        }
    }
}

/// ∂f/∂p of one scalar unknown into its column of `fp`, with the constants' derivatives by it.
pub(super) fn scalar_column(
    constants: &Constants<Dual64>,
    p: &[f64],
    points: CollocationPoints<'_>,
    [column, scalars]: [usize; 2],
    fp: &mut [f64],
) {
    let shared = Shared::of(constants, [LENGTH, PRESSURE].map(|k| Dual64::from_re(p[k])));
    let mut group = [[[0.0; GROUP]; COMPONENTS]; 3];
    let mut out = [[0.0; GROUP]; COMPONENTS];
    for (j, fp) in fp.chunks_mut(GROUP * COMPONENTS * scalars).enumerate() {
        read(points.y, j * GROUP, &mut group[0]);
        first(&shared, &group, &mut out);
        for (i, fp) in fp.chunks_exact_mut(COMPONENTS * scalars).enumerate() {
            fp.chunks_exact_mut(scalars).zip(&out).for_each(|(row, values)| row[column] = values[i]);
        }
    }
}
