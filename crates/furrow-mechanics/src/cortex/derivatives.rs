//! Second and third directional derivatives of the equations, for singular points and their normal forms.

use furrow_bvp::{CollocationPoints, Directional, EndDerivatives, EndValues, PointDirection, PointValues};
use num_dual::{Dual3_64, HyperDual64};

use super::Cortex;
use super::equations::{BdfTerm, COMPONENTS, Constants, LENGTH, PRESSURE, REGULATED, equations};
use super::jets::{self, Shared};
use super::problem::SHAPE_SCALARS;
use furrow_cell::Number;

/// Constants, length and pressure of a cortex with derivatives along scalar directions.
struct Lifted<D> {
    constants: Constants<D>,
    length: D,
    pressure: D,
}

impl<D: Number> Lifted<D> {
    /// The values common to all points of a cell without a cue.
    fn shared(&self) -> Shared<D> {
        Shared::of(&self.constants, self.length, self.pressure)
    }
}

fn lift<D: Number>(cortex: &Cortex, p: &[f64], number: impl Fn(usize, f64) -> D) -> Lifted<D> {
    let constants =
        Constants::new(&cortex.cell, |parameter, value| match cortex.free.iter().position(|free| *free == parameter) {
            Some(k) => number(SHAPE_SCALARS + k, value),
            None => D::from(value),
        });
    Lifted { constants, length: number(LENGTH, p[LENGTH]), pressure: number(PRESSURE, p[PRESSURE]) }
}

impl Cortex {
    fn second_order(&self, p: &[f64], a: &[f64], b: &[f64]) -> Lifted<HyperDual64> {
        lift(self, p, |k, value| HyperDual64::new(value, a[k], b[k], 0.0))
    }

    fn third_order(&self, p: &[f64], a: &[f64]) -> Lifted<Dual3_64> {
        lift(self, p, |k, value| Dual3_64::new(value, a[k], 0.0, 0.0))
    }
}

/// For stationary problems (`rate` = 0, no noise).
impl Directional for Cortex {
    fn second(&self, point: PointValues, along: [PointDirection; 2], out: [&mut [f64]; 2]) {
        let points = CollocationPoints { first: point.at.index, x: &[point.at.x], y: point.y };
        self.second_many(points, point.p, along, out);
    }

    fn second_many(&self, points: CollocationPoints<'_>, p: &[f64], along: [PointDirection; 2], out: [&mut [f64]; 2]) {
        let lifted = self.second_order(p, along[0].p, along[1].p);
        if self.components() == REGULATED {
            second::<REGULATED>(&lifted, points, along, out);
        } else if self.is_uniform() && !self.constants().is_own() {
            jets::second_many(&lifted.shared(), points, along, out);
        } else {
            second::<COMPONENTS>(&lifted, points, along, out);
        }
    }

    fn third_many(
        &mut self,
        points: CollocationPoints<'_>,
        p: &[f64],
        along: PointDirection,
        out: [[&mut [f64]; 2]; 2],
    ) {
        let lifted = self.third_order(p, along.p);
        if self.components() == REGULATED {
            third::<REGULATED>(&lifted, points, along, out);
        } else if self.is_uniform() && !self.constants().is_own() {
            jets::third_many(&lifted.shared(), points, along, out);
        } else {
            third::<COMPONENTS>(&lifted, points, along, out);
        }
    }

    /// Boundary conditions are linear.
    fn second_at_ends(&mut self, at: EndValues, [a, b]: [EndValues; 2], out: EndDerivatives<'_>) {
        out.offsets[0] = -self.domain.end() * self.second_order(at.p, a.p, b.p).constants.volume.eps1eps2;
    }

    fn third_at_ends(&mut self, at: EndValues, a: EndValues, out: EndDerivatives<'_>) {
        out.offsets[0] = -self.domain.end() * self.third_order(at.p, a.p).constants.volume.v3;
    }
}

fn second<const N: usize>(
    lifted: &Lifted<HyperDual64>,
    points: CollocationPoints<'_>,
    [a, b]: [PointDirection; 2],
    [f, g]: [&mut [f64]; 2],
) {
    let Lifted { constants, length, pressure } = lifted;
    for (i, &x) in points.x.iter().enumerate() {
        let here = |values: &[f64], k: usize| values[i * N + k];
        let state: [HyperDual64; N] =
            std::array::from_fn(|k| HyperDual64::new(here(points.y, k), here(a.y, k), here(b.y, k), 0.0));
        let (value, volume) = equations(constants, x, BdfTerm::default(), 1.0, &state, *length, *pressure);
        for (k, value) in value.iter().enumerate() {
            f[i * N + k] = value.eps1eps2;
        }
        g[i] = volume.eps1eps2;
    }
}

