//! Second and third directional derivatives of the equations, for singular points and their normal forms.

use furrow_bvp::derivatives::{Directional, PointDirection, PointValues};
use num_dual::{Dual3_64, HyperDual64};

use super::Cortex;
use super::equations::{BdfTerm, COMPONENTS, Constants, LENGTH, PRESSURE, REGULATED, equations};
use super::problem::SHAPE_SCALARS;
use furrow_cell::Number;

/// Constants, length and pressure of a cortex with derivatives along scalar directions.
#[derive(Clone, Debug)]
pub struct Lifted<D> {
    constants: Constants<D>,
    length: D,
    pressure: D,
}

fn lift<D: Number>(cortex: &Cortex, p: &[f64], number: impl Fn(usize, f64) -> D) -> Lifted<D> {
    let constants =
        Constants::new(&cortex.cell, |parameter, value| match cortex.free.iter().position(|free| *free == parameter) {
            Some(k) => number(SHAPE_SCALARS + k, value),
            None => D::from(value),
        });
    Lifted { constants, length: number(LENGTH, p[LENGTH]), pressure: number(PRESSURE, p[PRESSURE]) }
}

/// For stationary problems (`rate` = 0, no noise).
impl Directional for Cortex {
    type Second = Lifted<HyperDual64>;
    type Third = Lifted<Dual3_64>;

    fn prepare_second(&self, p: &[f64], a: &[f64], b: &[f64]) -> Self::Second {
        lift(self, p, |k, value| HyperDual64::new(value, a[k], b[k], 0.0))
    }

    fn second(&self, prepared: &Self::Second, point: PointValues, along: [PointDirection; 2], out: [&mut [f64]; 2]) {
        if point.y.len() == REGULATED {
            second::<REGULATED>(prepared, point, along, out);
        } else {
            second::<COMPONENTS>(prepared, point, along, out);
        }
    }

    fn second_offset(&self, prepared: &Self::Second, _k: usize) -> f64 {
        -self.domain.end() * prepared.constants.volume.eps1eps2
    }

    fn prepare_third(&self, p: &[f64], a: &[f64]) -> Self::Third {
        lift(self, p, |k, value| Dual3_64::new(value, a[k], 0.0, 0.0))
    }

    fn third(&self, prepared: &Self::Third, point: PointValues, a: PointDirection, out: [&mut [f64]; 3]) {
        if point.y.len() == REGULATED {
            third::<REGULATED>(prepared, point, a, out);
        } else {
            third::<COMPONENTS>(prepared, point, a, out);
        }
    }
}

fn second<const N: usize>(
    prepared: &Lifted<HyperDual64>,
    point: PointValues,
    along: [PointDirection; 2],
    out: [&mut [f64]; 2],
) {
    let (PointValues { at, y, .. }, [a, b], [f, g]) = (point, along, out);
    let state: [HyperDual64; N] = std::array::from_fn(|k| HyperDual64::new(y[k], a.y[k], b.y[k], 0.0));
    let (value, volume) =
        equations(&prepared.constants, at.x, BdfTerm::default(), 1.0, &state, prepared.length, prepared.pressure);
    for (f, value) in f.iter_mut().zip(&value) {
        *f = value.eps1eps2;
    }
    g[0] = volume.eps1eps2;
}

fn third<const N: usize>(prepared: &Lifted<Dual3_64>, point: PointValues, a: PointDirection, out: [&mut [f64]; 3]) {
    let (PointValues { at, y, .. }, [f2, g2, f3]) = (point, out);
    let state: [Dual3_64; N] = std::array::from_fn(|k| Dual3_64::new(y[k], a.y[k], 0.0, 0.0));
    let (value, volume) =
        equations(&prepared.constants, at.x, BdfTerm::default(), 1.0, &state, prepared.length, prepared.pressure);
    for (k, value) in value.iter().enumerate() {
        f2[k] = value.v2;
        f3[k] = value.v3;
    }
    g2[0] = volume.v2;
}
