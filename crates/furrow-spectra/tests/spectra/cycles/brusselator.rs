//! The Brusselator x′ = a − (b + 1)x + x²y, y′ = bx − x²y.

use std::f64::consts::PI;

use super::*;

/// With a given a; the parameter is b.
#[derive(Clone)]
struct Brusselator {
    a: f64,
}

impl VectorField for Brusselator {
    fn components(&self) -> usize {
        2
    }

    fn parameters(&self) -> usize {
        1
    }

    fn velocity<D: Number>(&self, y: &[D], p: &[D], v: &mut [D]) {
        let square = y[0].powi(2) * y[1];
        v[0] = square - y[0] * (p[0] + 1.0) + self.a;
        v[1] = p[0] * y[0] - square;
    }
}

fn hopf_point(a: f64) -> HopfPoint {
    let (problem, guess) = Equilibria::near(Brusselator { a }, &[a, 1.0 / a], &[1.0]);
    let mut branch = Continuation::start(problem, guess, Metric::unit(1, 3), Default::default(), true).unwrap();
    let mut found = hopf_points(&mut branch, [0.0, 2.0 + a * a]);
    assert_eq!(found.len(), 1);
    found.remove(0)
}

/// The Hopf point is at b = 1 + a² with ω = a. Cycles of small radius R next to it have the multiplier exp(πℓ₁R²) if the mode has length
/// 1: their deviation from the equilibrium then has the mean square R²/2.
#[test]
fn the_brusselator_oscillates_from_its_hopf_point_on() {
    for a in [0.7, 1.0, 2.0] {
        let point = hopf_point(a);
        assert!((point.parameter() - (1.0 + a * a)).abs() < 1e-10 && (point.frequency - a).abs() < 1e-10);
        let (gauss, grid) = (Gauss::new(4).unwrap(), mesh::uniform(0.0, 1.0, 30));
        let settings = ContinuationSettings { first_step: 1e-3, max_step: 0.2, ..Default::default() };
        let mut branch = point.cycles(&Brusselator { a }, &gauss, &grid, metric(2, 1.0), settings).unwrap();
        let watch = CycleWatch::start(&mut branch).unwrap();
        let square = 2.0 * 1e-3f64.powi(2);
        let expected = PI * point.lyapunov * square;
        assert!((watch.multipliers.others[0].re.ln() / expected - 1.0).abs() < 1e-3, "{a}: {watch:?} {expected}");
    }
}

/// The period at a = 1, b = 3 is of SciPy's integration of the variational equations with a tolerance of 1e-13.
#[test]
fn the_brusselators_cycle_has_its_period() {
    let (gauss, grid) = (Gauss::new(4).unwrap(), mesh::uniform(0.0, 1.0, 30));
    let settings =
        ContinuationSettings { first_step: 0.05, max_step: 0.5, tolerance: Some(1e-8), ..Default::default() };
    let mut branch = hopf_point(1.0).cycles(&Brusselator { a: 1.0 }, &gauss, &grid, metric(2, 1.0), settings).unwrap();
    let points = watched(&mut branch, [1.9, 3.0], 200, |_, _, _, _| true);
    assert!(points.is_empty());
    let period = PeriodicOrbit::<Brusselator>::period(&branch.state.solution);
    assert!((period - 7.156919921180).abs() < 1e-8, "{period:.12}");
}
