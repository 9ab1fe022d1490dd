//! Periodic orbits that change beyond recognition along their branch.

use std::f64::consts::TAU;

use furrow_bvp::{
    Continuation, ContinuationError, ContinuationSettings, Gauss, Metric, Number, PeriodicOrbit, Termination,
    VectorField, mesh,
};

const EPSILON: f64 = 0.01;

/// FitzHugh and Nagumo's v′ = v − v³/3 − w, w′ = ε(v + a).
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

/// A small circle about the Hopf point at a = 1 explodes at a = 1 − ε/8 − 3ε²/32 − 173ε³/1024, over a range of exp(−1/ε) in a.
/// The relaxation oscillations that follow have jumps at other places than the first orbit.
#[test]
fn a_canard_explosion_is_passed_and_relaxation_oscillations_are_followed() {
    let (gauss, grid) = (Gauss::new(4).unwrap(), mesh::uniform(0.0, 1.0, 40));
    let (a, radius, frequency) = (0.9999, 0.02, EPSILON.sqrt());
    let circle = |x: f64, y: &mut [f64]| {
        let (sine, cosine) = (TAU * x).sin_cos();
        y.copy_from_slice(&[radius * cosine - a, a * a * a / 3.0 - a + radius * frequency * sine]);
    };
    let (problem, guess) = PeriodicOrbit::near(FitzHughNagumo, &gauss, &grid, TAU / frequency, &[a], circle).unwrap();
    let mut metric = Metric::unit(2, 4);
    metric.scalars[2] = 1e-4;
    let settings =
        ContinuationSettings { tolerance: Some(1e-5), first_step: 1e-3, max_step: 0.2, ..Default::default() };
    let mut branch = Continuation::start(problem, guess, metric, settings, false).unwrap();
    let mut growing = Vec::new();
    let ended = branch.follow([0.6, 1.01], 1000, |branch, _| {
        let height = branch.state.solution.nodes.chunks(2).fold(f64::NEG_INFINITY, |most, y| most.max(y[0]));
        if (0.0..1.0).contains(&height) {
            growing.push(branch.state.parameter());
        }
        true
    });
    assert_eq!(ended, Ok(Termination::ParameterBound(0.6)));
    let series = 1.0 - EPSILON / 8.0 - 3.0 * EPSILON.powi(2) / 32.0 - 173.0 * EPSILON.powi(3) / 1024.0;
    assert!(growing.len() > 5);
    for a in growing {
        assert!((a - 0.998740451).abs() < 1e-8 && (a - series).abs() < 1e-8, "{a} {series}");
    }
    // Two slow passages: v falls from 2 to 1 on dt = (1 − v²)/(v + a) dv/ε, and rises from −2 to −1.
    let period = PeriodicOrbit::<FitzHughNagumo>::period(&branch.state.solution);
    let a = 0.6f64;
    let passage = |from: f64, to: f64| {
        let primitive = |v: f64| a * v - 0.5 * v * v + (1.0 - a * a) * (v + a).abs().ln();
        (primitive(to) - primitive(from)) / EPSILON
    };
    let slow = passage(2.0, 1.0) + passage(-2.0, -1.0);
    assert!(period > slow && period < 1.4 * slow, "{period} {slow}");
}

/// Cycles of the radius √p about (3, 0), with the period 2π.
#[derive(Clone)]
struct Circles;

impl VectorField for Circles {
    fn components(&self) -> usize {
        2
    }

    fn parameters(&self) -> usize {
        1
    }

    fn velocity<D: Number>(&self, y: &[D], p: &[D], v: &mut [D]) {
        let x = y[0] - 3.0;
        let growth = p[0] - x.powi(2) - y[1].powi(2);
        (v[0], v[1]) = (growth * x - y[1], growth * y[1] + x);
    }
}

/// The branch of circles from a guess of a radius, towards smaller p.
fn circles(
    radius: f64,
    parameter: f64,
    tolerance: Option<f64>,
) -> Result<Continuation<furrow_bvp::Auto<PeriodicOrbit<Circles>>>, ContinuationError> {
    let orbit = |x: f64, y: &mut [f64]| {
        let (sine, cosine) = (TAU * x).sin_cos();
        y.copy_from_slice(&[3.0 + radius * cosine, radius * sine]);
    };
    let grid = mesh::uniform(0.0, 1.0, 12);
    let (problem, guess) = PeriodicOrbit::near(Circles, &Gauss::new(4).unwrap(), &grid, TAU, &[parameter], orbit)?;
    let metric = Metric { components: vec![1.0; 2], scalars: vec![0.0, 0.0, 0.0, 1.0] };
    let settings = ContinuationSettings { tolerance, max_step: 0.1, ..Default::default() };
    Continuation::start(problem, guess, metric, settings, false)
}

#[test]
fn a_branch_of_cycles_ends_at_its_hopf_point() {
    for tolerance in [None, Some(1e-7)] {
        let mut branch = circles(0.7, 0.5, tolerance).unwrap();
        let ended = branch.follow([-1.0, 1.0], 200, |_, advance| !advance.passed_fold);
        assert_eq!(ended, Ok(Termination::Degenerate), "{tolerance:?}");
        let parameter = branch.state.parameter();
        assert!((0.0..1e-2).contains(&parameter), "{tolerance:?}: {parameter}");
    }
}

#[test]
fn an_equilibrium_is_no_cycle() {
    let refused = circles(0.1, 0.5, None).err().unwrap();
    assert!(matches!(refused, ContinuationError::Degenerate { .. }), "{refused:?}");
}
