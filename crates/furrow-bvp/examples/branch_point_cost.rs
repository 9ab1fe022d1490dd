//! What five branch points add to the time of a branch: found, located, and switched at to both sides. The same branch without looking
//! for any is the measure.

use std::time::Instant;

use furrow_bvp::{Continuation, ContinuationSettings, Directional, Metric, Solution, locate};

#[path = "problems/auto_bvp.rs"]
mod auto_bvp;
#[path = "problems/oscillator.rs"]
mod oscillator;

use auto_bvp::AutoBvp;
use oscillator::Oscillator;

/// The work on branch points: each level includes the ones before it.
const EFFORTS: [&str; 4] = ["ignored", "found", "located", "switched at"];

/// Number of runs; the shortest counts.
const RUNS: usize = 100;

/// Seconds, steps and branch points of a branch with almost trivial steps.
fn follow<P: Directional + Clone>(
    problem: &P,
    guess: &Solution,
    [max_step, end]: [f64; 2],
    effort: usize,
) -> Result<(f64, usize, usize), Box<dyn std::error::Error>> {
    let began = Instant::now();
    let settings = ContinuationSettings { max_step, ..ContinuationSettings::default() };
    let mut branch = Continuation::start(problem.clone(), guess.clone(), Metric::unit(2, 1), settings, true)?;
    let (mut passed, mut points) = (0, Vec::new());
    branch.follow([0.0, end], 1000, |branch, advance| {
        if effort == 0 {
            // Without an orientation no change of it is seen.
            branch.state.orientation = 0.0;
        }
        passed += usize::from(advance.passed_branch_point);
        points.extend((advance.passed_branch_point && effort > 1).then(|| locate::branch_point(branch)));
        true
    })?;
    for point in points {
        let point = point?;
        for forwards in [true, false] {
            if effort > 2 {
                point.switch(&mut branch, forwards)?;
            }
        }
    }
    Ok((began.elapsed().as_secs_f64(), branch.work.steps, passed))
}

fn table<P: Directional + Clone>(
    name: &str,
    problem: &P,
    guess: &Solution,
    limits: [f64; 2],
) -> Result<(), Box<dyn std::error::Error>> {
    let mut least = [f64::INFINITY; 4];
    for (effort, name_of_effort) in EFFORTS.into_iter().enumerate() {
        let (mut steps, mut passed) = (0, 0);
        for _ in 0..RUNS {
            let seconds;
            (seconds, steps, passed) = follow(problem, guess, limits, effort)?;
            least[effort] = least[effort].min(seconds);
        }
        let (ms, ratio) = (1e3 * least[effort], least[effort] / least[0]);
        println!("{name}, {steps} steps, {passed} branch points {name_of_effort}: {ms:.2} ms, {ratio:.2} times");
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for max_step in [0.5, 0.2, 0.1] {
        table("AUTO's bvp", &AutoBvp::PERFECT, &AutoBvp::PERFECT.guess(40, 0.5), [max_step, 5.5])?;
    }
    let rod = Oscillator::elastica(0);
    table("the elastica", &rod, &rod.zero(1.0, 48, 4, 5.0), [12.0, 260.0])
}
