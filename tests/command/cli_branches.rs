//! The commands `branch`, `pitchfork` and `boundary`.

use furrow_cell::{Cell, Numerics};
use furrow_mechanics::equilibria::critical::Stored;
use serde_json::Value;

use crate::common::command::{HERE, json};

#[test]
fn pitchfork_has_its_keys() {
    let found = json(HERE, &["pitchfork", "--r0", "1.64"]);
    assert!((found["xi_s"].as_f64().unwrap() - 25.79676).abs() < 1e-5);
    assert_eq!(found["criticality"], "subcritical");
    assert!(found["coefficient"].as_f64().unwrap() < 0.0);
    assert!((found["H"].as_f64().unwrap() - 2.752701).abs() < 1e-6);
    assert!(found["residual"].as_f64().unwrap() < 1e-7);
    let elsewhere = json(HERE, &["pitchfork", "--r0", "2.22", "--epsilon", "0.64"]);
    assert!((elsewhere["xi_s"].as_f64().unwrap() - 6.24541).abs() < 1e-5);
}

#[test]
fn branch_has_its_keys_and_loses_stability_at_the_pitchfork() {
    let found = json(HERE, &["branch", "--r0", "2", "--xi-max", "30"]);
    let points = found["points"].as_array().unwrap();
    for key in ["branch", "xi_s", "H", "L", "stable", "delta_u"] {
        assert!(points[1].get(key).is_some(), "{key}");
    }
    let events = found["events"].as_array().unwrap();
    assert_eq!(events[0]["kind"], "pitchfork");
    assert_eq!(events[0]["criticality"], "supercritical");
    assert_eq!(events[1]["kind"], "fold");
    assert!((events[1]["xi_s"].as_f64().unwrap() - 27.02971).abs() < 1e-5);
    let (threshold, fold) = (events[0]["xi_s"].as_f64().unwrap(), events[1]["xi_s"].as_f64().unwrap());
    let symmetric: Vec<&Value> = points.iter().filter(|p| p["branch"] == "symmetric").collect();
    let mut passed = false;
    for point in &symmetric {
        let xi_s = point["xi_s"].as_f64().unwrap();
        passed |= xi_s > threshold;
        assert_eq!(point["stable"], !passed, "{point}");
        assert!(xi_s <= fold);
        assert_eq!(point["delta_u"], 0.0);
    }
    assert!(points.iter().any(|p| p["branch"] == "asymmetric" && p["delta_u"].as_f64().unwrap() < -0.1));
}

/// The cued branch is stable up to its fold, leans to one side from the start, and the boundary names the same fold.
#[test]
fn the_branch_of_a_cued_cell_is_stable_up_to_its_fold() {
    let found = json(HERE, &["branch", "--r0", "2.2", "--cue", "germline"]);
    let fold = &found["events"][0];
    assert_eq!((fold["kind"].as_str(), fold["branch"].as_str()), (Some("fold"), Some("cued")));
    let points = found["points"].as_array().unwrap();
    let top = points.iter().position(|p| p["stable"] == false).unwrap();
    assert!(top > 5 && points[..top].iter().all(|p| p["stable"] == true && p["delta_u"].as_f64().unwrap() <= 0.0));
    assert!(points[top..].iter().all(|p| p["stable"] == false), "a narrow neck is never stable");
    assert_eq!(found["ends"][0]["reason"], "pinched");
    let range = ["--from", "2.2", "--to", "2.3"];
    let boundary = json(HERE, &[&["boundary", "--vary", "r0", "--cue", "germline"], &range[..]].concat());
    let [a, b] = [&fold["xi_s"], &boundary["folds"][0]["xi_s"]].map(|xi| xi.as_f64().unwrap());
    assert!((a - b).abs() < 1e-6, "{a} {b}");
}

