//! Stationary shapes at a given activity, found from the passive shape.

use furrow::cortex::{Cue, Numerics, Physics};
use furrow::shapes::{StationaryError, stationary};

const CUE: Cue = Cue::Kappa { u0: 0.465, omega: 0.0577, amplitude: 0.1 };

/// Every row of the reference branch before its fold is the first shape at its ξ_s.
#[test]
fn shapes_match_the_reference_branch() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/reference/branch_R2.00.csv");
    let Ok(text) = std::fs::read_to_string(path) else {
        eprintln!("skipped: {path} is not here");
        return;
    };
    let rows = text.lines().filter(|l| l.starts_with(|c: char| c.is_ascii_digit()));
    let rows: Vec<Vec<f64>> = rows.map(|l| l.split(',').map(|v| v.parse().unwrap()).collect()).collect();
    let rising = rows.windows(2).take_while(|w| w[0][1] < w[1][1]).count() + 1;
    assert!(rising >= 5);
    for row in &rows[..rising] {
        let physics = Physics { xi_s: row[1], ..Physics::GAO2026 };
        let shape = stationary(&physics, &Numerics::default(), 2.0, &Cue::None).unwrap();
        // The table gives ξ_s to 5e-5, with slopes of the others up to 2.
        assert!((shape.elongation() - row[2]).abs() < 1e-5, "{row:?} {}", shape.elongation());
        assert!((shape.length() / 2.0 - row[3]).abs() < 1e-4, "{row:?} {}", shape.length());
        assert!((shape.equator_radius() / 2.0 - row[4]).abs() < 2e-5, "{row:?} {}", shape.equator_radius());
        assert!(shape.folds.is_empty());
    }
}

/// At ε = 0.64 the branch is S-shaped: 6.3 lies beyond its first fold (6.143), and is reached by the second segment.
#[test]
fn shapes_beyond_a_fold_are_found() {
    let physics = Physics { xi_s: 6.3, epsilon: 0.64, ..Physics::GAO2026 };
    let shape = stationary(&physics, &Numerics::default(), 2.22, &Cue::None).unwrap();
    assert_eq!(shape.folds.len(), 2, "{:?}", shape.folds);
    assert!((shape.folds[0] - 6.14341).abs() < 1e-4 && (shape.folds[1] - 3.90893).abs() < 1e-4);
    // Beyond the pitchfork at 6.245.
    let spectrum = shape.spectrum().unwrap();
    assert!(!spectrum.is_stable());
}

/// Beyond the fold at 27.03 nothing is left to come to rest in.
#[test]
fn a_cell_that_must_divide_has_no_shape() {
    let physics = Physics { xi_s: 28.0, ..Physics::GAO2026 };
    let error = stationary(&physics, &Numerics::default(), 2.0, &Cue::None).unwrap_err();
    assert!(matches!(error, StationaryError::OutOfReach { turn, .. } if (turn - 27.02971).abs() < 1e-4), "{error}");
    assert!(error.to_string().contains("turns back at xi_s = 27.0"), "{error}");
}

/// A cue breaks the mirror symmetry a little; where it vanishes, the whole contour is the mirrored half.
#[test]
fn cued_shapes() {
    let physics = Physics { xi_s: 12.0, ..Physics::GAO2026 };
    let numerics = Numerics::default();
    let plain = stationary(&physics, &numerics, 2.0, &Cue::None).unwrap();
    let faint = Cue::Kappa { u0: 0.465, omega: 0.0577, amplitude: 1e-9 };
    let faint = stationary(&physics, &numerics, 2.0, &faint).unwrap();
    let cued = stationary(&physics, &numerics, 2.0, &CUE).unwrap();
    assert!((faint.length() - plain.length()).abs() < 1e-7, "{} {}", faint.length(), plain.length());
    let [a, b] = [&plain, &faint].map(|s| s.spectrum().unwrap().growth_rate());
    assert!((a - b).abs() < 1e-5 * a.abs(), "{a} {b}");
    assert!((cued.length() - plain.length()).abs() > 1e-4);
    assert!(cued.spectrum().unwrap().is_stable());
}

/// The cue brings the failure boundary down: its branch has a fold where the pitchfork would have been, and more below.
#[test]
fn a_cued_cell_that_must_divide_has_no_shape() {
    let error = stationary(&Physics::GAO2026, &Numerics::default(), 2.0, &CUE).unwrap_err();
    assert!(matches!(error, StationaryError::OutOfReach { .. }), "{error}");
    let physics = Physics { xi_s: 20.0, ..Physics::GAO2026 };
    let below = stationary(&physics, &Numerics::default(), 2.0, &CUE).unwrap();
    assert!(below.spectrum().unwrap().is_stable());
}

/// Growth rates exist for small and large, loose and tight cells, with and without a cue, down to no activity, where a
/// small cell's slowest mode decays far faster than the scale of its size suggests.
#[test]
fn growth_rates_of_all_sorts_of_cells() {
    let mut states = 0;
    for cue in [Cue::None, CUE] {
        for (r0, epsilon) in [(0.6, 0.93), (1.5, 0.5), (2.22, 0.64), (5.4, 0.87), (10.0, 0.93)] {
            for xi_s in [0.0, 2.0, 10.0, 30.0] {
                let physics = Physics { epsilon, xi_s, ..Physics::GAO2026 };
                let shape = match stationary(&physics, &Numerics::default(), r0, &cue) {
                    Ok(shape) => shape,
                    Err(StationaryError::OutOfReach { .. }) => continue,
                    Err(error) => panic!("{error}"),
                };
                let spectrum = shape.spectrum().unwrap_or_else(|e| panic!("R0 = {r0}, epsilon = {epsilon}: {e}"));
                assert!(spectrum.growth_rate().is_finite());
                // A passive shape, without or with the cue, is at rest in a minimum of its energy.
                assert!(xi_s > 0.0 || spectrum.is_stable());
                states += 1;
            }
        }
    }
    assert!(states > 20, "{states}");
}
