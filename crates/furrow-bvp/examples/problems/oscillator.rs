// u″ + λ w(u) = 0: with w = eᵘ Bratu's problem, with w = sin u the elastica. Shared by examples and tests.

use furrow_bvp::{
    BoundaryJacobian, BoundaryValueProblem, CollocationPoint, Dimensions, Directional, Gauss, MirrorSymmetric,
    PointDirection, PointJacobian, PointValues, Solution, mesh,
};

/// u″ + λ w = 0 with y = (u, u′): u(0) = 0 and at the right end either u = 0 or, on a mirror-symmetric half, u′ = 0.
#[derive(Clone, Debug)]
pub struct Oscillator {
    pub force: Force,
    /// Component that vanishes at the right end.
    pub right: usize,
}

/// The force w.
#[allow(dead_code, reason = "not every example has a second parameter")]
#[derive(Clone, Debug)]
pub enum Force {
    /// w(u) and its first three derivatives.
    Of(fn(f64) -> [f64; 4]),
    /// w(u, μ) with a second parameter μ: w, w_u, w_uu, w_uuu, w_μ, w_uμ and w_μμ.
    With(fn(f64, f64) -> [f64; 7]),
}

/// w = exp h with h = u/(1 + μu), the problem of Gelfand, which is Bratu's for μ = 0.
#[allow(dead_code, reason = "not every example has a second parameter")]
pub fn gelfand(u: f64, mu: f64) -> [f64; 7] {
    let d = 1.0 / (1.0 + mu * u);
    let (w, cubed) = ((u * d).exp(), d * d * d);
    let [hu, hm] = [d * d, -u * u * d * d];
    let [huu, hum, hmm] = [-2.0 * mu * cubed, -2.0 * u * cubed, 2.0 * u * u * u * cubed];
    let third = hu * hu * hu + 3.0 * hu * huu + 6.0 * mu * mu * hu * hu;
    [w, w * hu, w * (hu * hu + huu), w * third, w * hm, w * (hu * hm + hum), w * (hm * hm + hmm)]
}

#[allow(dead_code, reason = "not every example has both problems")]
impl Oscillator {
    /// Bratu's problem on the whole interval.
    pub fn bratu() -> Oscillator {
        Oscillator { force: Force::Of(|u| [u.exp(); 4]), right: 0 }
    }

    /// The elastica, with this component zero at the right end.
    pub fn elastica(right: usize) -> Oscillator {
        Oscillator { force: Force::Of(|u| [u.sin(), u.cos(), -u.sin(), -u.cos()]), right }
    }

    /// u = 0 on `intervals` of [0, end], which solves where w(0) = 0 or λ = 0.
    pub fn zero(&self, end: f64, intervals: usize, stages: usize, lambda: f64) -> Solution {
        Solution::from_fn(
            &Gauss::new(stages).expect("stages from 1 to 5"),
            &mesh::uniform(0.0, end, intervals),
            2,
            &[lambda],
            |_, y| y.fill(0.0),
        )
        .expect("a mesh")
    }

    fn derivatives(&self, u: f64, p: &[f64]) -> [f64; 7] {
        match self.force {
            Force::Of(w) => {
                let [w, w1, w2, w3] = w(u);
                [w, w1, w2, w3, 0.0, 0.0, 0.0]
            }
            Force::With(w) => w(u, p[1]),
        }
    }
}

/// The component of a direction along μ.
fn along_mu(direction: PointDirection<'_>) -> f64 {
    direction.p.get(1).copied().unwrap_or(0.0)
}

impl BoundaryValueProblem for Oscillator {
    fn dimensions(&self) -> Dimensions {
        let scalars = if matches!(self.force, Force::Of(_)) { 1 } else { 2 };
        Dimensions { components: 2, scalars, left: 1, right: 1, ..Dimensions::default() }
    }

    fn rhs(&self, _: CollocationPoint, y: &[f64], p: &[f64], f: &mut [f64], _: &mut [f64]) {
        f.copy_from_slice(&[y[1], -p[0] * self.derivatives(y[0], p)[0]]);
    }

    fn rhs_jacobian(&self, _: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        let [w, w_u, _, _, w_mu, ..] = self.derivatives(y[0], p);
        out.f.copy_from_slice(&[y[1], -p[0] * w]);
        out.fy.copy_from_slice(&[0.0, 1.0, -p[0] * w_u, 0.0]);
        out.fp[p.len()..].copy_from_slice(&[-w, -p[0] * w_mu][..p.len()]);
    }

    fn left(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
        (out.r[0], out.ry[0]) = (y[0], 1.0);
    }

    fn right(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
        (out.r[0], out.ry[self.right]) = (y[self.right], 1.0);
    }
}

impl Directional for Oscillator {
    fn second(&self, PointValues { y, p, .. }: PointValues, [a, b]: [PointDirection; 2], [f, _]: [&mut [f64]; 2]) {
        let [_, w_u, w_uu, _, w_mu, w_umu, w_mumu] = self.derivatives(y[0], p);
        let ([au, am], [bu, bm]) = ([a.y[0], along_mu(a)], [b.y[0], along_mu(b)]);
        let second = w_uu * au * bu + w_umu * (au * bm + am * bu) + w_mumu * am * bm;
        f[1] = -p[0] * second - a.p[0] * (w_u * bu + w_mu * bm) - b.p[0] * (w_u * au + w_mu * am);
    }

    fn third(&self, PointValues { y, p, .. }: PointValues, a: PointDirection, out: [[&mut [f64]; 2]; 2]) -> bool {
        let [[f2, _], [f3, _]] = out;
        let [_, _, w_uu, w_uuu, ..] = self.derivatives(y[0], p);
        f2[1] = -p[0] * w_uu * a.y[0] * a.y[0];
        f3[1] = -p[0] * w_uuu * a.y[0] * a.y[0] * a.y[0];
        // Along u alone. The others are left to differences.
        a.p.iter().all(|along| *along == 0.0)
    }
}

impl MirrorSymmetric for Oscillator {
    fn vanishing_at_mirror(&self) -> &[usize] {
        &[0]
    }

    fn free_at_mirror(&self) -> &[usize] {
        &[1]
    }
}
