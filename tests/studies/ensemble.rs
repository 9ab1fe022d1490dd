//! Ensembles: the sets of constants that meet the paper's statements, and the resulting lineages.

use std::sync::atomic::AtomicBool;

use std::path::Path;

use furrow_analysis::{Constants, check_constraints, ensemble, ranges};
use furrow_cell::{Cell, Numerics, Parameter};
use furrow_lineage::{Lineage, TreeSettings};
use furrow_mechanics::calibration::{Targets, calibrate, with_values};

/// Coarse meshes are enough here: thresholds are right to 1e-5.
fn numerics() -> Numerics {
    Numerics { intervals: 32, ..Numerics::default() }
}

fn targets() -> Targets {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/statements.ron");
    let text = std::fs::read_to_string(file).unwrap();
    let targets: Targets =
        furrow_input::parse_document(&text, "statements.ron", "a file of targets", "Targets").unwrap();
    targets.check("statements.ron").unwrap();
    targets
}

/// Four constants meet four thresholds exactly, with a shell that is supercritical where the paper's is not.
#[test]
fn the_exact_fit_is_excluded_by_its_criticality() {
    let targets = targets();
    let fit = calibrate(&targets, &Cell::new(1.0), &numerics()).unwrap();
    assert!(fit.rms < 1e-9);
    let [aspect, p0, w, gain] = [0, 1, 2, 3].map(|k| fit.parameters[k].1);
    println!("a/b = {aspect}, P0 = {p0}, w = {w}, g = {gain}");
    assert!((aspect - 1.6704).abs() < 1e-3 && (p0 - 0.17026).abs() < 1e-4);
    assert!((w - 0.14008).abs() < 1e-4 && (gain - 0.43975).abs() < 1e-4);
    let verdict = check_constraints(&targets, &fit.cell, &numerics(), true);
    println!("{:?}", verdict.excluded);
    assert_eq!(verdict.excluded[0].datum, "criticalities[0]");
    assert_eq!(verdict.excluded[0].given, "subcritical at R0 = 1.64, epsilon = 0.87");
    assert_eq!(verdict.excluded[0].computed, "supercritical (coefficient +29.7)");
    assert!(verdict.excluded.iter().any(|e| e.datum == "symmetric[0]"));
}

#[test]
fn the_preset_agrees_with_all_that_is_printed() {
    let verdict = check_constraints(&targets(), &Cell::new(1.0), &numerics(), true);
    assert_eq!(verdict.excluded, []);
    println!("thresholds {:?}, misfit {}", verdict.thresholds, verdict.misfit);
    assert!(verdict.misfit < 2.0);
}

/// The family of shells that physics allows and the paper's numbers rule out: each misses the printed thresholds.
#[test]
fn statements_exclude_what_they_are_about() {
    let shell = |aspect: f64, gain: f64, p0: f64, w: f64| {
        let values = [(Parameter::Aspect, aspect), (Parameter::Gain, gain), (Parameter::P0, p0), (Parameter::W, w)];
        check_constraints(&targets(), &with_values(&Cell::new(1.0), &values), &numerics(), true)
    };
    // Subcritical at R0 = 2 where the paper's is supercritical.
    let verdict = shell(1.4, 0.55, 0.123, 0.1445);
    assert!(verdict.excluded.iter().any(|e| e.datum.starts_with("criticalities")), "{verdict:?}");
}

/// Draws have seeds of their own: the sample is the same at any number of threads, and each of it agrees with the targets.
#[test]
fn the_sample_does_not_depend_on_threads() {
    let targets = targets();
    let sample = |threads: usize| {
        ensemble(&targets, &Cell::new(1.0), &numerics(), 2, 7, threads, &AtomicBool::new(false)).unwrap()
    };
    let (one, two) = (sample(1), sample(2));
    assert_eq!(one, two);
    assert_eq!(one.members.len(), 2);
    println!("worth {} of 2; {} draws, excluded {:?}", one.effective_sample_size, one.draws, one.excluded);
    let sum: f64 = one.members.iter().map(|member| member.weight).sum();
    assert!((sum - 1.0).abs() < 1e-12 && one.effective_sample_size >= 1.0);
    assert!(one.excluded.contains_key("criticalities[0]"));
    for member in &one.members {
        let values: Vec<_> = one.parameters.iter().copied().zip(member.values.iter().copied()).collect();
        let verdict = check_constraints(&targets, &with_values(&Cell::new(1.0), &values), &numerics(), true);
        assert!(verdict.is_admissible(), "{verdict:?}");
        assert_eq!(verdict.thresholds, member.thresholds);
    }
}

/// With one set of constants the ranges are those of its tree; with a second of no weight they stay.
#[test]
fn ranges_of_one_set_are_its_tree() {
    let lineage = Lineage::c_elegans().unwrap();
    let set = |aspect: f64, weight: f64| Constants { values: vec![(Parameter::Aspect, aspect)], weight };
    let settings = TreeSettings::default();
    let one = ranges(&lineage, &settings, &[set(1.5, 1.0)], 1, &AtomicBool::new(false)).unwrap();
    let cells = one.cells.unwrap();
    assert_eq!([cells.p5, cells.p50, cells.p95], [285.0; 3]);
    let ems = one.founders.iter().find(|founder| founder.name == "EMS").unwrap();
    assert_eq!(ems.rounds.unwrap().max.p50, 10.0);
    assert_eq!(ems.within_one_round.unwrap().max, Some(1.0));
    // None of the sets is 0, and not −0, in files.
    let near = one.founders.iter().filter_map(|founder| founder.within_one_round);
    let shares = near.flat_map(|near| [near.min, near.mean, near.max]).flatten();
    let none: Vec<f64> = shares.filter(|share| *share == 0.0).collect();
    assert!(!none.is_empty() && none.iter().all(|share| share.is_sign_positive()), "{none:?}");
    // EMS 10 of 9 observed, P4 0 of 1.
    assert_eq!(one.paper_sentence, Some(1.0));
    let two = ranges(&lineage, &settings, &[set(1.5, 1.0), set(1.4, 0.0)], 2, &AtomicBool::new(false)).unwrap();
    assert_eq!(two.cells, one.cells);
    assert_eq!(two.members, 2);
}
