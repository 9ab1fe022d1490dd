//! Lorenz's equations at large ρ.

use super::*;

/// σ = 10, β = 8/3; the parameter is ρ.
#[derive(Clone)]
struct Lorenz;

impl VectorField for Lorenz {
    fn components(&self) -> usize {
        3
    }

    fn parameters(&self) -> usize {
        1
    }

    fn velocity<D: Number>(&self, y: &[D], p: &[D], v: &mut [D]) {
        v[0] = (y[1] - y[0]) * 10.0;
        v[1] = p[0] * y[0] - y[1] - y[0] * y[2];
        v[2] = y[0] * y[1] - y[2] * (8.0 / 3.0);
    }
}

/// A cycle by integration: from where x passes 0 upwards to the next such passage, with its period.
fn cycle(rho: f64) -> ([f64; 3], f64) {
    let mut y = [-4.067, -24.18, 219.0];
    integrated::integrate(&Lorenz, &mut y, &[rho], 40.0, 400_000);
    let (mut begin, mut period) = (None, 0.0);
    loop {
        let before = y;
        integrated::integrate(&Lorenz, &mut y, &[rho], 1e-4, 1);
        period += 1e-4;
        if before[0] < 0.0 && y[0] >= 0.0 {
            match begin {
                None => (begin, period) = (Some(y), 0.0),
                Some(begin) => return (begin, period),
            }
        }
    }
}

/// The demo `lor` of AUTO-07p prints doublings at ρ = 2.29407E+02 with T = 4.80867E-01, 2.18210E+02 with 9.87949E-01 and 2.15966E+02 with
/// 1.98675E+00. Further digits of the first two are of SciPy's integration of the variational equations with a tolerance of 1e-13.
#[test]
fn lorenzs_cycle_doubles_its_period_and_so_do_the_doubled_ones() {
    let (gauss, rho) = (Gauss::new(4).unwrap(), 250.0);
    let (begin, period) = cycle(rho);
    let orbit = |x: f64, y: &mut [f64]| {
        y.copy_from_slice(&begin);
        integrated::integrate(&Lorenz, y, &[rho], x * period, 1 + (x * 5000.0) as usize);
    };
    let grid = mesh::uniform(0.0, 1.0, 40);
    let (problem, guess) = PeriodicOrbit::near(Lorenz, &gauss, &grid, period, &[rho], orbit).unwrap();
    let settings = ContinuationSettings { max_step: 5.0, first_step: 1.0, tolerance: Some(1e-7), ..Default::default() };
    let mut branch = Continuation::start(problem, guess, metric(3, 1.0), settings, false).unwrap();
    let exact = [[229.406708561, 0.480866820311], [218.210127778, 0.987948936383], [215.966, 1.98675]];
    for (exact, digits) in exact.into_iter().zip([1e-8, 1e-8, 6e-4]) {
        let mut twice = None;
        let points = watched(&mut branch, [200.0, 400.0], 200, |branch, _, _, points| {
            twice = points.last().map(|point| cycles::doubled(branch, point).unwrap());
            twice.is_none()
        });
        assert_eq!(points.len(), 1);
        check(&points[0], CycleBifurcation::PeriodDoubling, exact, digits);
        branch = twice.unwrap();
    }
}

/// The cycle from the Hopf point at ρ = 470/19 ends at a homoclinic orbit at ρ = 13.926, where errors of the multipliers are larger than 1.
#[test]
fn errors_next_to_a_homoclinic_orbit_are_no_period_doublings() {
    let x = 24.0f64.sqrt();
    let (problem, guess) = Equilibria::near(Lorenz, &[x, x, 9.0], &[10.0]);
    let mut still = Continuation::start(problem, guess, Metric::unit(1, 4), Default::default(), true).unwrap();
    let hopf = hopf_points(&mut still, [2.0, 40.0]);
    assert!((hopf[0].parameter() - 470.0 / 19.0).abs() < 1e-8);
    let settings = ContinuationSettings { tolerance: Some(1e-7), ..Default::default() };
    let grid = mesh::uniform(0.0, 1.0, 30);
    let mut branch = hopf[0].cycles(&Lorenz, &Gauss::new(4).unwrap(), &grid, metric(3, 0.01), settings).unwrap();
    let mut watch = CycleWatch::start(&mut branch).unwrap();
    branch
        .follow([10.0, 60.0], 60, |branch, advance| {
            assert_eq!(watch.look(branch, advance).unwrap(), []);
            branch.state.solution.scalars[3] < 12.0
        })
        .unwrap();
    assert!((branch.state.parameter() - 13.926557).abs() < 1e-5 && watch.unclear > 0, "{}", watch.unclear);
}
