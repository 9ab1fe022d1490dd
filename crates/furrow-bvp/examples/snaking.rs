//! The Swift–Hohenberg equation 0 = ru − (1 + ∂²)²u + 1.8u² − u³ on [0, 20π], even about both ends. The branch of patterns that
//! fill part of the domain snakes between two values of r: every pair of folds adds a wave at the front. Compares the folds with
//! an expansion in 384 cosines.

use std::f64::consts::PI;

use furrow_bvp::{
    Auto, Continuation, ContinuationSettings, Dimensions, Equations, Gauss, Metric, Number, Solution, locate, mesh,
};

/// r at the folds, by Newton on the cosine coefficients with the null vector.
const FOLDS: [f64; 8] = [
    -0.288_710_311,
    -0.251_090_021,
    -0.337_787_891,
    -0.259_246_348,
    -0.339_015_997,
    -0.259_263_804,
    -0.339_027_680,
    -0.259_263_843,
];

/// y = (u, u′, u″, u‴).
#[derive(Clone)]
struct SwiftHohenberg;

impl Equations for SwiftHohenberg {
    fn dimensions(&self) -> Dimensions {
        Dimensions { components: 4, scalars: 1, left: 2, right: 2, ..Dimensions::default() }
    }
    fn rhs<D: Number>(&self, _x: f64, y: &[D], p: &[D], f: &mut [D]) {
        let u = y[0];
        f[..3].copy_from_slice(&y[1..]);
        f[3] = p[0] * u - u - y[2] * 2.0 + u.powi(2) * 1.8 - u.powi(3);
    }
    fn left<D: Number>(&self, y: &[D], _p: &[D], r: &mut [D]) {
        r.copy_from_slice(&[y[1], y[3]]);
    }
    fn right<D: Number>(&self, y: &[D], p: &[D], r: &mut [D]) {
        self.left(y, p, r);
    }
}

/// H = u′u‴ − u″²/2 + u′² + (1 − r)u²/2 − 0.6u³ + u⁴/4 does not change along x.
fn hamiltonian(y: &[f64], r: f64) -> f64 {
    let u = y[0];
    y[1] * y[3] - 0.5 * y[2] * y[2] + y[1] * y[1] + 0.5 * (1.0 - r) * u * u - 0.6 * u.powi(3) + 0.25 * u.powi(4)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A few waves next to the left end, u = ⅗ cos x / cosh(x/4), and its derivatives as if the envelope were constant.
    let pulse = |x: f64, y: &mut [f64]| {
        let envelope = 0.6 / (0.25 * x).cosh();
        let (cos, sin) = (envelope * x.cos(), envelope * x.sin());
        y.copy_from_slice(&[cos, -sin, -cos, sin]);
    };
    let guess = Solution::from_fn(&Gauss::default(), &mesh::uniform(0.0, 20.0 * PI, 160), 4, &[-0.2], pulse)?;
    let metric = Metric { components: vec![0.1; 4], scalars: vec![1.0] };
    let settings = ContinuationSettings { tolerance: Some(1e-7), ..ContinuationSettings::default() };
    let mut branch = Continuation::start(Auto(SwiftHohenberg), guess, metric, settings, false)?;
    println!("r at fold       by cosines    range of H along x");
    for exact in FOLDS {
        branch.follow([-1.0, 0.0], 400, |_, advance| !advance.passed_fold)?;
        let fold = locate::last_fold(&mut branch)?.solution;
        let r = fold.scalars[0];
        let along = (0..=fold.intervals()).map(|k| hamiltonian(fold.node(k), r));
        let [least, most] = along.fold([f64::MAX, f64::MIN], |[a, b], h| [a.min(h), b.max(h)]);
        println!("{r:.9}    {exact:.9}  {:.1e}", most - least);
    }
    println!("{} steps, {} factorisations", branch.work.steps, branch.work.factorisations);
    Ok(())
}
