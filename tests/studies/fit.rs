//! `furrow fit`: constants, activities and a cue from observations.

use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

use furrow_analysis::fit::{
    Evaluated, FitProgress, FitRun, FittedConstants, Limit, Reading, SearchBudget, Targets, activities, fit_constants,
    fit_cue,
};
use furrow_cell::settings::Settings;
use furrow_cell::{Cell, Cue, Numerics, Parameter};
use furrow_lineage::batch::{Memo, Quantisation};
use furrow_lineage::{Lineage, ObservedRounds, Rounds, Thresholds, TreeSettings, founder_rounds};
use furrow_mechanics::calibration::statements::GivenCriticality;
use furrow_mechanics::critical::CriticalRadii;
use furrow_mechanics::division::{DivisionInput, divide};
use furrow_mechanics::equilibria::{BranchOptions, pitchfork};

use crate::common::stand_in::grow;

/// A clone of one small founder, so that a tree takes a few divisions.
const CLONE: &str =
    r#"Lineage(name: "clone", founders: [(name: "Q", observed: (min: 2, mean: 2.5, max: 3, terminal: 6))])"#;

fn clone() -> (Lineage, TreeSettings) {
    let lineage = Lineage::parse(CLONE, "clone.ron").unwrap();
    // Trees are compared with each other, so a coarse mesh suffices.
    let numerics = Numerics { intervals: 32, ..Numerics::default() };
    (lineage, TreeSettings { cell: Cell::gao2026_thresholds(2.4), numerics, ..TreeSettings::default() })
}

fn targets(text: &str, lineage: &Lineage) -> Targets {
    let targets: Targets = furrow_input::parse_document(text, "x.ron", "targets", "Fit").unwrap();
    targets.check("x.ron", lineage).unwrap();
    targets
}

fn rounds_at(lineage: &Lineage, settings: &TreeSettings, xi_s: f64) -> Rounds {
    let settings = TreeSettings { cell: Cell { xi_s, ..settings.cell.clone() }, ..settings.clone() };
    let rule = Thresholds::new(CriticalRadii::new(&settings.numerics));
    let ends = |cell: &Cell| rule.of(cell);
    let (tree, _) = grow(lineage, &settings, 1, &ends, divide);
    founder_rounds(&tree)[0].unwrap()
}

#[test]
fn constants_are_found_and_the_same_at_any_number_of_threads() {
    let (mut lineage, settings) = clone();
    // The rounds of the clone at another activity.
    let aim = rounds_at(&lineage, &settings, 32.0);
    let counts =
        ObservedRounds { mean: Some(aim.mean), max: Some(aim.max), terminal: Some(aim.terminal), ..Default::default() };
    lineage.founders[0].observed = Some(counts);
    let text = r#"Fit(
        unknowns: [(parameter: xi_s, from: 24, to: 36)], founders: ["Q"],
        thresholds: [(r0: 2.0, epsilon: 0.87, xi_s: 22.006)],
    )"#;
    let targets = targets(text, &lineage);
    let effort = SearchBudget { particles: 3, moves: 2, seed: 1 };
    let found: Vec<FittedConstants> = [1, 2]
        .into_iter()
        .map(|threads| {
            let memo = Memo::new(Quantisation::DEFAULT);
            let never = AtomicBool::new(false);
            fit_constants(&FitRun::new(&lineage, &settings, threads, &never), &targets, &memo, effort).unwrap()
        })
        .collect();
    assert_eq!(found[0], found[1]);
    let FittedConstants { best, start, front, sharpness, .. } = &found[0];
    assert!(best.misfit < start.misfit && best.parts.rounds <= 0.5, "{best:?}");
    // The gain removes the deviation of the one threshold: shapes depend on the product alone.
    assert!(best.thresholds_rms.unwrap() < 1e-12, "{best:?}");
    let [from, to] = [sharpness[0].from, sharpness[0].to];
    let xi_s = best.cell.xi_s;
    assert!(from <= xi_s && xi_s <= to, "{from} {xi_s} {to}");
    // Nothing on the front is beaten in both, and its first is the best.
    assert_eq!(front[0].misfit, best.misfit);
    let rms = |e: &Evaluated| e.thresholds_rms.unwrap();
    assert!(front.windows(2).all(|pair| pair[0].misfit < pair[1].misfit && rms(&pair[1]) < rms(&pair[0])));
    // The tree of the constants found is the one they were judged by.
    let again = rounds_at(&lineage, &TreeSettings { cell: best.cell.clone(), ..settings.clone() }, xi_s);
    assert_eq!(Some(again), best.founders[0].rounds);
}

