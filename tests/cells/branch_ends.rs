//! Ends of branches, where necks are thin and other branches are near.

use crate::common::shapes::{at, first};
use furrow_cell::{Cell, Numerics, Parameter};
use furrow_mechanics::cortex::observables::PINCH_OFF;
use furrow_mechanics::cortex::{Cortex, Domain};
use furrow_mechanics::equilibria::asymmetric::{self, AsymmetricBranch};
use furrow_mechanics::equilibria::{Branch, BranchEnd, BranchEvent, BranchOptions, ShapeError, pitchfork, primary};
use furrow_mechanics::stability::{Parity, Stability};

fn follow(cell: &Cell, numerics: &Numerics, options: &BranchOptions) -> Branch {
    primary::follow(cell, numerics, options, |_| true).unwrap()
}

/// Steps longer than the default ones.
fn long_steps() -> BranchOptions {
    let mut options = BranchOptions::default();
    options.settings.max_step = 1.0;
    options
}

/// At R0 = 3, ε = 0.5 the branch runs on to strongly constricted shapes. The corrector's prediction there lies on the
/// other side of a pitchfork for three points after it; judged by it, the pitchfork was seen too late to be located.
#[test]
fn a_pitchfork_behind_the_prediction_on_a_thin_neck_is_located() {
    let (cell, default) = (at(3.0, 0.5), Numerics::default());
    let mut located = Vec::new();
    for intervals in [default.intervals, 2 * default.intervals] {
        let numerics = Numerics { intervals, ..default };
        let branch = follow(&cell, &numerics, &BranchOptions::default());
        assert_eq!(branch.ended, BranchEnd::Pinched(PINCH_OFF));
        assert_eq!(kinds(&branch.events), "ffpffpf");
        let BranchEvent::Fold(first) = &branch.events[0] else { panic!("the weakly elongated segment ends in a fold") };
        assert!(first.maximum && (first.point.xi_s - 5.889102).abs() < 1e-5, "{}", first.point.xi_s);
        let BranchEvent::Pitchfork(pitchfork) = &branch.events[5] else { unreachable!("checked above") };
        assert!((pitchfork.point.equator_radius / 3.0 - 0.0202).abs() < 2e-4, "{}", pitchfork.point.equator_radius);
        // Growth rates know nothing of the determinant that located it: the odd one is zero there.
        let cortex = Cortex::new(&cell, Domain::Half, &[Parameter::XiS]);
        let spectrum = Stability::new(numerics.stages).leading(&cortex, &pitchfork.shape).unwrap();
        let odd = spectrum.rightmost(Some(Parity::Odd)).unwrap();
        println!("{intervals} intervals: xi_s = {}, odd growth rate {:.1e}", pitchfork.point.xi_s, odd.re);
        assert!(odd.re.abs() < 1e-7, "{odd:?}");
        located.push(pitchfork.point.xi_s);
    }
    assert!((located[0] / located[1] - 1.0).abs() < 3e-5, "{located:?}");
}

/// At R0 = 3, ε = 0.4 two folds lie 1e-3 apart in ξ_s, between points whose tangents, from factors of predictions, did not
/// show that ξ_s had turned.
#[test]
fn folds_next_to_a_cusp_are_not_passed_over() {
    let branch = follow(&at(3.0, 0.4), &Numerics::default(), &long_steps());
    assert_eq!(kinds(&branch.events), "fffpfp");
    let [second, third] = [branch.events[1].point().xi_s, branch.events[2].point().xi_s];
    assert!((second - 2.022622).abs() < 2e-6 && (third - 2.023533).abs() < 2e-6, "{second} {third}");
}

/// Folds and pitchforks in order.
fn kinds(events: &[BranchEvent]) -> String {
    events.iter().map(|event| if matches!(event, BranchEvent::Fold(_)) { 'f' } else { 'p' }).collect()
}

/// The asymmetric branch of R0 = 4.5, ε = 0.45 leads from one pitchfork to the next, passed through it, and was reported
/// on as its own mirror image or as the symmetric branch.
#[test]
fn an_asymmetric_branch_ends_at_the_pitchfork_it_comes_back_to() {
    let (cell, options) = (at(4.5, 0.45), long_steps());
    let symmetric = follow(&cell, &Numerics::default(), &options);
    let pitchforks: Vec<_> = symmetric.pitchforks().collect();
    let [first, second] = pitchforks[..] else { panic!("two pitchforks") };
    let AsymmetricBranch { branch, scaling } = asymmetric::follow(first, &cell, &options);
    assert_eq!(branch.ended, BranchEnd::Rejoined);
    let last = branch.points.last().unwrap();
    assert!((last.xi_s - second.point.xi_s).abs() < 1e-2, "{} {}", last.xi_s, second.point.xi_s);
    assert!((last.length / second.point.length - 1.0).abs() < 1e-2);
    // The furrow is near the middle again there, but that is not how Δu opens.
    let scaling = scaling.unwrap();
    assert!((scaling.exponent - 0.5).abs() < 0.01, "{scaling:?}");
}

/// At R0 = 5.4, ε = 0.87 a tangent from the factors of a prediction was off by more than the angle a step may turn: no
/// step was short enough, and the branch was lost at ξ_s = 15.83 with all its points.
#[test]
fn a_doubtful_tangent_does_not_lose_the_branch() {
    let (cell, options) = (at(5.4, 0.87), long_steps());
    let pitchfork = pitchfork::first(&cell, &Numerics::default(), &options).unwrap();
    let AsymmetricBranch { branch, .. } = asymmetric::follow(&pitchfork, &cell, &options);
    assert_eq!(branch.ended, BranchEnd::Rejoined);
    let last = branch.points.last().unwrap();
    assert!((last.xi_s - 15.8408).abs() < 1e-2, "{}", last.xi_s);
}

#[test]
fn a_branch_that_is_lost_keeps_its_points() {
    let cell = at(2.0, 0.87);
    let pitchfork = first(&cell);
    let mut options = BranchOptions::default();
    // No step turns by less than nothing.
    options.settings.min_cosine = 1.0 + 1e-9;
    let AsymmetricBranch { branch, .. } = asymmetric::follow(&pitchfork, &cell, &options);
    assert_eq!(branch.points.len(), 1);
    assert!(matches!(branch.ended, BranchEnd::Lost(ShapeError::Branch { .. })), "{:?}", branch.ended);
}
