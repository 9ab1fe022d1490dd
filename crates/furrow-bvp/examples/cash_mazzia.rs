//! The 33 test problems of J. R. Cash and F. Mazzia for ε = 1e-1 … 1e-4, from a straight line on ten equal intervals, to a
//! tolerance of 1e-6. Where no exact solution is known, the error is the difference from a solution that was followed from
//! large ε to a tolerance of 1e-9. With the name of a file, writes the time of every solution and values of the reference to it, for
//! `comparison/compare.py`.

use std::fmt::Write;
use std::time::Instant;

use furrow_bvp::{Gauss, Settings, Solution, SolveError, Solved, solve};

#[path = "problems/cash_mazzia.rs"]
mod cash_mazzia;

use cash_mazzia::{TestProblem, largest_difference, problem};

/// The values of ε.
const EPSILON: [f64; 4] = [1e-1, 1e-2, 1e-3, 1e-4];

/// Stages of the collocation.
const STAGES: usize = 4;

/// Intervals of the first mesh.
const INTERVALS: usize = 10;

/// A solution this far from the exact one, over 1 + |value|, is wrong.
const WRONG: f64 = 1e-3;

/// Places at which values are compared with other solvers.
const PLACES: usize = 201;

fn main() -> std::io::Result<()> {
    let mut rows = String::from("problem,epsilon,seconds,values\n");
    let [mut tried, mut solved, mut wrong] = [0; 3];
    println!("problem  ε      intervals  meshes  factorisations  defect   error    condition");
    for number in 1..=33 {
        let mut reference = Reference::new(number);
        for epsilon in EPSILON {
            let Some(mut problem) = problem(number, epsilon) else { continue };
            tried += 1;
            // Of the sixteenth problem up to 5,000 half waves are resolved.
            let max_intervals = if number == 16 { 250_000 } else { Settings::default().max_intervals };
            let settings = Settings { max_intervals, ..Settings::default() };
            let guess = problem.line(STAGES, INTERVALS);
            let outcome = solve(&mut problem, &guess, &settings);
            print!("{number:7}  {epsilon:.0e}  ");
            match &outcome {
                Ok(found) => {
                    let error = problem.error(found).or_else(|| reference.error(found, epsilon));
                    print_row(found, error);
                    solved += 1;
                    wrong += usize::from(error.is_some_and(|error| error > WRONG));
                    let seconds = fastest(|| drop(solve(&mut problem, &guess, &settings)));
                    let values = values(&problem, reference.solution.as_ref().unwrap_or(&found.solution));
                    let _ = writeln!(rows, "{number},{epsilon:e},{seconds:e},{values}");
                }
                Err(error) => println!("{error}"),
            }
        }
    }
    println!("solved {solved} of {tried}, wrong {wrong}");
    std::env::args().nth(1).map_or(Ok(()), |file| std::fs::write(file, rows))
}

/// The shortest of several runs, in seconds.
fn fastest(mut run: impl FnMut()) -> f64 {
    let mut time = || {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64()
    };
    (0..5).map(|_| time()).fold(f64::INFINITY, f64::min)
}

/// Values of the first component at evenly spaced places, the exact ones where they are known.
fn values(problem: &TestProblem, y: &Solution) -> String {
    let ([a, b], gauss, mut value) = (problem.range, y.gauss(), vec![0.0; y.components]);
    let mut at = |k: usize| {
        let x = a + (b - a) * k as f64 / (PLACES - 1) as f64;
        y.eval(&gauss, x, &mut value);
        problem.exact.map_or(value[0], |exact| exact(x, problem.epsilon))
    };
    (0..PLACES).map(|k| format!("{:e}", at(k))).collect::<Vec<_>>().join(" ")
}

fn print_row(found: &Solved, error: Option<f64>) {
    let (intervals, work, defect) = (found.solution.intervals(), found.work, found.defect);
    let error = error.map_or_else(|| "-".to_owned(), |error| format!("{error:.1e}"));
    let (meshes, factorisations) = (work.steps + work.rejected, work.factorisations);
    let condition = found.condition;
    println!("{intervals:9}  {meshes:6}  {factorisations:14}  {defect:.1e}  {error:7}  {condition:.1e}");
}

/// Solutions of one problem for smaller and smaller ε, each from the one before.
struct Reference {
    number: usize,
    epsilon: f64,
    solution: Option<Solution>,
}

impl Reference {
    fn new(number: usize) -> Reference {
        Reference { number, epsilon: 1.0, solution: None }
    }

    /// Largest difference of the first component from the reference.
    fn error(&mut self, y: &Solved, epsilon: f64) -> Option<f64> {
        while self.epsilon > epsilon {
            self.epsilon = epsilon.max(self.epsilon / 1.5);
            self.step()
                .inspect_err(|error| eprintln!("reference of {} at {}: {error}", self.number, self.epsilon))
                .ok()?;
        }
        let (gauss, reference) = (Gauss::default(), self.solution.as_ref()?);
        let mut value = vec![0.0; reference.components];
        let at = |x: f64| {
            reference.eval(&gauss, x, &mut value);
            value[0]
        };
        Some(largest_difference(y, at))
    }

    fn step(&mut self) -> Result<(), SolveError> {
        let Some(mut problem): Option<TestProblem> = problem(self.number, self.epsilon) else { return Ok(()) };
        let guess = self.solution.take().unwrap_or_else(|| problem.line(STAGES, 40));
        let settings = Settings { tolerance: 1e-9, max_intervals: 20_000, ..Settings::default() };
        self.solution = Some(solve(&mut problem, &guess, &settings)?.solution);
        Ok(())
    }
}
