//! Cues that follow PAR polarity: their place and width are those that the cell's own size and shell give.

use furrow_cell::{Cell, Cue, Numerics};
use furrow_mechanics::critical::critical_radius;
use furrow_mechanics::division::{DivisionInput, divide};
use furrow_mechanics::equilibria::ShapeError;
use furrow_mechanics::equilibria::stationary::stationary;
use furrow_mechanics::polarity::resolved;

fn cell(r0: f64, cue: &str) -> Cell {
    Cell::new(r0).with_cue(cue.parse().unwrap())
}

/// A division, a shape at rest and a mirror image are the same as with the computed cue.
#[test]
fn a_cue_that_follows_par_is_the_one_that_is_computed() {
    for cue in [
        "kappa:par_band,amplitude=0.1",
        "kappa:par,amplitude=0.1+tension:gradient,amplitude=0.05",
        "regulator:par_band,amplitude=0.1,turnover=10,diffusion=1,kappa=1",
    ] {
        let following = cell(5.4, cue);
        assert!(!following.is_mirror_symmetric() && following.cue.follows_par(), "{cue}");
        let found = resolved(&following).unwrap().into_owned();
        assert!(!found.cue.follows_par() && found != following, "{cue}");
        let by_both = [&following, &found].map(|cell| divide(&DivisionInput::new(cell.clone())).unwrap());
        assert_eq!(by_both[0], by_both[1], "{cue}");
        let [one, image] = [&following, &following.mirrored()].map(|cell| resolved(cell).unwrap().into_owned());
        assert_eq!(one.mirrored().cue, image.cue, "{cue}");
    }
    let (following, numerics) = (cell(1.65, "kappa:par_band,amplitude=0.1"), Numerics::default());
    // Too small to polarise.
    assert_eq!(resolved(&following).unwrap().cue, Cue::none());
    let shape = stationary(&following, &numerics).unwrap();
    assert_eq!(shape.solution.scalars, stationary(&Cell::new(1.65), &numerics).unwrap().solution.scalars);
}

/// A cue that differs from cell to cell has no critical radius, and is refused by name; branches of trees are then decided by divisions.
#[test]
fn a_cue_that_follows_par_has_no_critical_radius() {
    let refused = critical_radius(&cell(1.0, "kappa:par,amplitude=0.1"), &Numerics::default());
    assert!(matches!(refused, Err(ShapeError::FollowsPar { .. })), "{refused:?}");
}
