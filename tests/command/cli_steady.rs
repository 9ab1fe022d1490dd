//! The commands `steady`, `phase` and `calibrate`.

use serde_json::Value;

use crate::common::command::{self, HERE};

fn json(arguments: &[&str]) -> Value {
    command::json(HERE, &[arguments, &["--no-cache"]].concat())
}

#[test]
fn steady_answers() {
    let passive = json(&["steady", "--r0", "2", "--xi", "0"]);
    assert!((passive["L"].as_f64().unwrap() - 6.722513).abs() < 2e-6);
    assert!((passive["p"].as_f64().unwrap() - 0.301232).abs() < 2e-6);
    assert!((passive["H"].as_f64().unwrap() - 2.426667).abs() < 1e-6);
    assert!((passive["r_eq"].as_f64().unwrap() - 2.0 * 0.891849).abs() < 2e-6);
    assert_eq!(passive["stable"], true);
    let active = json(&["steady", "--r0", "2", "--xi", "25"]);
    assert_eq!(active["stable"], false);
    assert!(active["growth_rate"].as_f64().unwrap() > 0.0);
    let stdout = command::answer(HERE, &["steady", "--r0", "2", "--xi", "25", "--no-cache"]);
    assert!(stdout.starts_with("R0 = 2, ε = 0.87, ξ_s = 25: unstable\n"), "{stdout}");
}

/// The example of the repository: the paper's four thresholds.
#[test]
fn calibrate_answers() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/data/thresholds.ron");
    let found = json(&["calibrate", file, "--set", "intervals=32"]);
    let names: Vec<&String> = found["parameters"].as_object().unwrap().keys().collect();
    assert_eq!(names.len(), 4);
    assert_eq!(found["residuals"].as_array().unwrap().len(), 4);
    assert!(found["rms"].as_f64().unwrap() < 1e-9);
    for residual in found["residuals"].as_array().unwrap() {
        let [given, computed] = ["xi_s", "computed"].map(|key| residual[key].as_f64().unwrap());
        assert!((computed / given - 1.0).abs() < 1e-9);
    }
}

/// Below the pitchfork at 22.057 the curves say the cell stays at rest, above it the division gives χ.
#[test]
fn phase_answers() {
    let phase = "phase --vary r0 --from 2 --to 3 --points 2 --xi-from 20 --xi-to 25 --xi-points 2";
    let found = json(&phase.split(' ').collect::<Vec<_>>());
    let cells = found["cells"].as_array().unwrap();
    let outcomes: Vec<(f64, f64, &str)> = cells
        .iter()
        .map(|c| (c["x"].as_f64().unwrap(), c["xi_s"].as_f64().unwrap(), c["outcome"].as_str().unwrap()))
        .collect();
    assert_eq!(
        outcomes,
        [(2.0, 20.0, "failed"), (2.0, 25.0, "asymmetric"), (3.0, 20.0, "asymmetric"), (3.0, 25.0, "symmetric")]
    );
    assert!(cells[0]["chi"].is_null() && cells[0]["by"] == "curves");
    assert!(cells[1]["chi"].as_f64().unwrap() > 0.5 && cells[1]["by"] == "division");
    let edge = &found["columns"][0]["edges"][0];
    assert_eq!(edge["kind"], "pitchfork");
    assert_eq!(edge["criticality"], "supercritical");
    assert!((edge["xi_s"].as_f64().unwrap() - 22.05688).abs() < 1e-4);
}
