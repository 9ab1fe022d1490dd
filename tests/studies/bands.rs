//! The examples on bands of activity and of tension beside the programs of Borja da Rocha et al. 2022 and Bächer et al. 2021.

#[allow(dead_code, reason = "the example draws its picture too")]
#[path = "../../examples/band_of_tension.rs"]
mod tension;
#[allow(dead_code, reason = "the example draws its picture too")]
#[path = "../../examples/turnover.rs"]
mod turnover;

use tension::RIGIDITY;
use turnover::{DIVIDES, SMALL, Small, TURNOVER};

#[test]
fn a_cortex_with_turnover_divides_above_a_threshold_of_activity() {
    let (activity, last) = turnover::threshold(SMALL).unwrap();
    assert!((activity - 5.5228).abs() < 0.002, "{activity}");
    assert!((last.equator_radius / 8.0 - 0.566).abs() < 0.002, "{}", last.equator_radius);
    // Less bending and less diffusion lower it, to about 5.2 without either.
    let softer = turnover::threshold(Small { rigidity: 1e-4, ..SMALL }).unwrap().0;
    assert!((softer - 5.2625).abs() < 0.002, "{softer}");
    let spread = turnover::threshold(Small { diffusion: 2e-3, ..SMALL }).unwrap().0;
    assert!((spread - 5.6006).abs() < 0.002, "{spread}");
    // Divisions have the threshold of the shapes at rest.
    assert_eq!(turnover::division(0.95 * activity, SMALL).unwrap(), None);
    assert!(turnover::division(1.05 * activity, SMALL).unwrap().is_some());
    // Their program follows its division, with an equator 20 times as active, for 16 of its units of time at most.
    let t = turnover::division(DIVIDES, SMALL).unwrap().unwrap() / TURNOVER;
    assert!(t < 16.0 && (t - 3.54).abs() < 0.02, "{t}");
}

#[test]
fn a_band_of_tension_begins_with_the_exact_flow() {
    for (power, excess) in [(2.0, 3.0), (4.0, 1.0)] {
        let tension::Start { pressure: [found, exact], off: [along, outwards] } =
            tension::start(power, excess).unwrap();
        assert!((found - exact).abs() < 2e-3 * exact, "{found} {exact}");
        assert!(along < 5e-3 && outwards < 1e-2, "{along} {outwards}");
    }
}

#[test]
fn a_band_of_tension_cuts_above_a_threshold() {
    for (power, expected) in [(2.0, 7.104), (4.0, 4.785)] {
        let found = tension::threshold(power, RIGIDITY).unwrap();
        assert!((found - expected).abs() < 0.003, "{found} {expected}");
    }
}
