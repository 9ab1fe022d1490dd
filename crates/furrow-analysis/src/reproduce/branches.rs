//! Stationary shapes over ξ_s, and the divisions next to them: figures 2C to 2F, 2I to 2L, S3 and S4.

use super::context::{Artifact, Figure, Finding, PUBLISHED_ACTIVITY, ReproduceError};
use super::paper::{Check, Statement, Transition};
use crate::constraints::{extreme_maxima, turning_point};
use crate::diagram::{Diagram, diagram};
use furrow_cell::Cell;
use furrow_lineage::batch::phase::spaced;
use furrow_lineage::batch::scheduler;
use furrow_measured::statistics::distinct;
use furrow_mechanics::calibration::statements::HigherFold;
use furrow_mechanics::division::Outcome;
use furrow_mechanics::equilibria::{Branch, BranchOptions, ShapePoint};

/// Longest step along a branch, for smooth pictures.
const STEP: f64 = 1.0;
/// Largest ξ_s of the branches: beyond the fold of the smallest cell.
const XI_MAX: f64 = 40.0;
/// How far from a threshold divisions are computed, relative to it.
const BESIDE: f64 = 0.01;

/// The branches of all cells that statements are about, each followed once, and divisions next to them.
pub fn shapes(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let checked = |statement: &'_ Statement| Some((figure.cell_of(statement), statement.check?));
    let of = |statement| checked(statement).map(|(cell, check)| (statement, cell, check));
    let statements: Vec<(&Statement, Cell, Check)> = figure.statements.iter().filter_map(of).collect();
    let cells = distinct(statements.iter().map(|(_, cell, _)| cell.clone()));
    let options = BranchOptions { xi: [0.0, XI_MAX], growth_rates: true, contours: true, ..BranchOptions::default() };
    let (options, numerics) = (options.with_max_step(STEP), figure.context.converged());
    let pool = scheduler::pool(figure.context.threads)?;
    let found: Vec<_> =
        pool.install(|| scheduler::in_parallel(cells.len(), |k| diagram(&cells[k], &numerics, &options)));
    for (statement, cell, check) in statements {
        let Some((_, found)) = cells.iter().zip(&found).find(|(known, _)| **known == cell) else { continue };
        let finding = match found {
            Ok(found) => finding(figure, &statement.id, &cell, check, found)?,
            Err(error) => Finding::not_computed(&statement.id, error),
        };
        figure.findings.push(finding);
    }
    for (cell, found) in cells.into_iter().zip(found) {
        if let Ok(Diagram { branches, .. }) = found {
            let name = format!("{}-R0_{}-epsilon_{}", figure.name(), cell.r0, cell.epsilon);
            figure.show(&name, Artifact::Branches(cell, branches));
        }
    }
    Ok(())
}

fn finding(
    figure: &mut Figure<'_>,
    id: &str,
    cell: &Cell,
    check: Check,
    found: &Diagram,
) -> Result<Finding, ReproduceError> {
    let Some((_, symmetric)) = found.branches.first() else { return Ok(Finding::not_computed(id, "no branch")) };
    let pitchfork = symmetric.pitchforks().next();
    let threshold = pitchfork.map(|found| found.point.xi_s);
    let fold = turning_point(symmetric);
    let judged = |judged| Finding::judged(id, judged);
    Ok(match (check, threshold, fold, pitchfork) {
        (Check::Threshold, Some(threshold), ..) => Finding::new(id, threshold),
        (Check::Kind(kind), .., Some(found)) => {
            let words = format!("{}, coefficient {:+.2}", found.criticality(), found.coefficient);
            judged((found.criticality() == kind, words))
        }
        (Check::Exponent, ..) => match &found.scaling {
            Some(scaling) => Finding::new(id, scaling.exponent),
            None => Finding::not_computed(id, "no asymmetric branch"),
        },
        (Check::Below, Some(threshold), ..) => {
            judged((PUBLISHED_ACTIVITY < threshold, format!("25 beside ξ_s* = {threshold:.2}")))
        }
        (Check::Window, Some(low), Some(high), _) => {
            let holds = low < PUBLISHED_ACTIVITY && PUBLISHED_ACTIVITY < high;
            judged((holds, format!("{low:.2} and {high:.2}")))
        }
        (Check::Regimes, Some(low), Some(high), _) => judged(regimes(figure, cell, low, high)?),
        (Check::Bistable, ..) => judged(bistable(symmetric)),
        (Check::Folds(higher), ..) => judged(match extreme_maxima(symmetric) {
            Some([short, long]) => {
                (higher == HigherFold::of([short, long]), format!("ξ_s = {short:.2} at small H, {long:.2} at large H"))
            }
            None => (false, "fewer than two folds".to_owned()),
        }),
        (Check::Outcomes(transition), ..) => judged(outcomes(figure, cell, transition)?),
        _ => Finding::not_computed(id, "there is no pitchfork, or no fold"),
    })
}

