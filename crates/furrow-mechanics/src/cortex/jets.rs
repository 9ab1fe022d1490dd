//! Directional derivatives of the equations at many points side by side, for stationary shapes of cells without a cue,
//! where the coefficients are uniform. Points are processed in groups, as in `sweep`, so that the compiler vectorises
//! the loop.

use std::ops::{Add, Div, Mul, Neg, Sub};

use furrow_bvp::{CollocationPoints, PointDirection};
use multiversion::multiversion;
use num_dual::{Dual3_64, HyperDual64};

use super::equations::{Balance, BdfTerm, COMPONENTS, Constants, LocalCoefficients, ShellCoefficients, balances};
use super::lanes::{Arithmetic, Lane};

/// A number with its derivative along a direction. Nested jets hold higher derivatives: the compiler drops unused ones,
/// and a derivative along equal directions is computed once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Jet<T> {
    pub value: T,
    pub slope: T,
}

type First = Jet<Lane>;
type Second = Jet<First>;
type Third = Jet<Second>;

impl<T: Arithmetic> From<f64> for Jet<T> {
    #[inline(always)]
    fn from(value: f64) -> Jet<T> {
        Jet { value: T::from(value), slope: T::from(0.0) }
    }
}

impl<T: Arithmetic> Add for Jet<T> {
    type Output = Jet<T>;

    #[inline(always)]
    fn add(self, other: Jet<T>) -> Jet<T> {
        Jet { value: self.value + other.value, slope: self.slope + other.slope }
    }
}

impl<T: Arithmetic> Sub for Jet<T> {
    type Output = Jet<T>;

    #[inline(always)]
    fn sub(self, other: Jet<T>) -> Jet<T> {
        Jet { value: self.value - other.value, slope: self.slope - other.slope }
    }
}

impl<T: Arithmetic> Sub<f64> for Jet<T> {
    type Output = Jet<T>;

    #[inline(always)]
    fn sub(self, other: f64) -> Jet<T> {
        Jet { value: self.value - other, slope: self.slope }
    }
}

impl<T: Arithmetic> Mul for Jet<T> {
    type Output = Jet<T>;

    #[inline(always)]
    fn mul(self, other: Jet<T>) -> Jet<T> {
        Jet { value: self.value * other.value, slope: self.slope * other.value + self.value * other.slope }
    }
}

impl<T: Arithmetic> Mul<f64> for Jet<T> {
    type Output = Jet<T>;

    #[inline(always)]
    fn mul(self, factor: f64) -> Jet<T> {
        Jet { value: self.value * factor, slope: self.slope * factor }
    }
}

impl<T: Arithmetic> Div for Jet<T> {
    type Output = Jet<T>;

    #[expect(clippy::suspicious_arithmetic_impl, reason = "one division serves all derivatives")]
    #[inline(always)]
    fn div(self, other: Jet<T>) -> Jet<T> {
        self * other.recip()
    }
}

impl<T: Arithmetic> Neg for Jet<T> {
    type Output = Jet<T>;

    #[inline(always)]
    fn neg(self) -> Jet<T> {
        Jet { value: -self.value, slope: -self.slope }
    }
}

impl<T: Arithmetic> Arithmetic for Jet<T> {
    #[inline(always)]
    fn sin_cos(self) -> (Jet<T>, Jet<T>) {
        let (sin, cos) = self.value.sin_cos();
        (Jet { value: sin, slope: self.slope * cos }, Jet { value: cos, slope: -(self.slope * sin) })
    }

    #[inline(always)]
    fn exp(self) -> Jet<T> {
        let exp = self.value.exp();
        Jet { value: exp, slope: self.slope * exp }
    }

    #[inline(always)]
    fn recip(self) -> Jet<T> {
        let recip = self.value.recip();
        Jet { value: recip, slope: -(self.slope * (recip * recip)) }
    }
}

#[inline(always)]
fn second_order(number: HyperDual64) -> Second {
    let jet = |value, slope| Jet { value: Lane(value), slope: Lane(slope) };
    Jet { value: jet(number.re, number.eps1), slope: jet(number.eps2, number.eps1eps2) }
}

#[inline(always)]
fn third_order(number: Dual3_64) -> Third {
    let jet = |value, slope| Jet { value: Lane(value), slope: Lane(slope) };
    let Dual3_64 { re, v1, v2, v3, .. } = number;
    let rise = jet(v1, v2);
    Jet { value: Jet { value: jet(re, v1), slope: rise }, slope: Jet { value: rise, slope: jet(v2, v3) } }
}

#[inline(always)]
fn second_at([y, a, b]: [f64; 3]) -> Second {
    second_order(HyperDual64::new(y, a, b, 0.0))
}

#[inline(always)]
fn third_at([y, a]: [f64; 2]) -> Third {
    third_order(Dual3_64::new(y, a, 0.0, 0.0))
}