#[test]
fn rounds_are_the_observed_ones_inside_an_activity_interval_and_not_beyond_it() {
    let (lineage, settings) = clone();
    let memo = Memo::new(Quantisation::DEFAULT);
    let never = AtomicBool::new(false);
    let run = FitRun::new(&lineage, &settings, 1, &never);
    let found = activities(&run, &memo, Reading::Max, [10.0, 60.0]).unwrap();
    let [from, to] = found.founders[0].xi_s.unwrap();
    assert!(found.trees > 10 && from < to, "{found:?}");
    let rounds = |xi_s: f64| rounds_at(&lineage, &settings, xi_s).max;
    assert_eq!((rounds(from), rounds(to)), (3, 3));
    // Thresholds are halved five times from neighbours 10 % apart.
    assert_ne!(rounds(from * 0.995), 3);
    assert_ne!(rounds(to * 1.005), 3);
}

#[test]
fn a_founder_keeps_its_own_parameters_and_its_rounds_are_those_of_its_tree() {
    let (_, settings) = clone();
    let own = CLONE.replace(r#"name: "Q","#, r#"name: "Q", physics: (xi_s: 40.0, epsilon: 0.8),"#);
    let lineage = Lineage::parse(&own, "own.ron").unwrap();
    let memo = Memo::new(Quantisation::DEFAULT);
    let shown = Mutex::new(Vec::new());
    let show = |progress: FitProgress| shown.lock().unwrap().push(progress.done);
    let never = AtomicBool::new(false);
    let run = FitRun { progress: Some(&show), ..FitRun::new(&lineage, &settings, 1, &never) };
    let find = |range: [f64; 2]| activities(&run, &memo, Reading::Mean, range).unwrap().founders;
    let found = find([10.0, 60.0]);
    let (tree, _) = grow(&lineage, &settings, 1, &|_| None, divide);
    let rounds = founder_rounds(&tree)[0].unwrap();
    assert_eq!((found[0].run_xi_s, found[0].rounds), (40.0, Some(rounds.mean)));
    // At the activity of the file the search has the same rounds.
    let plain = Lineage::parse(CLONE, "clone.ron").unwrap();
    assert_ne!(rounds_at(&plain, &settings, 40.0).mean, rounds.mean, "the volume fraction counts as well");
    // Progress rises to the number of trees that were announced.
    let done = shown.lock().unwrap().clone();
    assert!(done.windows(2).all(|pair| pair[0] < pair[1]) && done.last() == Some(&30), "{done:?}");
    // A part of the interval ends at both limits asked for, which is said.
    let [from, to] = found[0].xi_s.unwrap();
    assert!(found[0].at_limit.is_empty(), "{found:?}");
    assert_eq!(find([1.01 * from, 0.5 * (from + to)])[0].at_limit, [Limit::Lower, Limit::Upper]);
}

#[test]
fn a_cue_that_gave_the_data_is_found_and_what_they_leave_open_is_said() {
    let text = r#"Lineage(name: "one", cues: {"c": "kappa:u0=0.465,omega=0.0577,amplitude=0.1"},
        founders: [(name: "P0", cue: "c")])"#;
    let lineage = Lineage::parse(text, "one.ron").unwrap();
    let settings = TreeSettings { cell: Cell::gao2026_thresholds(3.9), ..TreeSettings::default() };
    let given =
        divide(&DivisionInput::new(Cell::gao2026_thresholds(3.9).with_cue(Cue::published()))).unwrap().chi().unwrap();
    let text = format!(
        r#"Fit(unknowns: [(parameter: p0, from: 0.1, to: 0.2)], founders: [], chi: [(cell: "P0", mean: {given}, sd: 0.01)])"#
    );
    let targets = targets(&text, &lineage);
    let effort = SearchBudget { particles: 5, moves: 3, seed: 2 };
    let never = AtomicBool::new(false);
    let run = FitRun::new(&lineage, &settings, 2, &never);
    let found = fit_cue(&run, &targets, &Cue::published(), effort).unwrap();
    assert!(found.goodness.chi_squared < 0.1, "{found:?}");
    assert_eq!(found.numbers.len(), 3);
    // One measurement cannot say how far three numbers are off.
    assert_eq!((found.goodness.degrees_of_freedom, found.goodness.p), (0, None));
    assert!(found.numbers.iter().all(|number| number.sd.is_none()), "{found:?}");
    // One number was measured: one combination of three is held, at most.
    let combinations = found.combinations.as_ref().unwrap();
    assert!(combinations.iter().filter(|held| held.determined).count() <= 1, "{combinations:?}");
    // The printed cue gives the printed χ.
    let cell = Cell::gao2026_thresholds(3.9).with_cue(found.cue.parse().unwrap());
    assert_eq!(divide(&DivisionInput::new(cell)).unwrap().chi(), found.residuals[0].computed);
}

