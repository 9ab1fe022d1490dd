//! Numerics that cannot work are rejected, and the advice in errors helps.

use furrow_cell::settings::Settings;
use furrow_cell::{Cell, Numerics};
use furrow_lineage::Lineage;
use furrow_mechanics::division::{DivisionInput, divide};

fn numerics(list: &[&str]) -> Numerics {
    let mut settings = Settings::default();
    let list: Vec<String> = list.iter().map(|s| s.to_string()).collect();
    settings.apply_overrides(&list).and_then(|()| settings.check_divisions("--set")).unwrap();
    settings.numerics
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
        for cell in [Cell::gao2026_thresholds(r0), Cell::gao2026_thresholds(r0).with_cue(germline.clone())] {
            let outcome = |numerics: Numerics| {
                let solved = divide(&DivisionInput { cell: cell.clone(), numerics, seed: 0 });
                solved.map(|division| division.outcome()).map_err(|error| error.to_string())
            };
            let preset = outcome(Numerics::default());
            assert!(preset.is_ok(), "{preset:?}");
            for end in ends {
                assert_eq!(outcome(numerics(end)), preset, "R0 = {r0}, {}: {end:?}", cell.cue);
            }
        }
    }
}

/// The advice in an error leads to a division. The library checks no ranges, so it reaches these errors.
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
        let solve = |numerics| divide(&DivisionInput { cell: Cell::gao2026_thresholds(r0), numerics, seed: 0 });
        let said = solve(numerics).unwrap_err().to_string();
        assert!(said.contains(advice) && !said.contains("smaller"), "{said}");
        solve(followed).unwrap();
    }
}