fn third<const N: usize>(
    lifted: &Lifted<Dual3_64>,
    points: CollocationPoints<'_>,
    a: PointDirection,
    [[f2, g2], [f3, g3]]: [[&mut [f64]; 2]; 2],
) {
    let Lifted { constants, length, pressure } = lifted;
    for (i, &x) in points.x.iter().enumerate() {
        let state: [Dual3_64; N] =
            std::array::from_fn(|k| Dual3_64::new(points.y[i * N + k], a.y[i * N + k], 0.0, 0.0));
        let (value, volume) = equations(constants, x, BdfTerm::default(), 1.0, &state, *length, *pressure);
        for (k, value) in value.iter().enumerate() {
            (f2[i * N + k], f3[i * N + k]) = (value.v2, value.v3);
        }
        (g2[i], g3[i]) = (volume.v2, volume.v3);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cortex::Domain;
    use furrow_bvp::{BoundaryValueProblem, PointJacobian};
    use furrow_cell::{Cell, Parameter};

    /// Irregular numbers around `middle`.
    fn scattered(middle: f64, count: usize) -> Vec<f64> {
        (0..count).map(|k| middle + 0.3 * (1.7 * (k * k) as f64 + middle).sin()).collect()
    }

    fn parts(rows: &mut [[Vec<f64>; 2]; 2]) -> [[&mut [f64]; 2]; 2] {
        rows.each_mut().map(|row| row.each_mut().map(|values| &mut values[..]))
    }

    /// More points than a group holds, and not a multiple of its size.
    #[test]
    fn points_in_groups_give_the_same_as_single_points() {
        const POINTS: usize = 11;
        let cortex = Cortex::new(&Cell::new(2.0), Domain::Half, &[Parameter::XiS, Parameter::R0]);
        let (p, x) = ([6.0, 0.4, 25.0, 2.0], scattered(0.3, POINTS));
        let [y, a, b] = [1.0, 0.1, -0.2].map(|middle| scattered(middle, POINTS * COMPONENTS));
        let [along_a, along_b] = [[0.3, -0.1, 0.7, 0.2], [-0.2, 0.5, 0.1, -0.4]];
        let points = CollocationPoints { first: 0, x: &x, y: &y };
        let along = [PointDirection { y: &a, p: &along_a }, PointDirection { y: &b, p: &along_b }];
        let near = |found: &[f64], expected: &[f64]| {
            let size = expected.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            found.iter().zip(expected).for_each(|(f, e)| assert!((f - e).abs() < 1e-13 * size, "{f} {e} of {size}"));
        };

        let [mut f, mut expected] = [(); 2].map(|()| vec![0.0; POINTS * COMPONENTS]);
        let [mut g, mut expected_g] = [(); 2].map(|()| vec![0.0; POINTS]);
        cortex.second_many(points, &p, along, [&mut f, &mut g]);
        let lifted = cortex.second_order(&p, &along_a, &along_b);
        second::<COMPONENTS>(&lifted, points, along, [&mut expected, &mut expected_g]);
        near(&f, &expected);
        near(&g, &expected_g);

        let room = || [vec![0.0; POINTS * COMPONENTS], vec![0.0; POINTS]];
        let (mut found, mut expected) = ([room(), room()], [room(), room()]);
        let lifted = cortex.third_order(&p, &along_a);
        jets::third_many(&lifted.shared(), points, along[0], parts(&mut found));
        third::<COMPONENTS>(&lifted, points, along[0], parts(&mut expected));
        found.iter().flatten().zip(expected.iter().flatten()).for_each(|(found, expected)| near(found, expected));

        let mut jacobian = [1, COMPONENTS, 4, 1, COMPONENTS, 4].map(|width| vec![0.0; POINTS * COMPONENTS * width]);
        let [f, fy, fp, g, gy, gp] = jacobian.each_mut().map(|values| &mut values[..]);
        cortex.rhs_jacobian_many(points, &p, &mut PointJacobian { f, fy, fp, g, gy, gp });
        for column in [2, 3] {
            let unit: [f64; 4] = std::array::from_fn(|k| if k == column { 1.0 } else { 0.0 });
            let Lifted { constants, length, pressure } = cortex.second_order(&p, &unit, &[0.0; 4]);
            let expected: Vec<f64> = x
                .iter()
                .zip(y.chunks_exact(COMPONENTS))
                .flat_map(|(&x, y)| {
                    let state: [HyperDual64; COMPONENTS] = std::array::from_fn(|k| HyperDual64::from_re(y[k]));
                    equations(&constants, x, BdfTerm::default(), 1.0, &state, length, pressure).0.map(|f| f.eps1)
                })
                .collect();
            let found: Vec<f64> =
                jacobian[2].chunks_exact(4).take(POINTS * COMPONENTS).map(|row| row[column]).collect();
            near(&found, &expected);
        }
    }
}
