//! `furrow fit clock` beside SciPy (`tests/reference/make_clock.py` says how its numbers were made).

use furrow_analysis::fit::{FewCells, FittedLaw, Unused, fit_clock};
use furrow_lineage::{FounderClock, Lineage};
use furrow_measured::lifetimes::Lifetimes;
use furrow_measured::published::{jankele2021_lifetimes, jankele2021_volumes};
use furrow_measured::volumes::{ReadOptions, Volumes};
use serde_json::Value;

fn close(found: f64, expected: &Value) {
    let expected = expected.as_f64().unwrap();
    assert!((found - expected).abs() <= 1e-10 * expected.abs(), "{found} {expected}");
}

#[test]
fn the_clock_of_the_worm_is_that_of_scipy() {
    let lineage = Lineage::c_elegans().unwrap();
    let found =
        fit_clock(&lineage, &jankele2021_lifetimes().unwrap(), &jankele2021_volumes().unwrap(), "published").unwrap();
    let reference: Value = serde_json::from_str(include_str!("../reference/clock.json")).unwrap();
    close(found.first_volume, &reference["first_volume"]);
    assert_eq!(found.skipped.len() as u64, reference["skipped"]);
    let laws = reference["laws"].as_object().unwrap();
    assert_eq!(found.exponents.len() + found.few.len() + 1, laws.len());
    for law in found.exponents.iter().chain([&found.all]) {
        let FittedLaw { founder, exponent, se, n, lifetime_min, at_volume, volumes, r_squared, p } = law;
        let expected = &laws[founder];
        assert_eq!(*n as u64, expected["n"], "{founder}");
        close(*exponent, &expected["exponent"]);
        close(*lifetime_min, &expected["lifetime_min"]);
        close(*at_volume, &expected["at_volume"]);
        assert!(volumes[0] <= *at_volume && *at_volume <= volumes[1], "{founder}: {volumes:?}");
        // MS, E and C have a mother and her daughters: two sizes, through which a line always passes.
        assert_eq!(se.is_some(), ["AB", "all"].contains(&founder.as_str()), "{founder}");
        assert_eq!([se.is_some(), r_squared.is_some()], [p.is_some(); 2]);
        if let (Some(se), Some(r_squared)) = (se, r_squared) {
            close(*se, &expected["se"]);
            close(*r_squared, &expected["r_squared"]);
        }
    }
    for FewCells { founder, n, lifetime_min, at_volume } in &found.few {
        assert_eq!(*n as u64, laws[founder]["n"], "{founder}");
        close(*lifetime_min, &laws[founder]["lifetime_min"]);
        close(*at_volume, &laws[founder]["at_volume"]);
    }
    let names: Vec<&str> = found.exponents.iter().map(|law| law.founder.as_str()).collect();
    assert_eq!(names, ["AB", "MS", "E", "C"]);
}

/// The built-in lineage's values, to the printed digits.
#[test]
fn the_built_in_clock_is_the_fitted_one() {
    let built_in = Lineage::c_elegans().unwrap();
    let found =
        fit_clock(&built_in, &jankele2021_lifetimes().unwrap(), &jankele2021_volumes().unwrap(), "published").unwrap();
    let fitted = Lineage::parse(&found.as_ron(Some("c_elegans")), "fitted.ron").unwrap();
    let clocks = |lineage: &Lineage| -> Vec<Option<FounderClock>> {
        lineage.founders.iter().map(|founder| founder.clock).collect()
    };
    assert_eq!(clocks(&fitted), clocks(&built_in));
    assert!(fitted.clock.is_some() && fitted.clock == built_in.clock);
}

fn volumes(table: &str) -> Volumes {
    let mut volumes = Volumes::default();
    volumes.read(table.as_bytes(), "v.csv", &ReadOptions::default()).unwrap();
    volumes
}

#[test]
fn powers_are_found_exactly_and_what_is_left_out_is_named() {
    let lineage = Lineage::c_elegans().unwrap();
    // 20 minutes at the volume of P0, 1000 µm³.
    let power = |volume: f64| 20.0 * (volume / 1000.0).powf(-0.25);
    let rows = [("AB", 600.0), ("ABa", 310.0), ("ABp", 290.0), ("ABal", 150.0)];
    let lives: String = rows.iter().map(|(cell, volume)| format!("{cell},{}\n", power(*volume))).collect();
    let sizes: String = rows.iter().map(|(cell, volume)| format!("e1,{cell},{volume}\n")).collect();
    let table = format!("cell,lifetime_min\n{lives}P2,30\nABprr,40\nMS,soon\n");
    let lifetimes = Lifetimes::read(table.as_bytes(), "l.csv").unwrap();
    assert_eq!(lifetimes.skipped_count, 1);
    let heading = "embryo,cell,volume_um3\n";
    let found = fit_clock(&lineage, &lifetimes, &volumes(&format!("{heading}e1,P0,1000\n{sizes}e1,P2,200\n")), "v.csv")
        .unwrap();
    let ab = &found.exponents[0];
    assert!(
        (ab.exponent - 0.25).abs() < 1e-12 && ab.se.unwrap() < 1e-9 && (ab.r_squared.unwrap() - 1.0).abs() < 1e-12,
        "{ab:?}"
    );
    assert!((ab.lifetime_min - power(1000.0 * ab.at_volume)).abs() < 1e-9);
    assert_eq!(found.skipped, [Unused { cell: "ABprr".to_owned(), why: "no volume" }]);
    assert!(found.few.len() == 1 && found.few[0].founder == "P2" && (found.few[0].at_volume - 0.2).abs() < 1e-15);

    let error = |table: &str| fit_clock(&lineage, &lifetimes, &volumes(table), "v.csv").unwrap_err().to_string();
    let said = error(&format!("{heading}{sizes}"));
    assert!(said.contains("v.csv: volumes = (not given): must be given for the first cell, P0"), "{said}");
    let said = error(&format!("{heading}e1,P0,1000\ne1,AB,600\n"));
    assert!(said.contains("v.csv: cells = 1: must be three cells or more"), "{said}");
}
