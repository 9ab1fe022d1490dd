//! Stationary shapes at a given activity, found from the passive shape.

use crate::common::tables;
use furrow_cell::{Cell, Cue, Numerics};
use furrow_mechanics::equilibria::{BranchOptions, StationaryError, primary, stationary};
use furrow_mechanics::stability::Stability;

fn cued(r0: f64) -> Cell {
    Cell::gao2026_thresholds(r0).with_cue(Cue::published())
}

/// Every row of the reference branch before its fold is the first shape at its ξ_s.
#[test]
fn shapes_match_the_reference_branch() {
    let rows = tables::reference("branch_R2.00.csv");
    let rising = rows.windows(2).take_while(|w| w[0].number("xi") < w[1].number("xi")).count() + 1;
    assert!(rising >= 5);
    for row in &rows[..rising] {
        let cell = Cell { xi_s: row.number("xi"), ..Cell::gao2026_thresholds(2.0) };
        let shape = stationary(&cell, &Numerics::default()).unwrap();
        // The table gives ξ_s to 5e-5, with slopes of the others up to 2.
        assert!((shape.elongation() - row.number("H")).abs() < 1e-5, "{row:?} {}", shape.elongation());
        assert!((shape.length() / 2.0 - row.number("L_over_R0")).abs() < 1e-4, "{row:?} {}", shape.length());
        let radius = shape.equator_radius() / 2.0;
        assert!((radius - row.number("r_eq_over_R0")).abs() < 2e-5, "{row:?} {radius}");
        assert!(shape.folds.is_empty());
    }
}

/// At ε = 0.64 the branch is S-shaped: 6.3 lies beyond its first fold (6.143), and is reached by the second segment.
#[test]
fn shapes_beyond_a_fold_are_found() {
    let cell = Cell { xi_s: 6.3, epsilon: 0.64, ..Cell::gao2026_thresholds(2.22) };
    let shape = stationary(&cell, &Numerics::default()).unwrap();
    assert_eq!(shape.folds.len(), 2, "{:?}", shape.folds);
    assert!((shape.folds[0] - 6.14341).abs() < 1e-4 && (shape.folds[1] - 3.90893).abs() < 1e-4);
    // Beyond the pitchfork at 6.245.
    let spectrum = shape.spectrum().unwrap();
    assert!(!spectrum.is_stable());
}

/// Just below a fold the shape on the near side is found, however close the fold: a step along the branch passes both sides at once.
#[test]
fn shapes_just_below_a_fold_are_on_its_near_side() {
    let plain = |r0: f64, epsilon: f64| Cell { epsilon, ..Cell::new(r0) };
    let numerics = Numerics::default();
    let mut bent = plain(2.0, 0.87);
    bent.material.spontaneous_curvature = 1.0;
    for cell in
        [plain(2.0, 0.87), plain(5.4, 0.87), plain(2.22, 0.64), plain(2.2, 0.87).with_cue(Cue::published()), bent]
    {
        let options = BranchOptions { pitchforks: 0, ..BranchOptions::default() };
        let branch = primary::follow(&cell, &numerics, &options, |_| false).unwrap();
        let fold = *branch.events[0].point();
        let off = |distance: f64| {
            let shape = stationary(&Cell { xi_s: fold.xi_s * (1.0 - distance), ..cell.clone() }, &numerics).unwrap();
            assert!(shape.folds.is_empty(), "{cell:?} {distance}");
            fold.elongation - shape.elongation()
        };
        let far = off(1e-2);
        let mut last = far;
        for distance in [1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 1e-6] {
            let near = off(distance);
            assert!(near / far > 0.0 && near.abs() < last.abs(), "{cell:?} {distance}: {near:e}, {far:e} farther away");
            last = near;
        }
        assert!(last / far < 0.1, "{cell:?}: {last:e}, {far:e} farther away");
    }
}

