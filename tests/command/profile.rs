//! `--profile` of divisions and trees: what is told of their work, and that it is all of it.

use serde_json::Value;

use crate::common::command::{HERE, answer, json, refusal};

/// The seconds of all phases of a profile.
fn seconds_of_phases(profile: &Value) -> f64 {
    profile["phases"].as_object().unwrap().values().map(|phase| phase["seconds"].as_f64().unwrap()).sum()
}

#[test]
fn a_profile_is_of_what_was_computed_and_sums_to_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    let cache = folder.path().to_str().unwrap();
    let plain = ["divide", "--r0", "2.5", "--cache", cache];
    let known = json(HERE, &plain);
    assert!(known.get("profile").is_none());
    // It is known now, and computed all the same.
    let mut found = json(HERE, &[&plain[..], &["--profile"]].concat());
    let profile = found.as_object_mut().unwrap().remove("profile").unwrap();
    assert_eq!(found, known, "a profile changes nothing else");
    assert_eq!(profile["divisions"], 1);
    let whole = profile["seconds"].as_f64().unwrap();
    assert!(whole > 0.0 && (seconds_of_phases(&profile) / whole - 1.0).abs() < 1e-6);
    for key in ["steps", "rejected", "newton_iterations", "factorisations", "remeshings"] {
        assert_eq!(profile[key], known[key], "{key}");
    }
    let steps = &profile["phases"]["steps"];
    assert_eq!(steps["times"].as_u64().unwrap() + 1, known["steps"].as_u64().unwrap());
    for kind in ["residuals", "derivatives", "condensing", "elimination", "solves"] {
        for key in ["calls", "intervals"] {
            assert!(steps[kind][key].as_u64().unwrap() > 0, "{kind} {key}");
        }
        assert!(steps[kind]["seconds"].as_f64().unwrap() < whole);
    }
    let [least, mean, most] = ["least", "mean", "most"].map(|key| profile["intervals"][key].as_f64().unwrap());
    assert!(8.0 <= least && least < mean && mean < most);
}

#[test]
fn profiles_of_several_divisions_name_the_slowest() {
    let several = ["divide", "--r0", "2.5", "--replicates", "2", "--profile", "--no-cache"];
    let found = json(HERE, &several);
    let (profile, replicates) = (&found["profile"], found["replicates"].as_array().unwrap());
    let steps = |of: &Value| of["steps"].as_u64().unwrap();
    assert_eq!(profile["divisions"], 2);
    assert_eq!(steps(profile), replicates.iter().map(steps).sum::<u64>());
    let mut names: Vec<&str> =
        profile["slowest"].as_array().unwrap().iter().map(|one| one["name"].as_str().unwrap()).collect();
    names.sort_unstable();
    assert_eq!(names, ["seed 0", "seed 1"]);
    let text = answer(HERE, &several);
    assert!(text.contains("\nprofile of 2 divisions that were computed\n") && text.contains("\nseed 1  "), "{text}");
    let (_, table) = text.split_once("phase ").unwrap();
    for row in ["start (passive shape)", "first step", "other steps", "  block elimination", "meshes", "whole"] {
        assert!(table.contains(&format!("\n{row} ")), "{row} in {table}");
    }
}

#[test]
fn a_profile_of_a_tree_names_cells_and_counts_only_what_was_computed() {
    let folder = tempfile::tempdir().unwrap();
    let [cache, out] = ["cache", "out"].map(|name| folder.path().join(name).to_str().unwrap().to_owned());
    let arguments = ["tree", "--r0", "2.6", "--profile", "--cache", &cache, "--out", &out];
    let tree = json(HERE, &arguments);
    assert_eq!(tree["profile"]["divisions"], tree["divisions_solved"]);
    assert!(tree["profile"]["slowest"][0]["name"].as_str().unwrap().contains(", R0 = "));
    assert!((seconds_of_phases(&tree["profile"]) / tree["profile"]["seconds"].as_f64().unwrap() - 1.0).abs() < 1e-6);
    let again = json(HERE, &arguments);
    assert_eq!(again["profile"]["divisions"], 0);
    assert!(answer(HERE, &arguments).ends_with("\nprofile: no division was computed\n"));
}

#[test]
fn profiles_are_refused_where_there_are_none() {
    for (arguments, other) in [
        (&["divide", "--r0", "2", "--profile", "--from-steady"][..], "--from-steady"),
        (&["tree", "--profile", "--constants", "constants.csv"], "--constants <FILE.csv>"),
    ] {
        assert!(
            refusal(HERE, arguments).contains(&format!("'--profile' cannot be used with '{other}'")),
            "{arguments:?}"
        );
    }
}
