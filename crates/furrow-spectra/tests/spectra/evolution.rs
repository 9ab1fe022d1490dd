//! Hopf points of steady states with diffusion.

use std::f64::consts::PI;

use furrow_bvp::{
    Auto, BoundaryValueProblem, Continuation, ContinuationSettings, Dimensions, DualNum, Equations, Metric, Number,
    SimpleProblem, Solution, mesh,
};
use furrow_spectra::Arnoldi;
use furrow_spectra::evolution::{Evolution, EvolutionError, EvolutionWatch, MassTerm, SteadyHopfPoint};

fn evolution(wanted: usize) -> Evolution {
    let mass = [0, 1].map(|k| MassTerm { row: k + 2, column: k, coefficient: 1.0 }).to_vec();
    Evolution { mass, arnoldi: Arnoldi { wanted, tolerance: 1e-11, ..Default::default() } }
}

fn hopf_points<P: BoundaryValueProblem>(
    branch: &mut Continuation<P>,
    wanted: usize,
    range: [f64; 2],
) -> Vec<SteadyHopfPoint> {
    let (mut watch, mut all) = (EvolutionWatch::start(evolution(wanted), branch).unwrap(), Vec::new());
    let ended = branch.follow(range, 300, |branch, _| {
        all.extend(watch.look(branch).unwrap());
        true
    });
    ended.unwrap();
    all
}

/// The Brusselator with diffusion, with fixed values at both ends; the demo `brc` of AUTO-07p with five collocation points has Hopf
/// points at ℓ = 0.513070, 1.02515, 1.59033. The mode sin kπx grows from b − 1 − a² = (D₁ + D₂)(kπ/ℓ)² on.
#[test]
fn modes_of_the_brusselator_oscillate_one_after_the_other() {
    let (a, b, diffusion) = (2.0, 5.45, [0.008, 0.004]);
    let problem = SimpleProblem::new(4, move |_, y, p, f| {
        let reaction = y[0].powi(2) * y[1];
        f[0] = y[2] * p[0].powi(2) / diffusion[0];
        f[1] = y[3] * p[0].powi(2) / diffusion[1];
        f[2] = y[0] * (b + 1.0) - reaction - a;
        f[3] = reaction - y[0] * b;
    })
    .scalars(1)
    .left_conditions(2, move |y, _, r| (r[0], r[1]) = (y[0] - a, y[1] - b / a))
    .right_conditions(2, move |y, _, r| (r[0], r[1]) = (y[0] - a, y[1] - b / a));
    let guess = Solution::constant(4, &mesh::uniform(0.0, 1.0, 20), &[a, b / a, 0.0, 0.0], &[0.4]);
    let settings = ContinuationSettings { max_step: 0.05, ..Default::default() };
    let mut branch = Continuation::start(problem, guess, Metric::unit(4, 1), settings, true).unwrap();
    let found = hopf_points(&mut branch, 8, [0.0, 1.7]);
    assert_eq!(found.len(), 3);
    for (k, point) in (1..).zip(found) {
        let length = f64::from(k) * PI * (0.012f64 / 0.45).sqrt();
        let square = 0.45 / 0.012;
        let [first, second] = diffusion.map(|d| d * square);
        let frequency = ((first + 1.0 - b) * (second + a * a) + a * a * b).sqrt();
        assert!((point.parameter() - length).abs() < 1e-8 && point.error < 1e-8, "{k}: {point:?}");
        assert!((point.frequency - frequency).abs() < 1e-7, "{k}: {} {frequency}", point.frequency);
    }
}

/// Conversion c and temperature θ in a tubular reactor, c_t = c″/5 − c′ − r, θ_t = θ″/5 − θ′ − 3.5 (θ − 1) + r/2,
/// r = δ c exp(25 − 25/θ), as y = (c, θ, c′/5 − c, θ′/5 − θ).
struct Reactor;

impl Equations for Reactor {
    fn dimensions(&self) -> Dimensions {
        Dimensions { components: 4, scalars: 1, left: 2, right: 2, ..Dimensions::default() }
    }

    fn rhs<D: Number>(&self, _: f64, y: &[D], p: &[D], f: &mut [D]) {
        let reaction = p[0] * y[0] * (-y[1].recip() * 25.0 + 25.0).exp();
        f[0] = (y[2] + y[0]) * 5.0;
        f[1] = (y[3] + y[1]) * 5.0;
        f[2] = reaction;
        f[3] = (y[1] - 1.0) * 3.5 - reaction * 0.5;
    }

    fn left<D: Number>(&self, y: &[D], _: &[D], r: &mut [D]) {
        (r[0], r[1]) = (y[2] + 1.0, y[3] + 1.0);
    }

    fn right<D: Number>(&self, y: &[D], _: &[D], r: &mut [D]) {
        (r[0], r[1]) = (y[2] + y[0], y[3] + y[1]);
    }
}

fn reactor(parameter: f64) -> Continuation<Auto<Reactor>> {
    let guess = Solution::constant(4, &mesh::uniform(0.0, 1.0, 20), &[1.0, 1.0, -1.0, -1.0], &[parameter]);
    let settings =
        ContinuationSettings { max_step: 0.02, first_step: 0.01, tolerance: Some(1e-6), ..Default::default() };
    Continuation::start(Auto(Reactor), guess, Metric::unit(4, 1), settings, true).unwrap()
}

/// The values are of SciPy's generalised eigenvalues for Chebyshev collocation at 57 and 71 points, which agree in the digits given.
#[test]
fn a_reactor_oscillates_between_two_hopf_points() {
    let mut branch = reactor(0.05);
    let found = hopf_points(&mut branch, 6, [0.0, 0.34]);
    assert_eq!(found.len(), 2, "{found:?}");
    for (point, [parameter, frequency]) in
        found.iter().zip([[0.261440774577, 1.552857810], [0.295230906093, 5.378358224]])
    {
        assert!((point.parameter() - parameter).abs() < 1e-8, "{} {parameter}", point.parameter());
        assert!((point.frequency - frequency).abs() < 1e-7, "{} {frequency}", point.frequency);
        assert!(point.error < 1e-8);
    }
}

#[test]
fn components_that_do_not_exist_are_refused() {
    let mut branch = reactor(0.05);
    let mut wrong = evolution(2);
    wrong.mass[0].row = 4;
    let refused = EvolutionWatch::start(wrong, &mut branch).err().unwrap();
    assert!(matches!(refused, EvolutionError::Invalid(_)));
    assert_eq!(refused.to_string(), "component 4 does not exist: there are 4, counted from 0");
}
