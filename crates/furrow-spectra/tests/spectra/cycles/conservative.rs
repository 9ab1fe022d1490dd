//! A family of orbits at a fixed parameter.

use super::*;

/// y″ = −2y + y² and x″ = −x − 2xy, both with a force p times the velocity: at p = 0 the energy stays.
#[derive(Clone)]
struct Springs;

impl VectorField for Springs {
    fn components(&self) -> usize {
        4
    }

    fn parameters(&self) -> usize {
        1
    }

    fn velocity<D: Number>(&self, y: &[D], p: &[D], v: &mut [D]) {
        v[..2].copy_from_slice(&y[2..]);
        v[2] = -y[0] - y[0] * y[1] * 2.0 + p[0] * y[2];
        v[3] = y[1] * -2.0 - y[0].powi(2) + y[1].powi(2) + p[0] * y[3];
    }
}

/// Two multipliers are 1 for all energies. At y = 1.6 or so the two others are as well.
#[test]
fn multipliers_at_one_are_no_torus() {
    let (_, solution) = Equilibria::near(Springs, &[0.0; 4], &[0.0]);
    let frequency = 2f64.sqrt();
    let mode = [vec![0.0, 1.0, 0.0, 0.0], vec![0.0, 0.0, 0.0, frequency]];
    let hopf = HopfPoint { solution, arclength: 0.0, frequency, lyapunov: 0.0, mode };
    let settings =
        ContinuationSettings { first_step: 0.02, max_step: 0.1, tolerance: Some(1e-8), ..Default::default() };
    let (gauss, grid) = (Gauss::new(4).unwrap(), mesh::uniform(0.0, 1.0, 30));
    let mut branch = hopf.cycles(&Springs, &gauss, &grid, metric(4, 1.0), settings).unwrap();
    let found = watched(&mut branch, [-1.0, 1.0], 24, |_, _, _, _| true);
    assert!(PeriodicOrbit::<Springs>::period(&branch.state.solution) > 7.0);
    assert!(found.iter().all(|point| point.bifurcation == CycleBifurcation::PeriodDoubling), "{found:?}");
}
