//! Further solutions of problems with several.

use std::f64::consts::PI;

use furrow_bvp::{Deflation, DeflationError, DualNum, Gauss, Metric, Settings, SimpleProblem, Solution, mesh};

fn ends_at_zero(
    rhs: impl Fn(f64, &[furrow_bvp::Jet], &mut [furrow_bvp::Jet]) + Send + Sync + 'static,
) -> SimpleProblem {
    SimpleProblem::new(2, move |x, y, _, f| rhs(x, y, f))
        .left_conditions(1, |y, _, r| r[0] = y[0])
        .right_conditions(1, |y, _, r| r[0] = y[0])
}

/// The search, with distances in the first component alone.
fn search() -> Deflation {
    Deflation {
        settings: Settings { tolerance: 1e-7, ..Settings::default() },
        metric: Some(Metric { components: vec![1.0, 0.0], scalars: Vec::new() }),
        ..Deflation::default()
    }
}

fn slopes(found: &[furrow_bvp::Solved]) -> Vec<f64> {
    let mut slopes: Vec<f64> = found.iter().map(|solved| solved.solution.node(0)[1]).collect();
    slopes.sort_by(f64::total_cmp);
    slopes
}

/// Bratu's problem with λ = 1: u′(0) = θ tanh(θ/4) with the two roots of θ = √2 cosh(θ/4).
#[test]
fn bratu_has_two_solutions() {
    let mut bratu = ends_at_zero(|_, y, f| (f[0], f[1]) = (y[1], -y[0].exp()));
    let guess = Solution::constant(4, &mesh::uniform(0.0, 1.0, 10), &[0.0, 0.0], &[]);
    let found = search().solve_all(&mut bratu, std::slice::from_ref(&guess), 10).unwrap();
    let exact = [1.517_164_598_978_f64, 10.938_702_772_107].map(|theta| theta * (theta / 4.0).tanh());
    assert_eq!(found.len(), 2, "{:?}", slopes(&found));
    for (slope, exact) in slopes(&found).iter().zip(exact) {
        assert!((slope - exact).abs() < 1e-6, "{slope} {exact}");
    }
    let known: Vec<Solution> = found.into_iter().map(|solved| solved.solution).collect();
    let none = search().solve(&mut bratu, &guess, &known);
    assert!(matches!(none, Err(DeflationError::NotFound { known: 2, .. })), "{none:?}");
}

#[test]
fn a_known_solution_on_another_interval_is_refused() {
    let mut bratu = ends_at_zero(|_, y, f| (f[0], f[1]) = (y[1], -y[0].exp()));
    let on = |to| Solution::constant(4, &mesh::uniform(0.0, to, 10), &[0.0, 0.0], &[]);
    let refused = search().solve(&mut bratu, &on(1.0), &[on(1.5)]).unwrap_err();
    assert_eq!(refused.to_string(), "a known solution from 0 to 1.5, and the problem is from 0 to 1");
}

/// u″ + λ(u − u³) = 0 on a length of 1 with π² < λ = 20 < 4π²: 0 and ±u.
#[test]
fn a_cubic_has_three_solutions() {
    let mut cubic = ends_at_zero(|_, y, f| (f[0], f[1]) = (y[1], (y[0].powi(3) - y[0]) * 20.0));
    let guess = Solution::constant(4, &mesh::uniform(0.0, 1.0, 10), &[0.3, 0.0], &[]);
    let found = search().solve_all(&mut cubic, &[guess], 10).unwrap();
    let slopes = slopes(&found);
    assert_eq!(slopes.len(), 3, "{slopes:?}");
    assert!((slopes[0] + slopes[2]).abs() < 1e-6 && slopes[1].abs() < 1e-8 && slopes[2] > 1.0, "{slopes:?}");
}

/// Carrier's problem ε²y″ + 2(1 − x²)y + y² = 1 on [−1, 1], y(±1) = 0, with ε = 0.1. Chebyshev collocation at 129 points and 5,375 random
/// starts of Newton's method in NumPy find sixteen solutions: y(0) and y′(0), which has the other sign for the mirror image.
const CARRIER: [[f64; 2]; 12] = [
    [-2.40210472, 0.0],
    [-2.40209027, 0.00024180],
    [-2.40207583, 0.0],
    [-1.53965204, 0.0],
    [-1.52030756, 1.37873626],
    [-1.50865115, 0.0],
    [-0.74531113, 0.0],
    [0.68376220, 19.24155541],
    [1.52405025, 0.0],
    [1.78595805, 0.0],
    [1.78604286, 0.20244929],
    [1.78619748, 0.0],
];

#[test]
fn carriers_problem_has_many_solutions_and_no_wrong_one_is_found() {
    let mut carrier = ends_at_zero(|x, y, f| {
        f[0] = y[1];
        f[1] = (-y[0].powi(2) - y[0] * (2.0 * (1.0 - x * x)) + 1.0) * 100.0;
    });
    let (gauss, grid) = (Gauss::new(4).unwrap(), mesh::uniform(-1.0, 1.0, 60));
    // Waves with changing shares, and their mirror images.
    let guess = |k: i32, sign: f64| {
        let wave = |x: f64, y: &mut [f64]| {
            y.copy_from_slice(&[-0.5, 0.0]);
            for j in 1..=12 {
                let rate = 0.5 * f64::from(j) * PI;
                let share = 2.0 * (f64::from(k * j * (j + 3)) * 0.7).sin() / f64::from(j).sqrt();
                y[0] += share * (rate * (sign * x + 1.0)).sin();
                y[1] += share * sign * rate * (rate * (sign * x + 1.0)).cos();
            }
        };
        Solution::from_fn(&gauss, &grid, 2, &[], wave).unwrap()
    };
    let guesses: Vec<Solution> = (0..12).flat_map(|k| [guess(k, 1.0), guess(k, -1.0)]).collect();
    let search = Deflation { max_iterations: 60, ..search() };
    let found = search.solve_all(&mut carrier, &guesses, 40).unwrap();
    let mut middles = Vec::new();
    for solved in &found {
        let mut y = [0.0; 2];
        solved.solution.eval(&gauss, 0.0, &mut y);
        let near = |[value, slope]: &&[f64; 2]| (y[0] - value).abs() < 1e-6 && (y[1].abs() - slope).abs() < 1e-5;
        assert!(CARRIER.iter().any(|known| near(&known)), "{y:?}");
        middles.push(y);
    }
    assert!(middles.len() >= 12, "{}: {middles:?}", middles.len());
}
