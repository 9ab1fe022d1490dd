//! Searches for critical radii take a bounded number of steps, the same on every machine, and can be cancelled.

use std::sync::atomic::{AtomicBool, Ordering};

use furrow_cell::{Cell, Numerics};
use furrow_lineage::Thresholds;
use furrow_mechanics::critical::{CriticalRadii, MOST_SEARCHED, critical_radius_within};
use furrow_mechanics::equilibria::{ShapeError, StepBudget};

/// A cell whose search takes some thousand steps, and finds a radius that no cell of a tree comes near.
fn long() -> Cell {
    Cell { epsilon: 0.6, xi_s: 35.0, ..Cell::gao2026_thresholds(3.0) }
        .with_cue("tension:gradient,amplitude=0.05".parse().unwrap())
}

#[test]
fn a_search_ends_where_its_effort_does() {
    let numerics = Numerics::default();
    for most in [0, 10, 100] {
        let budget = StepBudget::new(most, None);
        let error = critical_radius_within(&long(), &numerics, &budget).unwrap_err();
        assert!(matches!(error, ShapeError::OutOfBudget { steps, .. } if steps == most), "{error}");
        // The step that passes the limit is the last; one along a branch may count for as many as it took attempts.
        assert!(budget.spent() > most && budget.spent() < most + 40, "{} of {most}", budget.spent());
    }
    // A plain cell of another size of shell takes a fraction of the allowed steps, and the same number without a limit.
    let plain = Cell { epsilon: 0.8, ..Cell::gao2026_thresholds(1.0) };
    let (free, bounded) = (StepBudget::unlimited(), StepBudget::new(MOST_SEARCHED, None));
    let found = critical_radius_within(&plain, &numerics, &free).unwrap();
    assert_eq!(critical_radius_within(&plain, &numerics, &bounded).unwrap(), found);
    assert_eq!(bounded.spent(), free.spent());
    assert!((20..MOST_SEARCHED / 4).contains(&free.spent()), "{}", free.spent());
}

#[test]
fn radii_are_searched_for_with_bounded_effort_and_once() {
    let numerics = Numerics::default();
    let radii = CriticalRadii::new(&numerics);
    assert!(!radii.knows(&long()));
    let error = radii.ends(&long()).unwrap_err();
    assert!(matches!(error, ShapeError::OutOfBudget { steps: MOST_SEARCHED, .. }), "{error}");
    assert!(radii.knows(&long()));
    assert!(radii.knows(&Cell::new(2.0)), "the preset's radius is stored");
}

#[test]
fn an_interrupted_search_ends_at_once_and_is_not_remembered() {
    static FLAG: AtomicBool = AtomicBool::new(true);
    let cell = Cell { epsilon: 0.8, ..Cell::gao2026_thresholds(1.0) };
    let budget = StepBudget::new(usize::MAX, Some(&FLAG));
    assert_eq!(critical_radius_within(&cell, &Numerics::default(), &budget), Err(ShapeError::Interrupted));
    assert_eq!(budget.spent(), 0);

    let rule = Thresholds::new(CriticalRadii::new(&Numerics::default()).interrupted_by(&FLAG));
    assert_eq!(rule.of(&cell), None);
    assert!(rule.unknown().is_empty() && !rule.knows(&cell));
    FLAG.store(false, Ordering::Relaxed);
    // Critical is 1.065.
    assert!(rule.of(&cell).is_some());
    assert!(rule.of(&Cell { r0: 1.1, ..cell }).is_none());
}
