//! Solves the test problems of Cash and Mazzia to several tolerances, for `comparison/instructions.py`.
//!
//! `cash_mazzia_work places FILE` writes a line for every case: number, ε, the places at which solutions are compared, and the first
//! component there. `cash_mazzia_work FILE TOLERANCE…` solves every case of the file to every tolerance, once, by the function
//! `measured`, and prints number, ε, tolerance, the largest error over 1 + |value| at the places (`inf` if it was not solved), intervals
//! and factorisations.

use std::error::Error;
use std::fmt::Write;

use furrow_bvp::{Settings, Solution, SolveError, Solved, solve};

#[path = "problems/cash_mazzia.rs"]
#[expect(dead_code, reason = "errors are measured at the places of the file")]
mod cash_mazzia;

use cash_mazzia::{TestProblem, problem};

/// Stages of the collocation.
const STAGES: usize = 4;

/// Intervals of the first mesh.
const INTERVALS: usize = 10;

/// Evenly spaced places, and as many again that follow the mesh of a solution.
const PLACES: usize = 200;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match &arguments[..] {
        [places, file] if places == "places" => Ok(std::fs::write(file, all_places())?),
        [file, tolerances @ ..] => {
            let cases = std::fs::read_to_string(file)?;
            for tolerance in tolerances {
                for case in cases.lines() {
                    print_case(case, tolerance)?;
                }
            }
            Ok(())
        }
        [] => Err("a file of places is needed".into()),
    }
}

/// The lines of all cases that have a reference.
fn all_places() -> String {
    let mut out = String::new();
    for number in 1..=33 {
        let (mut followed, mut epsilon) = (None, 1.0);
        for least in [1e-1, 1e-2, 1e-3, 1e-4] {
            while epsilon > least {
                epsilon = f64::max(least, epsilon / 1.5);
                let Some(mut problem) = problem(number, epsilon) else { break };
                followed = follow(&mut problem, followed).inspect_err(|e| eprintln!("{number} at {epsilon}: {e}")).ok();
            }
            let Some(problem) = problem(number, epsilon) else { continue };
            // The last case of problem 16 takes longer than all others together.
            let Some(solution) = followed.as_ref().filter(|_| (number, epsilon) != (16, 1e-4)) else { continue };
            let places = places(solution);
            let (gauss, mut y) = (solution.gauss(), vec![0.0; solution.components]);
            let values = places.iter().map(|&x| {
                solution.eval(&gauss, x, &mut y);
                problem.exact.map_or(y[0], |exact| exact(x, epsilon))
            });
            let _ = writeln!(out, "{number},{epsilon:e},{},{}", joined(places.iter().copied()), joined(values));
        }
    }
    out
}

/// A solution for one ε from that for a larger one.
fn follow(problem: &mut TestProblem, from: Option<Solution>) -> Result<Solution, SolveError> {
    let guess = from.unwrap_or_else(|| problem.line(STAGES, 40));
    let settings = Settings { tolerance: 1e-10, max_intervals: 40_000, ..Settings::default() };
    match solve(problem, &guess, &settings) {
        Ok(Solved { solution, .. }) => Ok(solution),
        Err(SolveError::Rounding { best }) if best.defect < 1e-8 => Ok(best.solution),
        Err(error) => Err(error),
    }
}

fn places(solution: &Solution) -> Vec<f64> {
    let (mesh, last) = (&solution.mesh, solution.intervals());
    let even = |k: usize| mesh[0] + (mesh[last] - mesh[0]) * k as f64 / PLACES as f64;
    let node = |k: usize| 0.5 * (mesh[k * last / PLACES] + mesh[(k * last / PLACES + 1).min(last)]);
    let mut all: Vec<f64> = (0..PLACES).map(even).chain((0..PLACES).map(node)).collect();
    all.sort_by(f64::total_cmp);
    all
}

fn joined(values: impl Iterator<Item = f64>) -> String {
    values.map(|value| format!("{value:e}")).collect::<Vec<_>>().join(" ")
}

fn print_case(case: &str, tolerance: &str) -> Result<(), Box<dyn Error>> {
    let [number, epsilon, places, values] = case.split(',').collect::<Vec<_>>()[..] else {
        return Err(format!("not a case: {case}").into());
    };
    let Some(mut problem) = problem(number.parse()?, epsilon.parse()?) else { return Err("no such case".into()) };
    let settings = Settings { tolerance: tolerance.parse()?, ..Settings::default() };
    let guess = problem.line(STAGES, INTERVALS);
    let outcome = measured(&mut problem, &guess, &settings);
    let (mut error, [mut intervals, mut factorisations]) = (f64::INFINITY, [0; 2]);
    if let Ok(solved) = &outcome {
        let Solved { solution, work, .. } = solved;
        (error, intervals, factorisations) = (0.0, solution.intervals(), work.factorisations);
        let (gauss, mut y) = (solution.gauss(), vec![0.0; solution.components]);
        for (x, value) in places.split(' ').zip(values.split(' ')) {
            let (x, value): (f64, f64) = (x.parse()?, value.parse()?);
            solved.eval(&gauss, x, &mut y);
            error = error.max((y[0] - value).abs() / (1.0 + value.abs()));
        }
    }
    println!("{number},{epsilon},{tolerance},{error:.3e},{intervals},{factorisations}");
    Ok(())
}

#[inline(never)]
fn measured(problem: &mut TestProblem, guess: &Solution, settings: &Settings) -> Result<Solved, SolveError> {
    // Something has to be left to do here, or the call is a jump, which callgrind does not see return.
    std::hint::black_box(solve(problem, guess, settings))
}
