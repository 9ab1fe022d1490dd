//! Compares the shortest polarised line with the evolution of an independent program (`line.py`), which shares neither the equations nor the
//! solver. Ignored, since it needs SciPy; `.ci/run` runs it where SciPy is there.

use furrow_mechanics::polarity::{Chemistry, LENGTH_UM, ParConstants, Towards};
use serde_json::{Value, json};

use crate::peer::ask;

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/line.py");

/// Just below the limit polarity is lost, just above it persists, for one and for the other power of P.
#[test]
#[ignore = "needs Python with SciPy"]
fn the_shortest_polarised_line_is_that_of_an_independent_evolution() {
    let alike = ParConstants {
        d_a: 0.1,
        d_p: 0.1,
        k_on_a: 0.006,
        k_on_p: 0.006,
        k_off_a: 0.005,
        k_off_p: 0.005,
        rho_a: 1.01,
        k_ap: 1.0,
        k_pa: 1.0,
        n_p: 2,
        ..ParConstants::GOEHRING2011
    };
    let aspect = 1.8;
    for constants in [ParConstants::GOEHRING2011, alike] {
        let (limit, _) = Chemistry::new(constants, LENGTH_UM).limit_on_line(aspect, Towards::Smaller).unwrap();
        let end = |length: f64| {
            ask(
                SCRIPT,
                &json!({"length": length, "aspect": aspect, "points": 80, "until": 20_000, "constants": constants}),
            )
        };
        let (below, above) = (end(0.975 * limit), end(1.025 * limit));
        println!("limit {limit:.4} µm: below it polarity is lost after {below} s, above it persists");
        assert!(below.is_number() && above == Value::Null, "{limit}: {below} {above}");
    }
}
