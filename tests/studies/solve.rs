//! The values of one parameter that give a wanted division.

use furrow_analysis::solve::{CONTINUOUS, Measure, Question, Root, SolveError, TOLERANCE, default_range, solve};
use furrow_cell::{Cell, Cue, Numerics, Parameter};
use furrow_lineage::batch::{Memo, Quantisation, SchedulerOptions};
use furrow_mechanics::division::{Division, DivisionInput, divide};

fn question(cell: Cell, parameter: Parameter, measure: Measure, wanted: f64) -> Question {
    let (range, numerics) = (default_range(parameter, &cell), Numerics { intervals: 32, ..Numerics::default() });
    Question { cell, parameter, numerics, seed: 0, range, points: 17, measure, wanted }
}

fn found(question: &Question) -> Result<furrow_analysis::solve::Solution, SolveError> {
    solve(question, &Memo::new(Quantisation::DEFAULT), &SchedulerOptions::default())
}

fn at(question: &Question, value: f64) -> Division {
    let mut cell = question.cell.clone();
    question.parameter.set(&mut cell, value);
    divide(&DivisionInput { cell, numerics: question.numerics, seed: question.seed }).unwrap()
}

/// A division at a root gives the wanted value, up to the small jumps of an outcome where its number of steps changes.
#[test]
fn divisions_at_the_roots_give_what_is_wanted() {
    let germline = Cell::new(3.0).with_cue(Cue::published());
    let amplitude: Parameter = "cue.amplitude".parse().unwrap();
    for (parameter, measure, wanted) in [
        (Parameter::Epsilon, Measure::Chi, 0.35),
        (Parameter::R0, Measure::UFurrow, 0.47),
        (Parameter::XiS, Measure::TEnd, 2.0),
        (Parameter::Kappa, Measure::ChiSigned, 0.2),
        (amplitude, Measure::ChiSigned, -0.05),
    ] {
        let question = question(germline.clone(), parameter, measure, wanted);
        let solution = found(&question).unwrap();
        assert!(!solution.roots.is_empty(), "{parameter}: {solution:?}");
        for Root { value, chi, .. } in solution.roots {
            let division = at(&question, value);
            let outcome = measure.of(&division).unwrap();
            assert!((outcome - wanted).abs() < 1e-4, "{parameter} = {value}: {outcome}");
            assert!((division.chi().unwrap() - chi).abs() < 1e-6);
        }
    }
}

/// Where the cue runs from pole to pole, χ leaps over every value: those are jumps, and both sides of each are as close as the
/// tolerance and far apart in χ.
#[test]
fn jumps_are_named_and_are_no_roots() {
    let cell = Cell::new(5.4).with_cue(Cue::published());
    let question = question(cell, "cue.u0".parse().unwrap(), Measure::ChiSigned, 0.1);
    let solution = found(&question).unwrap();
    assert!(!solution.jumps.is_empty(), "{solution:?}");
    for jump in &solution.jumps {
        let [a, b] = jump.between;
        assert!(a < b && b - a < 3.0 * TOLERANCE, "{jump:?}");
        let [before, behind] = jump.between.map(|value| at(&question, value).chi_signed().unwrap());
        assert!((before - 0.1) * (behind - 0.1) < 0.0 && (behind - before).abs() > CONTINUOUS, "{jump:?}");
        assert!(solution.roots.iter().all(|root| !(a..=b).contains(&root.value)));
    }
    assert!(solution.roots.iter().all(|root| (root.chi_signed - 0.1).abs() < 1e-5), "{solution:?}");
}

/// A small cell rests: its values are a gap that ends at the critical radius, and there are roots up to it.
#[test]
fn cells_at_rest_are_gaps() {
    let question = Question { range: [1.0, 2.4], ..question(Cell::new(2.0), Parameter::R0, Measure::Chi, 0.9) };
    let solution = found(&question).unwrap();
    let [gap] = &solution.gaps[..] else { panic!("{solution:?}") };
    assert!(gap.from == 1.0 && (gap.to - 1.7208).abs() < 1e-3 && gap.why.contains("rest"), "{gap:?}");
    assert!(at(&question, gap.to).chi().is_none() && at(&question, gap.to + 1e-4).chi().is_some());
    assert!(solution.roots.iter().all(|root| root.value > gap.to));
    let nowhere = Question { range: [1.0, 1.5], ..question };
    let error = found(&nowhere).unwrap().with_roots(&nowhere).unwrap_err().to_string();
    assert!(error.contains("divides nowhere"), "{error}");
}

/// The furrow's position has a maximum over R0. Two roots beside it are found though no value of the scan is between them.
#[test]
fn two_roots_between_neighbours_of_the_scan_are_found() {
    let germline = Cell::new(3.0).with_cue(Cue::published());
    let question = question(germline, Parameter::R0, Measure::UFurrow, 0.4);
    let dense = Question { range: [2.6, 4.0], points: 71, wanted: 0.99, ..question };
    let [_, top] = found(&dense).unwrap().seen.unwrap();
    assert!(top.value > 2.8 && top.value < 3.8, "{top:?}");
    let half = 0.15;
    let beside = [-half, half].map(|away| Measure::UFurrow.of(&at(&dense, top.value + away)).unwrap());
    let wanted = top.outcome - 0.1 * (top.outcome - beside[0].max(beside[1]));
    let coarse = Question { range: [top.value - 3.0 * half, top.value + 3.0 * half], points: 4, wanted, ..dense };
    let roots = found(&coarse).unwrap().roots;
    assert_eq!(roots.len(), 2, "{roots:?} beside {top:?}");
    assert!(roots[0].value < top.value && top.value < roots[1].value && roots[1].value < roots[0].value + 2.0 * half);
}
