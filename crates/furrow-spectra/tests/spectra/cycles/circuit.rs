//! The electronic circuit of Freire et al., the demo `tor` of AUTO-07p.

use super::*;

/// The parameter is ν.
#[derive(Clone)]
struct Circuit;

impl VectorField for Circuit {
    fn components(&self) -> usize {
        3
    }

    fn parameters(&self) -> usize {
        1
    }

    fn velocity<D: Number>(&self, y: &[D], p: &[D], v: &mut [D]) {
        let (beta, gamma, r, a3, b3) = (0.5, -0.6, 0.6, 0.328578, 0.933578);
        let coupling = (y[1] - y[0]).powi(3) * b3;
        v[0] = (-(p[0] + beta) * y[0] + y[1] * beta - y[0].powi(3) * a3 + coupling) / r;
        v[1] = y[0] * beta - y[1] * (beta + gamma) - y[2] - coupling;
        v[2] = y[1];
    }
}

/// AUTO-07p prints the Hopf point −5.89337E-01, the fold −5.84335E-01 with T = 8.42647, the branch point −5.87029E-01, and on the branch
/// that crosses there the torus −5.91650E-01 with T = 8.79415 and the doubling −6.14955E-01 with T = 9.26630. Further digits are of
/// SciPy's integration of the variational equations with a tolerance of 1e-13.
#[test]
fn the_circuit_has_a_fold_a_branch_point_a_torus_and_a_period_doubling() {
    let (problem, guess) = Equilibria::near(Circuit, &[0.0; 3], &[-0.9]);
    let settings = ContinuationSettings { max_step: 0.05, ..Default::default() };
    let mut still = Continuation::start(problem, guess, Metric::unit(1, 4), settings.clone(), true).unwrap();
    let found = hopf_points(&mut still, [-1.0, -0.52]);
    assert_eq!(found.len(), 1);
    assert!((found[0].parameter() + 0.589336477992).abs() < 1e-10 && found[0].lyapunov < 0.0);
    let (gauss, grid) = (Gauss::new(4).unwrap(), mesh::uniform(0.0, 1.0, 30));
    let settings =
        ContinuationSettings { first_step: 0.01, max_step: 0.05, tolerance: Some(1e-7), ..Default::default() };
    let mut branch = found[0].cycles(&Circuit, &gauss, &grid, metric(3, 1.0), settings).unwrap();
    let mut crossing = None;
    let points = watched(&mut branch, [-0.6, 0.0], 60, |branch, advance, _, _| {
        if advance.passed_branch_point {
            let point = locate::branch_point(branch).unwrap();
            assert!((point.parameter() + 0.587028974364).abs() < 1e-9);
            crossing = Some(point.switch(branch, true).unwrap());
        }
        true
    });
    assert_eq!(points.len(), 1);
    check(&points[0], CycleBifurcation::Fold, [-0.584334771866, 8.426472920], 1e-8);
    let Continuation { problem, metric, settings, .. } = branch;
    let mut other = Continuation::resume(problem, crossing.unwrap(), metric, settings);
    let points = watched(&mut other, [-0.62, 0.0], 60, |_, _, _, _| true);
    assert_eq!(points.len(), 2);
    check(&points[0], CycleBifurcation::Torus, [-0.591650195032, 8.794151746], 1e-8);
    assert!((points[0].angle() - 0.609074095686).abs() < 1e-8);
    check(&points[1], CycleBifurcation::PeriodDoubling, [-0.614955221133, 9.266303321], 1e-8);
    let error = cycles::doubled(&other, &points[0]).err().unwrap();
    assert_eq!(error.to_string(), "no orbits of twice the period branch from a torus");
}