#[test]
fn the_targets_of_the_embryo_can_be_met() {
    Targets::embryo().unwrap().check("built in", &Lineage::c_elegans().unwrap()).unwrap();
}

/// How many of the given kinds of pitchforks a cell's constants reverse.
fn reversed(cell: &Cell) -> usize {
    let kinds = Targets::embryo().unwrap().criticalities;
    let is_reversed = |given: &&GivenCriticality| {
        let cell = Cell { r0: given.r0, epsilon: given.epsilon, ..cell.clone() };
        let found = pitchfork::first(&cell, &Numerics::default(), &BranchOptions::default()).unwrap();
        found.criticality() != given.kind
    };
    kinds.iter().filter(is_reversed).count()
}

#[test]
fn the_preset_of_the_embryo_keeps_what_it_was_fitted_to() {
    let cell = Settings::preset("sulston1983").unwrap().cell;
    let lineage = Lineage::c_elegans().unwrap();
    let settings = TreeSettings { cell: cell.clone(), ..TreeSettings::default() };
    let rule = Thresholds::new(CriticalRadii::new(&settings.numerics));
    let ends = |cell: &Cell| rule.of(cell);
    let (tree, _) = grow(&lineage, &settings, 2, &ends, divide);
    let rows = founder_rounds(&tree);
    let of = |name: &str| lineage.founder_named(name).unwrap();
    let off = |name: &str| {
        let observed = lineage.founders[of(name)].observed.unwrap().mean.unwrap();
        (rows[of(name)].unwrap().mean - observed).abs()
    };
    let mean = ["AB", "MS", "C", "D"].map(off).iter().sum::<f64>() / 4.0;
    assert!(mean <= 0.24, "{mean}");
    assert_eq!(reversed(&cell), 0);
    let fate = |name: &str| &tree.cell(tree.founder_cell(of(name)).unwrap()).fate;
    assert_eq!(fate("AB").outcome(), Some(furrow_mechanics::division::Outcome::Symmetric));
    assert!((fate("P0").chi().unwrap() - 0.180).abs() <= 0.04);
    // The activity is given at a gain: both are of the preset.
    assert!(Parameter::XiS.get(&cell) > 25.0);
}
