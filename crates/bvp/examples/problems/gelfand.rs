// u″ + λ exp(u/(1 + μu)) = 0 on [0, ½] with a mirror at ½: Bratu's problem with a second parameter. Shared by examples and
// tests.

use bvp::derivatives::PointDirection;
use bvp::{BoundaryJacobian, BoundaryValueProblem, CollocationPoint, Dimensions, Directional, PointJacobian};

/// The problem in y = (u, u′) and p = (λ, μ): u(0) = 0 and u′(½) = 0.
#[derive(Clone, Debug)]
pub struct Gelfand;

/// exp h with h = u/(1 + μu), and the derivatives of h: by u, by μ, by u twice, by u and μ, by μ twice.
fn reaction(u: f64, mu: f64) -> [f64; 6] {
    let d = 1.0 / (1.0 + mu * u);
    let cubed = d * d * d;
    [(u * d).exp(), d * d, -u * u * d * d, -2.0 * mu * cubed, -2.0 * u * cubed, 2.0 * u * u * u * cubed]
}

impl BoundaryValueProblem for Gelfand {
    fn dimensions(&self) -> Dimensions {
        Dimensions { components: 2, integrable: 1, scalars: 2, left: 1, right: 1, integrals: 0 }
    }

    fn rhs(&self, _: CollocationPoint, y: &[f64], p: &[f64], f: &mut [f64], _: &mut [f64]) {
        f.copy_from_slice(&[y[1], -p[0] * reaction(y[0], p[1])[0]]);
    }

    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        self.rhs(at, y, p, out.f, out.g);
        let [w, hu, hm, ..] = reaction(y[0], p[1]);
        out.fy.copy_from_slice(&[0.0, 1.0, -p[0] * w * hu, 0.0]);
        out.fp.copy_from_slice(&[0.0, 0.0, -w, -p[0] * w * hm]);
    }

    fn left(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
        (out.r[0], out.ry[0]) = (y[0], 1.0);
    }

    fn right(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
        (out.r[0], out.ry[1]) = (y[1], 1.0);
    }
}

impl Directional for Gelfand {
    type Second = ();
    type Third = ();

    fn prepare_second(&self, _: &[f64], _: &[f64], _: &[f64]) {}

    fn second(
        &self,
        _: &(),
        _: CollocationPoint,
        y: &[f64],
        p: &[f64],
        a: PointDirection<'_>,
        b: PointDirection<'_>,
        f: &mut [f64],
        _: &mut [f64],
    ) {
        let [w, hu, hm, huu, hum, hmm] = reaction(y[0], p[1]);
        let (da, db) = (hu * a.y[0] + hm * a.p[1], hu * b.y[0] + hm * b.p[1]);
        let second = huu * a.y[0] * b.y[0] + hum * (a.y[0] * b.p[1] + a.p[1] * b.y[0]) + hmm * a.p[1] * b.p[1];
        f[1] = -w * (p[0] * (da * db + second) + a.p[0] * db + b.p[0] * da);
    }

    fn prepare_third(&self, _: &[f64], _: &[f64]) {}

    fn third(
        &self,
        _: &(),
        _: CollocationPoint,
        y: &[f64],
        p: &[f64],
        a: PointDirection<'_>,
        f2: &mut [f64],
        _: &mut [f64],
        f3: &mut [f64],
    ) {
        // Along u alone.
        let [w, hu, _, huu, ..] = reaction(y[0], p[1]);
        let third = 6.0 * p[1] * p[1] * hu * hu;
        let (u, rate) = (a.y[0], -p[0] * w);
        f2[1] = rate * (hu * hu + huu) * u * u;
        f3[1] = rate * (hu * hu * hu + 3.0 * hu * huu + third) * u * u * u;
    }
}
