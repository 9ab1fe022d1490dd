//! `furrow steady`, `phase` and `calibrate` as users meet them.

use serde_json::Value;

use crate::common::command::{self, HERE};

fn failure(arguments: &[&str], code: i32) -> String {
    command::failure(HERE, &[arguments, &["--no-cache"]].concat(), code)
}

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

#[test]
fn a_cell_without_a_stationary_shape_says_so() {
    let stderr = failure(&["steady", "--r0", "2", "--xi", "28"], 1);
    assert!(
        stderr.starts_with(
            "furrow: error: R0 = 2, epsilon = 0.87: no stationary shape at xi_s = 28 on the branch of the passive shape"
        ),
        "{stderr}"
    );
}

#[test]
fn refusals() {
    for (arguments, complaint) in [
        (&["steady", "--r0", "0"][..], "--r0: r0 = 0: must be a finite number above 0, from 1e-6 to 1e6"),
        (&["steady", "--r0", "2", "--epsilon", "nan"], "--epsilon: epsilon = NaN: must be above 0 and below 1"),
        (
            &["phase", "--vary", "r0", "--from", "-1", "--to", "2"],
            "--from: r0 = -1: must be a finite number above 0, from 1e-6 to 1e6",
        ),
        (
            &["phase", "--vary", "epsilon", "--from", "0.5", "--to", "1", "--r0", "2"],
            "--to: epsilon = 1: must be above 0 and below 1",
        ),
        (
            &["phase", "--vary", "epsilon", "--from", "0.5", "--to", "0.9"],
            "--r0: r0 = absent: must be given where epsilon varies",
        ),
        (&["calibrate", "no-such.ron"], "no-such.ron: cannot be read: No such file or directory (os error 2)"),
    ] {
        assert_eq!(failure(arguments, 2), format!("furrow: error: {complaint}\n"));
    }
}

#[test]
fn refusals_of_targets() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("t.ron").to_str().unwrap().to_owned();
    let good = "(r0: 2.0, epsilon: 0.87, xi_s: 22.0)";
    for (unknowns, thresholds, complaint) in [
        ("", good, "unknowns = []: must be at least one parameter"),
        ("(parameter: w)", "", "thresholds = []: must be at least one threshold"),
        ("(parameter: w, start: -0.1)", good, "unknowns[0].start = -0.1: must be a finite number above 0"),
        ("(parameter: w), (parameter: w)", good, "unknowns[1].parameter = w: must be named only once"),
        (
            "(parameter: xi)",
            good,
            "unknowns[0].parameter = xi_s: must be one of gain, xi_ratio, aspect, p0, w, kappa, eta_b, eta_s, friction, tension",
        ),
        (
            "(parameter: w)",
            "(r0: 2.0, epsilon: 1.5, xi_s: 22.0)",
            "thresholds[0].epsilon = 1.5: must be above 0 and below 1",
        ),
        (
            "(parameter: w)",
            "(r0: 2.0, epsilon: 0.87, xi_s: 22.0, weight: 0)",
            "thresholds[0].weight = 0: must be a finite number above 0",
        ),
    ] {
        std::fs::write(&file, format!("Targets(unknowns: [{unknowns}], thresholds: [{thresholds}])")).unwrap();
        assert_eq!(failure(&["calibrate", &file], 2), format!("furrow: error: {file}: {complaint}\n"));
    }
    std::fs::write(&file, "Targets(\n  unknowns: [(parameter: size)],\n  thresholds: [])").unwrap();
    let complaint = failure(&["calibrate", &file], 2);
    assert!(complaint.contains("t.ron:2:") && complaint.contains("size"), "{complaint}");
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
    let found = json(&[
        "phase",
        "--vary",
        "r0",
        "--from",
        "2",
        "--to",
        "3",
        "--points",
        "2",
        "--xi-from",
        "20",
        "--xi-to",
        "25",
        "--xi-points",
        "2",
    ]);
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
