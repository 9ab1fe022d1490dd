//! Duffing's oscillator x″ + δx′ + αx + βx³ = γ cos ωt, with cos ωt as the first component of an oscillator of its own, so that time does
//! not appear.

use super::*;

/// With β = 1.
#[derive(Clone)]
struct Duffing {
    delta: f64,
    alpha: f64,
    /// γ is the parameter, with this ω; otherwise ω is, with γ = 1.
    frequency: Option<f64>,
}

impl VectorField for Duffing {
    fn components(&self) -> usize {
        4
    }

    fn parameters(&self) -> usize {
        1
    }

    fn velocity<D: Number>(&self, y: &[D], p: &[D], v: &mut [D]) {
        let (amplitude, omega) = self.frequency.map_or((D::from(1.0), p[0]), |omega| (p[0], D::from(omega)));
        let size = y[2].powi(2) + y[3].powi(2);
        v[0] = y[1];
        v[1] = -y[1] * self.delta - y[0] * self.alpha - y[0].powi(3) + amplitude * y[2];
        v[2] = y[2] - omega * y[3] - y[2] * size;
        v[3] = omega * y[2] + y[3] - y[3] * size;
    }
}

/// The branch of the cycle that the oscillator tends to from a point.
fn branch(field: Duffing, parameter: f64, from: [f64; 2], upwards: bool) -> CycleBranch<Duffing> {
    let omega = field.frequency.unwrap_or(parameter);
    let period = std::f64::consts::TAU / omega;
    let mut begin = [from[0], from[1], 1.0, 0.0];
    integrated::integrate(&field, &mut begin, &[parameter], 60.0 * period, 60_000);
    let orbit = |x: f64, y: &mut [f64]| {
        y.copy_from_slice(&begin);
        integrated::integrate(&field, y, &[parameter], x * period, 1 + (x * 1000.0) as usize);
    };
    let (gauss, grid) = (Gauss::new(4).unwrap(), mesh::uniform(0.0, 1.0, 30));
    let (problem, guess) = PeriodicOrbit::near(field.clone(), &gauss, &grid, period, &[parameter], orbit).unwrap();
    let settings =
        ContinuationSettings { first_step: 0.02, max_step: 0.2, tolerance: Some(1e-7), ..Default::default() };
    Continuation::start(problem, guess, metric(4, 1.0), settings, upwards).unwrap()
}

/// With δ = 0.3, α = −1, β = 1, ω = 1.2 the period is doubled at γ = 0.28 and not yet at γ = 0.2. The place is of Newton's method for
/// the map of a period, by SciPy with a tolerance of 3e-14.
#[test]
fn the_oscillation_in_one_well_doubles_its_period() {
    let field = Duffing { delta: 0.3, alpha: -1.0, frequency: Some(1.2) };
    let mut branch = branch(field, 0.1, [1.0, 0.0], true);
    let points = watched(&mut branch, [0.0, 0.28], 100, |_, _, _, _| true);
    assert_eq!(points.len(), 1);
    let period = std::f64::consts::TAU / 1.2;
    check(&points[0], CycleBifurcation::PeriodDoubling, [0.265581786055628, period], 1e-8);
}

/// The response of a spring that hardens, δ = 0.2, α = β = γ = 1, jumps down at one ω and up at another. The places are of Newton's
/// method for the map of a period and det(M − 1) = 0, by SciPy with a tolerance of 3e-14.
#[test]
fn the_response_jumps_at_two_folds() {
    let field = Duffing { delta: 0.2, alpha: 1.0, frequency: None };
    let mut branch = branch(field, 1.1, [1.0, 0.0], true);
    let points = watched(&mut branch, [1.0, 2.4], 200, |_, _, _, _| true);
    assert_eq!(points.len(), 2);
    for (point, omega) in points.iter().zip([2.2131659546288, 1.6353055513376]) {
        check(point, CycleBifurcation::Fold, [omega, std::f64::consts::TAU / omega], 1e-8);
    }
}