#[test]
fn boundary_has_its_keys() {
    let found = json(HERE, &["boundary", "--vary", "r0", "--from", "1.6", "--to", "2.2", "--critical"]);
    let pitchfork = found["pitchfork"].as_array().unwrap();
    for key in ["r0", "epsilon", "xi_s", "criticality"] {
        assert!(pitchfork[0].get(key).is_some(), "{key}");
    }
    assert_eq!(pitchfork[0]["r0"], 1.6);
    assert_eq!(pitchfork.last().unwrap()["r0"], 2.2);
    assert_eq!(
        (&pitchfork[0]["criticality"], &pitchfork.last().unwrap()["criticality"]),
        (&"subcritical".into(), &"supercritical".into())
    );
    assert!(found["folds"].as_array().unwrap().len() > 2);
    assert!((found["critical"].as_f64().unwrap() - 1.7063248).abs() < 1e-6);
    let cue = "kappa:u0=0.465,omega=0.0577,amplitude=0.1";
    let range = ["--from", "1.8", "--to", "2", "--critical"];
    let cued = json(HERE, &[&["boundary", "--vary", "r0", "--cue", cue], &range[..]].concat());
    assert!((cued["critical"].as_f64().unwrap() - 1.9051312).abs() < 1e-6);
}

/// What is written is the boundary that is compiled in: radii of every cue of the built-in lineage, where criticality
/// changes, and the curve of pitchforks from one end of the range to the other.
#[test]
fn a_stored_boundary_is_written_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("boundary.json");
    let path = path.to_str().unwrap();
    json(HERE, &["boundary", "--vary", "r0", "--from", "1.5", "--to", "5.4", "--no-folds", "--write", path]);
    let read = |path: &str| {
        let text = std::fs::read_to_string(path).unwrap();
        Stored::parse(&text, path, &Cell::new(1.0), &Numerics::default()).unwrap()
    };
    let (written, kept) =
        (read(path), read(concat!(env!("CARGO_MANIFEST_DIR"), "/crates/furrow-mechanics/data/gao2026.boundary.json")));
    let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-7, "{a} {b}");
    assert_eq!(written.radii.len(), kept.radii.len());
    for (a, b) in written.radii.iter().zip(&kept.radii) {
        assert_eq!((&a.cue, a.kind), (&b.cue, b.kind));
        close(a.r0, b.r0);
        close(a.slope, b.slope);
    }
    assert_eq!(written.degenerate.len(), kept.degenerate.len());
    for (a, b) in written.degenerate.iter().zip(&kept.degenerate) {
        close(a.r0, b.r0);
        close(a.xi_s, b.xi_s);
    }
    // The curve from end to end; where its points lie in between is the step control's affair.
    let ends = |stored: &Stored| [stored.pitchfork[0], *stored.pitchfork.last().unwrap()];
    for (a, b) in ends(&written).iter().zip(ends(&kept)) {
        assert_eq!((a.r0, a.criticality()), (b.r0, b.criticality()));
        close(a.xi_s, b.xi_s);
    }
    assert!(written.pitchfork.len() > 50 && written.pitchfork.windows(2).all(|p| p[0].r0 < p[1].r0));
}

/// Any parameter of a cell can vary, those of its cue included.
#[test]
fn boundaries_over_other_parameters() {
    let boundary = |vary: &str, [from, to]: [&str; 2], cue: &str| {
        json(HERE, &["boundary", "--vary", vary, "--from", from, "--to", to, "--r0", "2.2", "--cue", cue])
    };
    let wider = boundary("w", ["0.14", "0.15"], "none");
    let pitchfork = wider["pitchfork"].as_array().unwrap();
    assert_eq!((&pitchfork[0]["value"], &pitchfork[0]["r0"]), (&0.14.into(), &2.2.into()));
    assert_eq!(pitchfork.last().unwrap()["value"], 0.15);
    let stronger = boundary("cue.amplitude", ["0.05", "0.15"], "germline");
    let folds = stronger["folds"].as_array().unwrap();
    assert!(stronger["pitchfork"].as_array().unwrap().is_empty());
    assert_eq!((&folds[0]["value"], &folds.last().unwrap()["value"]), (&0.05.into(), &0.15.into()));
    // The fold of the germline cue itself, of amplitude 0.1, lies between the two: stronger cues raise it.
    let germline = json(HERE, &["branch", "--r0", "2.2", "--cue", "germline"]);
    let fold = germline["events"][0]["xi_s"].as_f64().unwrap();
    let sides = [&folds[0], folds.last().unwrap()].map(|point| point["xi_s"].as_f64().unwrap());
    assert!(sides[0] < fold && fold < sides[1], "{sides:?} {fold}");
}
