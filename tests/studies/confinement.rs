//! The example on confinement beside the scripts of Gao, Mietke and Ma 2026.

#[allow(dead_code, reason = "the example draws its picture too")]
#[path = "../../examples/confinement.rs"]
mod example;

use example::{FIGURE_1B, FIGURE_3A, breaks, cell, constriction, critical};
use furrow::Numerics;
use furrow_mechanics::equilibria::primary;

#[test]
fn a_tighter_shell_breaks_the_symmetry() {
    let options = example::options();
    let branch = primary::follow(&cell(FIGURE_3A).unwrap(), &Numerics::default(), &options, |_| true).unwrap();
    // Their script raises ξ to 30.32 on this branch, just below its fold, and then the length to 8.15756, just below its largest.
    let fold = branch.folds().next().unwrap();
    assert!(fold.maximum && fold.point.xi_s > 30.32 && fold.point.xi_s < 30.32 * 1.006, "{}", fold.point.xi_s);
    assert!((fold.point.xi_s - 30.490).abs() < 0.003, "{}", fold.point.xi_s);
    let longest = branch.points.iter().fold(0.0f64, |most, point| most.max(3.0 * point.elongation));
    assert!(longest > 8.15756 && longest < 8.15756 * 1.0005, "{longest}");
    // Symmetric shapes end in the fold where the shell is loose, and lose their symmetry before where it is tight.
    assert!(
        !breaks(FIGURE_1B).unwrap() && !breaks(FIGURE_3A).unwrap() && breaks(0.75).unwrap() && breaks(0.9).unwrap()
    );
    let critical = critical([0.68, 0.71]).unwrap();
    assert!((critical - 0.690).abs() < 0.002, "{critical}");
}

#[test]
fn a_loose_cell_constricts_in_its_middle() {
    let found = constriction().unwrap();
    // They follow the cell for 5 τ.
    assert!(found.t > 0.3 && found.t < 1.0 && found.asymmetry.abs() < 1e-3, "{} {}", found.t, found.asymmetry);
}
