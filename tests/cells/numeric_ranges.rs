//! Numbers with which nothing can be computed are refused ahead, and the advice of errors helps.

use std::process::Output;

use furrow::cell::{Cell, Numerics};
use furrow::division::{DivisionInput, divide};
use furrow::io::Settings;
use furrow::lineage::Lineage;

use crate::common::command::{self, HERE};

fn furrow(arguments: &[&str]) -> Output {
    command::furrow(HERE, &[arguments, &["--no-cache"]].concat())
}

fn set(list: &[&str]) -> Result<Settings, String> {
    let mut settings = Settings::default();
    let list: Vec<String> = list.iter().map(|s| s.to_string()).collect();
    let read = settings.apply_overrides(&list).and_then(|()| settings.check_divisions("--set"));
    read.map(|()| settings).map_err(|error| error.to_string())
}

#[test]
fn numerics_that_cannot_work_are_refused() {
    for (list, complaint) in [
        (&["step_factor=0.05"][..], "numerics.step_factor = 0.05: must be from 0.1 to 1"),
        (&["time_tolerance=1e-12"], "numerics.time_tolerance = 0.000000000001: must be from 1e-9 to 0.1"),
        (&["time_tolerance=0.5"], "numerics.time_tolerance = 0.5: must be from 1e-9 to 0.1"),
        (&["intervals=10"], "numerics.intervals = 10: must be an even whole number from 16 to 4096"),
        (&["stages=1"], "numerics.intervals = 48: must be at least 160 where numerics.stages = 1"),
        (&["stages=3", "intervals=24"], "numerics.intervals = 24: must be at least 32 where numerics.stages = 3"),
        (
            &["step_factor=0.1", "time_tolerance=1e-8"],
            "numerics.time_tolerance = 0.00000001: must be at least 1.6e-5 where numerics.step_factor = 0.1",
        ),
    ] {
        assert_eq!(set(list).unwrap_err(), format!("--set: {complaint}"));
    }
}

/// Stationary shapes ask for less than divisions: the order of the method shows on the usual mesh.
#[test]
fn what_divisions_need_is_asked_of_divisions_alone() {
    for command in [&["divide", "--r0", "2"][..], &["tree"]] {
        let output = furrow(&[command, &["--set", "stages=1"]].concat());
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains("numerics.intervals = 48: must be at least 160 where numerics.stages = 1"), "{said}");
    }
    for (stages, xi) in [("1", "22.545"), ("2", "22.0593"), ("3", "22.05688"), ("5", "22.05687")] {
        let output = furrow(&["pitchfork", "--r0", "2", "--set", &format!("stages={stages}")]);
        let said = String::from_utf8(output.stdout).unwrap();
        assert!(said.contains(&format!("ξ_s* = {xi}")), "{said}");
    }
}

/// At the ends of the ranges, cells of all sizes with and without a cue divide or come to rest as with the preset.
#[test]
fn numerics_that_are_allowed_work() {
    let germline = Lineage::c_elegans().unwrap().cue("germline").unwrap();
    let ends: [&[&str]; 7] = [
        &["time_tolerance=1e-9"],
        &["time_tolerance=0.1"],
        &["step_factor=0.2", "time_tolerance=1e-6"],
        &["intervals=16"],
        &["stages=1", "intervals=160"],
        &["stages=2", "intervals=64"],
        &["stages=3", "intervals=32"],
    ];
    for r0 in [1.6, 2.0, 2.5, 5.4] {
        for cell in [Cell::new(r0), Cell::new(r0).with_cue(germline.clone())] {
            let outcome = |numerics: Numerics| {
                let solved = divide(&DivisionInput { cell: cell.clone(), numerics, seed: 0 });
                solved.map(|division| division.outcome).map_err(|error| error.to_string())
            };
            let preset = outcome(Numerics::default());
            assert!(preset.is_ok(), "{preset:?}");
            for end in ends {
                assert_eq!(outcome(set(end).unwrap().numerics), preset, "R0 = {r0}, {}: {end:?}", cell.cue);
            }
        }
    }
}

/// An activity beyond reach is refused with the range of it, which follows the cell's rigidity and gain.
#[test]
fn activities_that_cannot_work_are_refused() {
    for (arguments, complaint) in [
        (
            &["divide", "--r0", "2", "--xi", "-1e9"][..],
            "--xi: xi_s = -1000000000: must be from -300 to 150 where kappa = 1 and gain = 0.5",
        ),
        (
            &["steady", "--r0", "4", "--xi", "-1e9"],
            "--xi: xi_s = -1000000000: must be from -300 to 150 where kappa = 1 and gain = 0.5",
        ),
        (&["tree", "--xi", "1e4"], "--xi: xi_s = 10000: must be from -300 to 150 where kappa = 1 and gain = 0.5"),
        (
            &["divide", "--r0", "2", "--set", "kappa=0.1"],
            "settings: xi_s = 25: must be from -30 to 15 where kappa = 0.1 and gain = 0.5",
        ),
    ] {
        let output = furrow(arguments);
        assert_eq!(String::from_utf8(output.stderr).unwrap(), format!("furrow: error: {complaint}\n"));
        assert_eq!(output.status.code(), Some(2));
    }
    for xi in ["-300", "150"] {
        for cue in ["none", "germline"] {
            let output = furrow(&["divide", "--r0", "5.4", "--xi", xi, "--cue", cue]);
            assert!(output.status.success(), "{xi} {cue}: {}", String::from_utf8_lossy(&output.stderr));
        }
    }
    assert!(furrow(&["steady", "--r0", "4", "--xi", "-300"]).status.success());
}

/// Whoever does what an error says gets a division. The library checks no ranges, and so gets to these errors.
#[test]
fn the_advice_of_errors_helps() {
    let preset = Numerics::default();
    let failing = [
        (2.0, Numerics { step_factor: 0.01, ..preset }, "larger step_factor", Numerics { step_factor: 0.1, ..preset }),
        (
            2.0,
            Numerics { time_tolerance: 1e-12, ..preset },
            "larger time_tolerance",
            Numerics { time_tolerance: 1e-8, ..preset },
        ),
        (5.4, Numerics { intervals: 8, ..preset }, "more mesh intervals", Numerics { intervals: 16, ..preset }),
        (2.5, Numerics { t_max: 0.01, ..preset }, "raise t_max", Numerics { t_max: 100.0, ..preset }),
    ];
    for (r0, numerics, advice, followed) in failing {
        let solve = |numerics| divide(&DivisionInput { cell: Cell::new(r0), numerics, seed: 0 });
        let said = solve(numerics).unwrap_err().to_string();
        assert!(said.contains(advice) && !said.contains("smaller"), "{said}");
        solve(followed).unwrap();
    }
    let pulled = |tension: &str| furrow(&["steady", "--r0", "2", "--xi", "1", "--set", &format!("tension={tension}")]);
    let refused = pulled("-10");
    assert!(String::from_utf8(refused.stderr).unwrap().contains("try a tension nearer to 0"));
    assert!(pulled("-0.1").status.success());
}
