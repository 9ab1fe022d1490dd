//! Statistics beside SciPy's (`data/make_reference.py` says how they were made).

mod lifetimes;

use furrow_measured::dose::{Doses, by_condition, by_dose, trend};
use furrow_measured::events::{Division, divisions, summaries};
use furrow_measured::published::{rodrigues2024, villoutreix2016};
use furrow_measured::significance::{Sample, Trend, needed, paired, power, slope_p, welch};
use furrow_measured::statistics::{
    Line, Method, box_plot, line, line_through_origin, mean, rank_correlation, rank_sum, sd, stars,
};
use furrow_measured::trend::{adjacent_tests, volume_bins, volume_line, volume_trend};
use furrow_measured::volumes::{ReadOptions, Volumes};
use serde_json::Value;

fn reference() -> Value {
    serde_json::from_str(include_str!("data/reference.json")).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn close(found: f64, expected: &Value) {
    let expected = expected.as_f64().unwrap();
    assert!((found - expected).abs() <= 1e-10 * expected.abs(), "{found} {expected}");
}

#[test]
fn rank_sums_agree_with_scipy() {
    let mut methods = Vec::new();
    for case in reference()["ranks"].as_array().unwrap() {
        let found = rank_sum(&numbers(&case["a"]), &numbers(&case["b"])).unwrap();
        close(found.u, &case["u"]);
        close(found.p, &case["p"]);
        methods.push(found.method);
    }
    assert!(methods.contains(&Method::Exact) && methods.contains(&Method::Asymptotic));
    assert_eq!(rank_sum(&[1.0; 4], &[1.0; 12]).unwrap().p, 1.0);
    assert!(rank_sum(&[], &[1.0]).is_none());
}

#[test]
fn lines_agree_with_scipy() {
    for case in reference()["lines"].as_array().unwrap() {
        let found = line(&points(case)).unwrap();
        close(found.slope, &case["slope"]);
        close(found.slope_error, &case["slope_error"]);
        close(found.r_squared.unwrap(), &case["r_squared"]);
        assert!((found.intercept - case["intercept"].as_f64().unwrap()).abs() < 1e-10);
    }
    assert!(line(&[[1.0, 1.0], [1.0, 2.0], [1.0, 3.0]]).is_none());
}

#[test]
fn a_line_through_the_origin_has_no_intercept() {
    let exact: Vec<[f64; 2]> = (1..5).map(|x| [f64::from(x), 1.151 * f64::from(x)]).collect();
    let found = line_through_origin(&exact).unwrap();
    assert!((found.slope - 1.151).abs() < 1e-14 && found.slope_error == 0.0);
    assert!((found.r_squared.unwrap() - 1.0).abs() < 1e-14 && slope_p(&found).is_none());
    // By hand: Σxy/Σx² = 5/5, residuals 1 and −1/2 … of (1, 2) and (2, 3/2).
    let found = line_through_origin(&[[1.0, 2.0], [2.0, 1.5]]).unwrap();
    assert!((found.slope - 1.0).abs() < 1e-15);
    assert!((found.slope_error - (1.25_f64 / 5.0).sqrt()).abs() < 1e-15);
    assert!((found.r_squared.unwrap() - (1.0 - 1.25 / 6.25)).abs() < 1e-15);
}

#[test]
fn boxes_have_quartiles_between_values_and_whiskers_of_three_interquartile_ranges() {
    for case in reference()["boxes"].as_array().unwrap() {
        let values = numbers(&case["x"]);
        let found = box_plot(&values).unwrap();
        found.quartiles.iter().zip(case["quartiles"].as_array().unwrap()).for_each(|(q, expected)| close(*q, expected));
        assert!((mean(&values) - case["mean"].as_f64().unwrap()).abs() < 1e-12);
        match sd(&values) {
            Some(sd) => close(sd, &case["sd"]),
            None => assert!(case["sd"].is_null()),
        }
    }
    let found = box_plot(&[1.0, 2.0, 3.0, 4.0, 5.0, 11.0, 11.5]).unwrap();
    assert_eq!((found.quartiles, found.whiskers, found.outliers), ([2.5, 4.0, 8.0], [1.0, 11.5], vec![]));
    let found = box_plot(&[1.0, 2.0, 3.0, 4.0, 50.0]).unwrap();
    assert_eq!((found.whiskers, found.outliers), ([1.0, 4.0], vec![50.0]));
}

#[test]
fn stars_follow_the_rule() {
    assert_eq!([0.2, 0.1, 0.09, 0.05, 0.049, 0.001, 0.0009].map(stars), ["n.s.", "n.s.", "*", "*", "**", "**", "***"]);
}

fn points(case: &Value) -> Vec<[f64; 2]> {
    numbers(&case["x"]).into_iter().zip(numbers(&case["y"])).map(|(x, y)| [x, y]).collect()
}

#[test]
fn rank_correlations_agree_with_scipy() {
    for case in reference()["correlations"].as_array().unwrap() {
        let found = rank_correlation(&points(case)).unwrap();
        close(found.rho, &case["rho"]);
        close(found.p, &case["p"]);
    }
    assert!(rank_correlation(&[[1.0, 2.0], [2.0, 3.0]]).is_none());
    assert!(rank_correlation(&[[1.0, 2.0], [1.0, 3.0], [1.0, 4.0]]).is_none());
}

/// With few pairs the orders are counted: of 4! orders two are as strong as a perfect one.
#[test]
fn correlations_of_few_pairs_are_tested_exactly() {
    let found = |y: &[f64]| {
        let points: Vec<[f64; 2]> = y.iter().enumerate().map(|(x, y)| [x as f64, *y]).collect();
        let found = rank_correlation(&points).unwrap();
        assert_eq!(found.method, if y.len() < 10 { Method::Exact } else { Method::Asymptotic });
        found.p
    };
    assert_eq!(found(&[1.0, 2.0, 3.0]), 2.0 / 6.0);
    assert_eq!(found(&[4.0, 3.0, 2.0, 1.0]), 2.0 / 24.0);
    // Table of Glasser & Winter (1961): Σd² of 4 of five pairs, ρ = .8, has the two-sided probability .1333.
    assert_eq!(found(&[2.0, 1.0, 4.0, 3.0, 5.0]), 16.0 / 120.0);
    // By hand: of the twelve distinct orders of 1, 1, 2, 3 one rises and one falls.
    assert_eq!(found(&[1.0, 1.0, 2.0, 3.0]), 2.0 / 12.0);
    let nine: Vec<f64> = (0..9).map(f64::from).collect();
    assert_eq!(found(&nine), 2.0 / 362_880.0);
    assert!(found(&(0..10).map(f64::from).collect::<Vec<_>>()) < 1e-10);
}

/// The two regressions of χ under compression: errors of slope and intercept, and R² about 0 and about the mean.
#[test]
fn regressions_have_the_errors_of_scipy() {
    for case in reference()["regressions"].as_array().unwrap() {
        let [free, origin] = [line(&points(case)).unwrap(), line_through_origin(&points(case)).unwrap()];
        let parts = |line: Line| {
            [
                ("slope", Some(line.slope)),
                ("slope_error", Some(line.slope_error)),
                ("intercept", Some(line.intercept)),
                ("intercept_error", line.intercept_error),
                ("r_squared", line.r_squared),
                ("r_squared_about_mean", line.r_squared_about_mean),
            ]
        };
        for (found, expected) in [(free, &case["line"]), (origin, &case["origin"])] {
            for (name, value) in parts(found).into_iter().filter(|(name, _)| !expected[*name].is_null()) {
                close(value.unwrap_or_else(|| panic!("no {name}")), &expected[name]);
            }
        }
        assert_eq!((origin.intercept, origin.intercept_error), (0.0, None));
        assert_eq!(free.r_squared, free.r_squared_about_mean);
    }
}

/// A quantity that never varies has the slope 0 and no p value; over one that never varies there is no line. The mean of three times 0.1
/// is above 0.1 by rounding.
#[test]
fn values_that_differ_by_rounding_are_equal() {
    let level = [[0.0, 0.1], [1.0, 0.1], [2.0, 0.1]];
    for found in [line(&level).unwrap(), power(&level).unwrap().line] {
        assert_eq!((found.slope, found.slope_error, found.r_squared, slope_p(&found)), (0.0, 0.0, None, None));
    }
    let found = line_through_origin(&level).unwrap();
    assert!(found.r_squared.is_some() && found.r_squared_about_mean.is_none());
    for (x, other) in [(0.1, 0.1), (0.3, 0.1 + 0.2)] {
        let points = [[x, 1.0], [other, 2.0], [x, 4.0]];
        assert!(line(&points).is_none() && rank_correlation(&points).is_none(), "{x}");
    }
    // Twelve χ of 0.1 that were computed from different volumes: no value is larger than another.
    let chi = |[large, small]: [f64; 2]| (large - small) / (large + small);
    let of = |sizes: [[f64; 2]; 3]| sizes.iter().cycle().take(6).map(|size| chi(*size)).collect::<Vec<f64>>();
    let [a, b] = [[[1.1, 0.9], [2.2, 1.8], [4.4, 3.6]], [[11.0, 9.0], [22.0, 18.0], [44.0, 36.0]]].map(of);
    let found = rank_sum(&a, &b).unwrap();
    assert_eq!((found.u, found.p), (18.0, 1.0));
    // Ranks 1½, 1½, 3 and 4 with one pair equal by rounding.
    let points = [0.1 + 0.2, 0.3, 0.4, 0.5].iter().enumerate().map(|(x, y)| [x as f64, *y]).collect::<Vec<_>>();
    assert_eq!(rank_correlation(&points).unwrap().p, 2.0 / 12.0);
    // Logarithms near 0, of the volumes 1 and one that rounds.
    let relative = [[1.0, 0.1], [1.0 - f64::EPSILON, 0.2], [1.0, 0.4]];
    assert!(volume_line(&relative).is_none() && power(&relative.map(|[x, y]| [x.ln(), y])).is_none());
    assert_eq!((sd(&[0.1; 3]), paired(&[0.1; 3]).unwrap().p, paired(&[0.0; 3]).unwrap().p), (Some(0.0), None, None));
    let one = Sample { n: 3, mean: 0.1, sd: sd(&[0.1; 3]).unwrap() };
    assert_eq!(welch(one, Sample { mean: 0.2, ..one }), None);
}

/// Fifteen sizes, each 1.2 times as large as the next, are no single size (`scipy.stats.linregress`).
#[test]
fn a_chain_of_sizes_determines_an_exponent_with_its_error() {
    let sizes = (0..15).map(|k| -f64::from(k) * 1.2_f64.ln());
    let points: Vec<[f64; 2]> =
        sizes.enumerate().map(|(k, x)| [x, -0.3 * x + 0.05 * (-1.0_f64).powi(k as i32)]).collect();
    let Trend { line, p } = power(&points).unwrap();
    assert!((line.slope_error - 0.01756546583090574).abs() < 1e-12, "{line:?}");
    assert!((p.unwrap() / 2.7564758055271934e-10 - 1.0).abs() < 1e-8, "{p:?}");
    // Three values that each lie within a factor 1.25 of a size make two sizes.
    let two = [[0.0, 1.0], [0.2, 1.1], [1.0, 2.0]];
    assert!(power(&two).unwrap().line.slope_error.is_nan());
}

/// By `statsmodels.stats.power.TTestPower().solve_power(ratio, alpha=0.05, power=0.8)`, rounded up.
#[test]
fn needed_numbers_are_those_of_students_t() {
    let ratios = [2.0, 1.5, 1.25, 1.0, 0.8, 0.5, 0.3, 0.1, 0.03];
    assert_eq!(ratios.map(|ratio| needed(ratio, 1_000_000)), [5, 6, 8, 10, 15, 34, 90, 787, 8723].map(Some));
    assert_eq!((needed(-0.5, 40), needed(0.01, 78_000), needed(0.0, 1_000)), (needed(0.5, 40), None, None));
}

/// A published table. They are not shipped: `FURROW_DATA` names their folder.
fn published(name: &str) -> String {
    let folder = std::env::var("FURROW_DATA");
    let folder = folder.unwrap_or_else(|_| concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data").to_owned());
    let file = format!("{folder}/{name}");
    std::fs::read_to_string(&file).unwrap_or_else(|error| panic!("{file}: {error}; FURROW_DATA names another folder"))
}

#[test]
#[ignore = "needs the published tables"]
fn the_sea_urchin_has_the_classes_and_tests_of_scipy() {
    let table = published("villoutreix2016_divisions.csv");
    let mut volumes = Volumes::default();
    volumes.read(table.as_bytes(), "t.csv", &ReadOptions::default()).unwrap();
    let all = divisions(&volumes).divisions;
    assert_eq!((all.len(), volumes.skipped_count), (1702, 0));
    let two: Vec<Division> = all.iter().filter(|d| ["Mac", "Mes"].contains(&&d.group[..])).cloned().collect();
    let reference = &reference()["sea_urchin"];
    for name in ["decades", "classes"] {
        let expected = &reference[name];
        let edges: Vec<f64> = expected["edges"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        let bins = volume_bins(&two, Some(&edges));
        assert_eq!(bins.len(), edges.len() - 1);
        for (bin, expected) in bins.iter().zip(expected["bins"].as_array().unwrap()) {
            assert_eq!(bin.n as u64, expected["n"].as_u64().unwrap());
            close(bin.mean, &expected["mean"]);
            close(bin.sd.unwrap(), &expected["sd"]);
        }
        for (test, expected) in adjacent_tests(&bins).iter().zip(expected["tests"].as_array().unwrap()) {
            close(test.test.u, &expected["u"]);
            close(test.test.p, &expected["p"]);
        }
    }
    let (found, expected) = (volume_trend(&two), &reference["trend"]);
    close(found.line.unwrap().slope, &expected["slope"]);
    close(found.line.unwrap().slope_error, &expected["slope_error"]);
    close(found.spearman.unwrap().rho, &expected["rho"]);
    close(found.spearman.unwrap().p, &expected["p"]);
    // The shipped data are a summary of this table.
    for (shipped, found) in villoutreix2016().unwrap().iter().zip(["Mac", "Mes", "LMic", "SMic"]) {
        let computed = summaries(&all).into_iter().find(|group| group.group == found).unwrap();
        assert_eq!((shipped.embryos, shipped.events.len()), (computed.embryos, computed.events.len()));
        for (shipped, computed) in shipped.events.iter().zip(&computed.events) {
            assert_eq!((&shipped.mother, shipped.n), (&computed.mother, computed.n));
            assert!((shipped.mean - computed.mean).abs() < 1e-6);
        }
    }
}

#[test]
#[ignore = "needs the published tables"]
fn asymmetry_over_the_dose_has_the_trend_of_scipy() {
    let table = published("rodrigues2024_dosage.csv");
    let doses = Doses::read(table.as_bytes(), "d.csv").unwrap();
    let (found, reference) = (trend(&doses.divisions), reference());
    let expected = &reference["dose"];
    assert_eq!((doses.divisions.len() as u64, doses.skipped_count), (expected["n"].as_u64().unwrap(), 0));
    close(found.spearman.unwrap().rho, &expected["rho"]);
    close(found.spearman.unwrap().p, &expected["p"]);
    for (line, expected) in [(found.chi_area, &expected["chi_area"]), (found.chi_volume, &expected["chi_volume"])] {
        let line = line.unwrap();
        close(line.slope, &expected["slope"]);
        close(line.slope_error, &expected["slope_error"]);
        close(line.intercept, &expected["intercept"]);
        close(line.intercept_error.unwrap(), &expected["intercept_error"]);
        close(line.r_squared.unwrap(), &expected["r_squared"]);
    }
    let computed = [by_condition(&doses.divisions), by_dose(&doses.divisions, None)];
    for (shipped, computed) in rodrigues2024().unwrap().iter().flatten().zip(computed.iter().flatten()) {
        assert_eq!((&shipped.name, shipped.n), (&computed.name, computed.n));
        for (a, b) in [(shipped.dose, computed.dose), (shipped.chi_area, computed.chi_area)] {
            assert!((a.mean - b.mean).abs() < 1e-6 && (a.sd.unwrap() - b.sd.unwrap()).abs() < 1e-6);
        }
    }
}
