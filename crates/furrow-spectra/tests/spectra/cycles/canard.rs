//! FitzHugh and Nagumo's canard explosion.

use super::*;

const EPSILON: f64 = 0.01;

/// v′ = v − v³/3 − w, w′ = ε(v + a); the parameter is a.
#[derive(Clone)]
struct FitzHughNagumo;

impl VectorField for FitzHughNagumo {
    fn components(&self) -> usize {
        2
    }

    fn parameters(&self) -> usize {
        1
    }

    fn velocity<D: Number>(&self, y: &[D], p: &[D], v: &mut [D]) {
        v[0] = y[0] - y[0].powi(3) / 3.0 - y[1];
        v[1] = (y[0] + p[0]) * EPSILON;
    }
}

/// ∫ ∂v′/∂v dt over a cycle. Its exponential is the multiplier other than 1.
fn divergence(y: &Solution, gauss: &Gauss) -> f64 {
    let widths = y.mesh.windows(2).map(|x| y.scalars[2] * (x[1] - x[0]));
    let of_interval = |i: usize| (0..4).map(move |j| gauss.b[j] * (1.0 - y.stage(i, j)[0].powi(2))).sum::<f64>();
    widths.enumerate().map(|(i, h)| h * of_interval(i)).sum()
}

/// The equilibrium (−a, a³/3 − a) loses its stability at a = 1 with ω = √ε. With a = 1 + μ and coordinates x, √ε y there,
/// ℓ₁ = −5/(1 + ε) where the mode has length 1. The explosion is at a = 0.998740451, and no cycle on the way has a bifurcation, though
/// disturbances grow by more than 1e40 on it and decay by more, which no product of transitions gives.
#[test]
fn a_canard_explosion_begins_at_its_hopf_point_and_is_stable_all_along() {
    let (problem, guess) = Equilibria::near(FitzHughNagumo, &[-1.1, -0.66], &[1.1]);
    let settings = ContinuationSettings { max_step: 0.05, ..Default::default() };
    let mut branch = Continuation::start(problem, guess, Metric::unit(1, 3), settings, false).unwrap();
    let found = hopf_points(&mut branch, [0.9, 1.2]);
    assert_eq!(found.len(), 1);
    assert!((found[0].parameter() - 1.0).abs() < 1e-12 && (found[0].frequency - EPSILON.sqrt()).abs() < 1e-12);
    assert!((found[0].lyapunov + 5.0 / (1.0 + EPSILON)).abs() < 1e-10, "{}", found[0].lyapunov);
    let (gauss, grid) = (Gauss::new(4).unwrap(), mesh::uniform(0.0, 1.0, 40));
    let settings =
        ContinuationSettings { first_step: 0.003, max_step: 0.2, tolerance: Some(1e-6), ..Default::default() };
    let mut branch = found[0].cycles(&FitzHughNagumo, &gauss, &grid, metric(2, 1.0), settings).unwrap();
    // A small cycle of radius R has the multiplier exp(πℓ₁R²).
    let multiplier = CycleWatch::start(&mut branch).unwrap().multipliers.others[0].re;
    let square = 2.0 * 0.003f64.powi(2);
    assert!((multiplier.ln() / (std::f64::consts::PI * square) / found[0].lyapunov - 1.0).abs() < 0.02);
    let (mut growing, mut smallest) = (Vec::new(), 0.0f64);
    let points = watched(&mut branch, [0.9, 1.0], 400, |branch, _, multipliers, _| {
        let y = &branch.state.solution;
        let height = y.nodes.chunks(2).fold(f64::NEG_INFINITY, |most, y| most.max(y[0]));
        let (found, exact) = (multipliers.others[0].re.ln(), divergence(y, &gauss));
        assert!((found - exact).abs() < 1e-9 * (1.0 + exact.abs()) || exact < -700.0, "{height}: {found} {exact}");
        smallest = smallest.min(exact);
        if (0.0..1.0).contains(&height) {
            growing.push(branch.state.parameter());
        }
        true
    });
    assert!(points.is_empty(), "{points:?}");
    assert!(growing.len() > 5 && growing.iter().all(|a| (a - 0.998740451246).abs() < 1e-11), "{growing:?}");
    assert!(smallest < -200.0, "{smallest}");
}