/// Beyond the fold at 27.03 nothing is left to come to rest in.
#[test]
fn a_cell_that_must_divide_has_no_shape() {
    let error = stationary(&Cell { xi_s: 28.0, ..Cell::gao2026_thresholds(2.0) }, &Numerics::default()).unwrap_err();
    assert!(matches!(error, StationaryError::OutOfReach { turn, .. } if (turn - 27.02971).abs() < 1e-4), "{error}");
    assert!(error.to_string().contains("turns back at xi_s = 27.0"), "{error}");
}

/// A cue breaks the mirror symmetry a little; where it vanishes, the whole contour is the mirrored half.
#[test]
fn cued_shapes() {
    let shape = |cue: Cue| {
        stationary(&Cell { xi_s: 12.0, ..Cell::gao2026_thresholds(2.0) }.with_cue(cue), &Numerics::default()).unwrap()
    };
    let plain = shape(Cue::none());
    let faint = shape(Cue::kappa_band(0.465, 0.0577, 1e-9));
    let cued = shape(Cue::published());
    assert!((faint.length() - plain.length()).abs() < 1e-7, "{} {}", faint.length(), plain.length());
    let [a, b] = [&plain, &faint].map(|s| s.spectrum().unwrap().growth_rate());
    assert!((a - b).abs() < 1e-5 * a.abs(), "{a} {b}");
    assert!((cued.length() - plain.length()).abs() > 1e-4);
    assert!(cued.spectrum().unwrap().is_stable());
}

/// The cue brings the failure boundary down: its branch has a fold where the pitchfork would have been, and more below.
#[test]
fn a_cued_cell_that_must_divide_has_no_shape() {
    let error = stationary(&cued(2.0), &Numerics::default()).unwrap_err();
    assert!(matches!(error, StationaryError::OutOfReach { .. }), "{error}");
    let below = stationary(&Cell { xi_s: 20.0, ..cued(2.0) }, &Numerics::default()).unwrap();
    assert!(below.spectrum().unwrap().is_stable());
}

/// Growth rates exist for small and large, loose and tight cells, with and without a cue, down to no activity, where a
/// small cell's slowest mode decays far faster than the scale of its size suggests. The rightmost of those found from two
/// shifts is that found from one; and its sign agrees with the determinants: a shape is stable up to the first fold or
/// pitchfork of its branch, and unstable beyond.
#[test]
fn growth_rates_of_all_sorts_of_cells() {
    let numerics = Numerics::default();
    let (mut states, mut unstable) = (0, 0);
    for cue in [Cue::none(), Cue::published()] {
        for (r0, epsilon) in [(0.6, 0.93), (1.5, 0.5), (2.22, 0.64), (5.4, 0.87), (10.0, 0.93)] {
            let cell = Cell { epsilon, ..Cell::gao2026_thresholds(r0).with_cue(cue.clone()) };
            let options = BranchOptions { xi: [0.0, 31.0], ..BranchOptions::default() };
            let branch = primary::follow(&cell, &numerics, &options, |_| false).unwrap();
            let first = branch.events.first().map_or(f64::INFINITY, |event| event.point().xi_s);
            for xi_s in [0.0, 2.0, 10.0, 30.0] {
                let shape = match stationary(&Cell { xi_s, ..cell.clone() }, &numerics) {
                    Ok(shape) => shape,
                    Err(StationaryError::OutOfReach { .. }) => continue,
                    Err(error) => panic!("{error}"),
                };
                let name = format!("{}, epsilon = {epsilon}, xi_s = {xi_s}", cell.r0);
                let spectrum = shape.spectrum().unwrap_or_else(|e| panic!("{name}: {e}"));
                let rate = spectrum.growth_rate();
                let single = Stability::new(numerics.stages).growth_rate(&shape.cortex, &shape.solution).unwrap();
                assert!((rate - single).abs() < 1e-6 * (1.0 + rate.abs()), "{name}: {rate} {single}");
                if shape.folds.is_empty() {
                    assert_eq!(spectrum.is_stable(), xi_s < first, "{name}: {rate}, first event at {first}");
                }
                states += 1;
                unstable += usize::from(rate > 0.0);
            }
        }
    }
    println!("{states} states, {unstable} unstable");
    assert!(states > 20 && unstable > 0, "{states} {unstable}");
}
