//! Thresholds, folds and branches compared with independent reference values and the paper's printed thresholds.

use crate::common::shapes::{at, first, whole};
use crate::common::tables;
use furrow_bvp::Gauss;
use furrow_cell::Numerics;
use furrow_mechanics::cortex::{Cortex, Domain};
use furrow_mechanics::equilibria::point::XI;
use furrow_mechanics::equilibria::{BranchOptions, Criticality, ShapePoint, pitchfork, primary};

/// `pitchfork.csv` and `folds.csv`: every digit they claim.
#[test]
fn pitchforks_and_folds_match_the_reference() {
    let (pitchforks, folds) = (tables::reference("pitchfork.csv"), tables::reference("folds.csv"));
    assert!(pitchforks.len() >= 5 && folds.len() >= 8);
    for row in &pitchforks {
        let (r0, epsilon) = (row.number("R0"), row.number("eps"));
        let branch = whole(&at(r0, epsilon));
        let first = branch.pitchforks().next().unwrap();
        // Printed to 5 or 6 digits after the point, accurate to 1e-6.
        assert!((first.point.xi_s - row.number("xi_pf")).abs() < 6e-6, "{} {row:?}", first.point.xi_s);
        assert!((first.point.elongation - row.number("H_pf")).abs() < 1.5e-6, "{row:?}");
        assert!((first.point.length / r0 - row.number("L_pf_over_R0")).abs() < 1.5e-6, "{row:?}");
        let expected = row.number("curvature");
        assert!((first.coefficient / expected - 1.0).abs() < 0.05, "{} {row:?}", first.coefficient);
        assert_eq!(first.criticality() == Criticality::Subcritical, row.text("character") == "sub");

        let rows: Vec<_> = folds.iter().filter(|f| f.number("R0") == r0 && f.number("eps") == epsilon).collect();
        assert_eq!(branch.folds().count(), rows.len(), "R0 = {r0}, epsilon = {epsilon}");
        for (fold, row) in branch.folds().zip(rows) {
            assert!((fold.point.xi_s - row.number("xi_fold")).abs() < 8e-6, "{} {row:?}", fold.point.xi_s);
            assert!((fold.point.elongation - row.number("H")).abs() < 8e-6, "{row:?}");
            assert!((fold.point.length / r0 - row.number("L_over_R0")).abs() < 8e-6, "{row:?}");
            assert!((fold.point.equator_radius / r0 - row.number("r_eq_over_R0")).abs() < 8e-6, "{row:?}");
            assert_eq!(fold.maximum, row.text("kind") == "max");
        }
    }
}

/// The four thresholds printed in the paper, with their criticalities, to 0.3 %.
#[test]
fn printed_thresholds_and_criticalities() {
    for (r0, epsilon, printed, preset, criticality) in [
        (1.64, 0.87, 25.796, 25.797, Criticality::Subcritical),
        (2.0, 0.87, 22.006, 22.057, Criticality::Supercritical),
        (2.22, 0.64, 6.24, 6.245, Criticality::Subcritical),
        (2.22, 0.88, 21.94, 21.880, Criticality::Supercritical),
    ] {
        let found = first(&at(r0, epsilon));
        assert!((found.point.xi_s / printed - 1.0).abs() < 3.1e-3);
        assert!((found.point.xi_s - preset).abs() < 6e-4, "{}", found.point.xi_s);
        assert_eq!(found.criticality(), criticality);
    }
}

/// A threshold changes by less than 1e-8 relative from the default mesh to the next finer one.
#[test]
fn thresholds_do_not_depend_on_the_mesh() {
    for (r0, epsilon) in [(1.64, 0.87), (2.0, 0.87), (2.22, 0.64), (5.4, 0.87)] {
        let threshold = |intervals: usize| {
            let numerics = Numerics { intervals, stages: 4, ..Numerics::default() };
            pitchfork::first(&at(r0, epsilon), &numerics, &BranchOptions::default()).unwrap().point.xi_s
        };
        let intervals = Numerics::default().intervals;
        let (coarse, fine) = (threshold(intervals), threshold(2 * intervals));
        println!("R0 = {r0}, epsilon = {epsilon}: {fine}, relative change {:.1e}", coarse / fine - 1.0);
        assert!((coarse / fine - 1.0).abs() < 1e-8, "R0 = {r0}, epsilon = {epsilon}: {coarse} {fine}");
    }
}

/// `branch_R2.00.csv`: points given by their contour length, past the fold.
#[test]
fn the_branch_passes_the_reference_points() {
    let rows = tables::reference("branch_R2.00.csv");
    assert!(rows.len() >= 8);
    let (r0, numerics) = (2.0, Numerics::default());
    let mut options = BranchOptions::default();
    options.settings.max_step = 0.5;
    let gauss = Gauss::new(numerics.stages).unwrap();
    let mut branch = primary::start(&at(r0, 0.87), &numerics, &options.settings).unwrap();
    let mut next = 0;
    branch
        .follow([0.0, 40.0], 500, |branch, _| {
            while next < rows.len() && branch.state.solution.scalars[0] / r0 > rows[next].number("L_over_R0") {
                // Secant along the branch to the prescribed length.
                let row = &rows[next];
                let target = row.number("L_over_R0") * r0;
                let y = tables::at_scalar(branch, 0, target);
                let cortex = Cortex::new(&at(r0, 0.87), Domain::Half, &[]);
                let point = ShapePoint::of(&y, &cortex, &gauss);
                assert!((y.scalars[XI] - row.number("xi")).abs() < 6e-5, "{} {row:?}", y.scalars[XI]);
                assert!((point.elongation - row.number("H")).abs() < 1e-6, "{} {row:?}", point.elongation);
                assert!((point.equator_radius / r0 - row.number("r_eq_over_R0")).abs() < 1e-6, "{row:?}");
                assert!((point.pressure - row.number("p")).abs() < 1e-5, "{} {row:?}", point.pressure);
                next += 1;
            }
            next < rows.len()
        })
        .unwrap();
    assert_eq!(next, rows.len());
}

/// In a wide shell a cell is nearly a sphere, and its branch goes straight on where the branch of furrowed shapes folds.
#[test]
fn the_branch_of_a_cell_in_a_wide_shell_folds_whatever_the_step() {
    let first_fold = |epsilon: f64, max_step: f64| {
        let mut options = BranchOptions::default();
        options.settings.max_step = max_step;
        options.settings.first_step = options.settings.first_step.min(max_step);
        let branch = primary::follow(&at(2.22, epsilon), &Numerics::default(), &options, |_| false).unwrap();
        branch.events[0].fold().unwrap_or_else(|| panic!("no fold at epsilon = {epsilon}")).point
    };
    for (epsilon, threshold) in [(0.5, 7.26896), (0.45, 7.42530), (0.4, 7.47480)] {
        let (long, short) = (first_fold(epsilon, 3.0), first_fold(epsilon, 0.1));
        assert!((long.xi_s - threshold).abs() < 1e-4, "{}", long.xi_s);
        assert!((long.xi_s - short.xi_s).abs() < 1e-6, "{} {}", long.xi_s, short.xi_s);
        assert!((long.elongation - short.elongation).abs() < 1e-4);
    }
}
