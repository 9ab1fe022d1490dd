//! Cells just above the threshold of division are slow, but not undecided.

use crate::common::shapes::{first, solve};
use crate::common::stand_in::grow;
use furrow_cell::{Cell, Numerics};
use furrow_lineage::{Lineage, TreeSettings};
use furrow_mechanics::critical::critical_radius;
use furrow_mechanics::division::{Outcome, divide};

/// The threshold is subcritical at the preset's critical radius: above it a cell divides, however slowly, below it rests.
/// The wait is ln(amplitude after/amplitude before)/σ with σ ∝ R0 − R0_c.
#[test]
fn above_the_critical_radius_a_cell_divides_whatever_the_time() {
    let critical = critical_radius(&Cell::gao2026_thresholds(1.7), &Numerics::default()).unwrap().r0;
    let mut rates = Vec::new();
    for margin in [1e-4, 1e-5, 1e-6, 1e-7, 1e-8] {
        let division = solve(Cell::gao2026_thresholds(critical * (1.0 + margin)));
        assert_eq!(division.outcome(), Outcome::Asymmetric, "{margin}");
        assert!((division.chi().unwrap() - 0.9117).abs() < 1e-3, "{margin}: {division:?}");
        let rate = division.slow_growth_rate.unwrap();
        println!("R0/R0_c - 1 = {margin:e}: growth rate {rate:.3e}, divides at {:.3e} τ", division.t_end);
        assert!(rate * division.t_end > 2.0 && rate * division.t_end < 40.0, "{division:?}");
        rates.push(rate / margin);
    }
    // In proportion to the distance; the last one is known to the error of the mesh, which is 2.5e-9 of R0_c.
    assert!(rates[..4].iter().all(|slope| (slope / rates[0] - 1.0).abs() < 0.05), "{rates:?}");
    for margin in [1e-4, 1e-6, 1e-7] {
        let division = solve(Cell::gao2026_thresholds(critical * (1.0 - margin)));
        assert_eq!(division.outcome(), Outcome::Arrested, "{margin}");
        assert!(division.growth_rate().unwrap() < 0.0 && division.slow_growth_rate.is_none());
    }
}

/// Above a supercritical threshold there is a stable shape off-centre, so near that a cell rests there: with twice the rate
/// at which the symmetric shape grows, as the normal form says.
#[test]
fn above_a_supercritical_threshold_a_cell_rests_off_centre() {
    let cell = Cell::gao2026_thresholds(2.0);
    let xi = first(&cell).point.xi_s;
    for margin in [1e-4, 1e-5, 1e-6] {
        let division = solve(Cell { xi_s: xi * (1.0 + margin), ..cell.clone() });
        assert_eq!(division.outcome(), Outcome::Arrested, "{margin}");
        let ratio = division.growth_rate().unwrap() / division.slow_growth_rate.unwrap();
        println!("xi_s/xi_s* - 1 = {margin:e}: {ratio}");
        assert!((ratio + 2.0).abs() < 0.06, "{margin}: {division:?}");
    }
}

/// Trees of ordinary parameters in which there are such cells: one of them used to abort a tree.
#[test]
fn trees_with_a_slow_cell_are_whole() {
    let lineage = Lineage::c_elegans().unwrap();
    for cell in [
        Cell::gao2026_thresholds(5.4),
        Cell::gao2026_thresholds(5.45),
        Cell { xi_s: 26.0, ..Cell::gao2026_thresholds(5.4) },
    ] {
        let settings = TreeSettings { cell: cell.clone(), ..TreeSettings::default() };
        let (tree, _) = grow(&lineage, &settings, 2, &|_| None, divide);
        let fates = || tree.cells().map(|id| &tree.cell(id).fate);
        let slow = fates().filter(|fate| fate.division().is_some_and(|d| d.slow_growth_rate.is_some())).count();
        assert!(slow > 0, "{cell:?}");
        assert!(fates().all(|fate| fate.outcome().is_some()), "{cell:?}");
    }
}