/// Points of a group.
const GROUP: usize = 8;

/// Numbers at the points of a group.
type Group<const K: usize> = [[f64; GROUP]; K];

/// f, followed by the integrand of the volume.
const OUT: usize = COMPONENTS + 1;

/// The values common to all points.
#[derive(Clone, Copy)]
pub(super) struct Shared<D> {
    shell: ShellCoefficients<D>,
    local: LocalCoefficients<D>,
    length: D,
    pressure: D,
}

impl<D: Copy> Shared<D> {
    /// The values of a cell with uniform coefficients.
    pub(super) fn of(constants: &Constants<D>, length: D, pressure: D) -> Shared<D> {
        Shared { shell: constants.shell, local: constants.uniform, length, pressure }
    }

    #[inline(always)]
    fn map<E>(self, number: impl Fn(D) -> E) -> Shared<E> {
        let (shell, local) = (self.shell.map(&number), self.local.map(&number));
        Shared { shell, local, length: number(self.length), pressure: number(self.pressure) }
    }
}

impl<D: Arithmetic> Shared<D> {
    /// f and the integrand of the volume at point i of a group; `number` combines the state and the directions. It is a
    /// function, not a closure, because closures in functions compiled for several targets are not inlined.
    #[inline(always)]
    fn at<const K: usize>(&self, group: &[Group<COMPONENTS>; K], i: usize, number: impl Fn([f64; K]) -> D) -> [D; OUT] {
        let state = std::array::from_fn(|k| number(std::array::from_fn(|which| group[which][k][i])));
        let (motion, noise) = (BdfTerm::<f64>::default().map(D::from), D::from(1.0));
        let Shared { shell, local, length, pressure } = self;
        let Balance { f, volume, .. } = balances(shell, local, motion, noise, &state, *length, *pressure);
        std::array::from_fn(|k| if k < COMPONENTS { f[k] } else { volume })
    }
}

/// Second derivatives along two directions.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn second(shared: &Shared<HyperDual64>, group: &[Group<COMPONENTS>; 3], out: &mut Group<OUT>) {
    let shared = shared.map(second_order);
    for i in 0..GROUP {
        let values = shared.at(group, i, second_at);
        for k in 0..OUT {
            out[k][i] = values[k].slope.slope.0;
        }
    }
}

/// Second and third derivatives along one direction.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn third(shared: &Shared<Dual3_64>, group: &[Group<COMPONENTS>; 2], [out, last]: &mut [Group<OUT>; 2]) {
    let shared = shared.map(third_order);
    for i in 0..GROUP {
        let values = shared.at(group, i, third_at);
        for k in 0..OUT {
            out[k][i] = values[k].value.slope.slope.0;
            last[k][i] = values[k].slope.slope.slope.0;
        }
    }
}

/// Reads the values of group `j`; the last point is repeated to fill the group.
fn read<const K: usize>(all: [&[f64]; K], j: usize) -> [Group<COMPONENTS>; K] {
    all.map(|values| {
        let last = values.len() / COMPONENTS - 1;
        let point = |i: usize| (j * GROUP + i).min(last) * COMPONENTS;
        std::array::from_fn(|k| std::array::from_fn(|i| values[point(i) + k]))
    })
}

/// Writes the results of group `j`.
fn write(found: &Group<OUT>, j: usize, [f, g]: &mut [&mut [f64]; 2]) {
    let (f, g) = (&mut f[j * GROUP * COMPONENTS..], &mut g[j * GROUP..]);
    for (i, (f, g)) in f.chunks_exact_mut(COMPONENTS).zip(g).take(GROUP).enumerate() {
        f.iter_mut().zip(found).for_each(|(f, values)| *f = values[i]);
        *g = found[COMPONENTS][i];
    }
}

/// D²f\[a, b\] and D²g\[a, b\] at all points, with g the integrand of the volume.
pub(super) fn second_many(
    shared: &Shared<HyperDual64>,
    points: CollocationPoints<'_>,
    [a, b]: [PointDirection; 2],
    mut out: [&mut [f64]; 2],
) {
    let mut found = [[0.0; GROUP]; OUT];
    for j in 0..points.x.len().div_ceil(GROUP) {
        second(shared, &read([points.y, a.y, b.y], j), &mut found);
        write(&found, j, &mut out);
    }
}

/// D²f\[a, a\] and D³f\[a, a, a\], and the same of the integrand g of the volume, at all points.
pub(super) fn third_many(
    shared: &Shared<Dual3_64>,
    points: CollocationPoints<'_>,
    a: PointDirection,
    mut out: [[&mut [f64]; 2]; 2],
) {
    let mut found = [[[0.0; GROUP]; OUT]; 2];
    for j in 0..points.x.len().div_ceil(GROUP) {
        third(shared, &read([points.y, a.y], j), &mut found);
        out.iter_mut().zip(&found).for_each(|(out, found)| write(found, j, out));
    }
}