/// Outcomes of a cell at several activities; `None` for a division that could not be computed.
fn at_activities(
    figure: &mut Figure<'_>,
    cell: &Cell,
    activities: &[f64],
) -> Result<Vec<Option<Outcome>>, ReproduceError> {
    let input = |xi_s: &f64| figure.context.input(Cell { xi_s: *xi_s, ..cell.clone() });
    let divisions = figure.divisions(activities.iter().map(input).collect())?;
    Ok(divisions.iter().map(|division| Some(division.as_ref()?.outcome())).collect())
}

fn in_words(outcomes: &[Option<Outcome>]) -> String {
    let word = |outcome: &Option<Outcome>| outcome.map_or("not computed".to_owned(), |outcome| outcome.to_string());
    outcomes.iter().map(word).collect::<Vec<_>>().join(", ")
}

/// Whether cells rest below the pitchfork, divide unequally from there to the fold and equally beyond it.
fn regimes(figure: &mut Figure<'_>, cell: &Cell, low: f64, high: f64) -> Result<(bool, String), ReproduceError> {
    let beside = [low * (1.0 - BESIDE), low * (1.0 + BESIDE), high * (1.0 - BESIDE), high * (1.0 + BESIDE)];
    let found = at_activities(figure, cell, &beside)?;
    let expected = [Outcome::Arrested, Outcome::Asymmetric, Outcome::Asymmetric, Outcome::Symmetric];
    let holds = found.iter().zip(expected).all(|(found, expected)| *found == Some(expected));
    Ok((holds, format!("{} beside {low:.2} and {high:.2}", in_words(&found))))
}

/// Whether outcomes follow each other as they should while ξ_s rises.
fn outcomes(figure: &mut Figure<'_>, cell: &Cell, transition: Transition) -> Result<(bool, String), ReproduceError> {
    let mut found = at_activities(figure, cell, &spaced(4.0, 9.0, 101))?;
    found.dedup();
    let expected: &[Outcome] = match transition {
        Transition::WithWindow => &[Outcome::Arrested, Outcome::Asymmetric, Outcome::Symmetric],
        Transition::WithoutWindow => &[Outcome::Arrested, Outcome::Symmetric],
    };
    Ok((found == expected.iter().copied().map(Some).collect::<Vec<_>>(), in_words(&found)))
}

/// The range of ξ_s over which two stretches of stable shapes lie above each other.
fn bistable(symmetric: &Branch) -> (bool, String) {
    let is_stable = |point: &ShapePoint| point.growth_rate.is_some_and(|rate| rate < 0.0);
    let same = |a: &ShapePoint, b: &ShapePoint| is_stable(a) == is_stable(b) && a.passed == b.passed;
    let stable = symmetric.points.chunk_by(same).filter(|stretch| is_stable(&stretch[0]));
    let ranges: Vec<[f64; 2]> = stable
        .map(|stretch| {
            let xi = stretch.iter().map(|point| point.xi_s);
            xi.fold([f64::INFINITY, 0.0], |[low, high], xi| [low.min(xi), high.max(xi)])
        })
        .collect();
    let pairs = ranges.iter().enumerate().flat_map(|(k, a)| ranges[k + 1..].iter().map(move |b| (a, b)));
    let common = pairs.map(|(a, b)| [a[0].max(b[0]), a[1].min(b[1])]).find(|[low, high]| low < high);
    match common {
        Some([low, high]) => (true, format!("from ξ_s = {low:.2} to {high:.2}")),
        None => (false, format!("{} stretches of stable shapes, none above another", ranges.len())),
    }
}
