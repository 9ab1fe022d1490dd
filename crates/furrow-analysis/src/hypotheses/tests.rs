//! Statistics beside SciPy's and on synthetic tables, and whole tests with divisions.

use std::sync::atomic::AtomicBool;
use std::sync::{LazyLock, Mutex};

use furrow_cell::Numerics;
use furrow_input::parse_document;
use furrow_lineage::batch::{Memo, Quantisation};
use furrow_lineage::{Lineage, TreeSettings};
use furrow_measured::volumes::{ReadOptions, Volumes};
use rand_mt::Mt64;

use super::fit_test::fit_test;
use super::free::Free;
use super::left_out::{held_out, without};
use super::noise::{aicc, common_sd, log_density, residuals};
use super::observations::{Chosen, LeftOut, Observation};
use super::*;
use crate::compare::names_of;
use crate::ensemble::normal;
use crate::fit::{Targets, fit_cue};
use crate::tempering::Sampling;

/// A table as text, read with the worm's names.
pub(super) fn table(text: &str) -> Observations {
    chosen(text, Chosen::default()).unwrap()
}

fn chosen(text: &str, chosen: Chosen<'_>) -> Result<Observations, String> {
    let lineage = Lineage::c_elegans().unwrap();
    let mut volumes = Volumes::default();
    let options = ReadOptions { names: names_of(&lineage), ..ReadOptions::default() };
    volumes.read(text.as_bytes(), "t.csv", &options).map_err(|error| error.to_string())?;
    let names = ("t.csv", ["--cells", "--population"]);
    Observations::of_tables(&volumes, &lineage, chosen, names).map_err(|error| error.to_string())
}

/// The divisions of P0, P1 and P2 in four embryos, one of them missing, with errors and volumes.
const TABLE: &str = "embryo,mother,chi,chi_sd,mother_um3
e0,P0,0.18,0.02,25000
e0,P1,0.17,0.025,11000
e0,P2,0.41,0.05,4500
e1,P0,0.15,0.03,24000
e1,P1,0.21,0.02,10500
e1,P2,0.35,0.06,4300
e2,P0,0.20,0.02,26000
e2,P1,0.14,0.03,11500
e2,P2,0.46,0.04,4700
e3,P0,0.17,0.025,25500
e3,P1,0.19,0.02,10800
";

const A: [f64; 3] = [0.19, 0.16, 0.38];
const B: [f64; 3] = [0.16, 0.20, 0.30];

fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{found} {expected}");
}

/// The sum of the logarithms of the densities of residuals.
fn log_likelihood(residuals: &[f64], sds: &[f64]) -> f64 {
    residuals.iter().zip(sds).map(|(residual, sd)| log_density(*residual, *sd)).sum()
}

pub(super) fn noise_of(observations: &Observations, kind: NoiseKind) -> Noise {
    Noise::of(observations, Some(kind), false, ("t.csv", "--noise")).unwrap()
}

pub(super) fn left_out(observations: &Observations, noise: &Noise, unit: usize, chi: &[Option<f64>]) -> f64 {
    let kept = without(&observations.rows, unit);
    held_out(observations, (&kept, &noise.of_part(&kept)), unit, chi)
}

/// Every number beside scipy 1.17: stats.norm.logpdf, chi2.sf, f.sf, ttest_1samp, optimize.minimize_scalar.
#[test]
fn likelihoods_and_tests_are_those_of_scipy() {
    let observations = table(TABLE);
    assert_eq!((observations.left_out, observations.units.len(), observations.rows.len()), (LeftOut::Embryo, 4, 11));
    // log likelihood with given errors, χ², its p; common σ, its log likelihood, AICc of 3 numbers; F and its p.
    let expected = [
        (A, 20.642550563400135, 16.632222222222218, 0.08290850506831543),
        (B, 12.585883896733467, 32.74555555555556, 0.0003005377336275536),
    ];
    let common = [
        (0.03605551275463989, 20.941326714579155, -32.45408200058688, 1.6962655601659735, 0.2431526760360271),
        (0.06543560331973859, 14.385252663918346, -19.341933899265264, 14.76182572614108, 0.0020660440409080404),
    ];
    let loo = [
        [6.520321053657121, 5.228420396731523, 3.992029901334023, 4.252153432447475],
        [3.857228424302892, 4.790877183978429, -1.021050238929095, 3.3998953489983554],
    ];
    let given = noise_of(&observations, NoiseKind::Given);
    let flat = noise_of(&observations, NoiseKind::Common);
    close(flat.sd.unwrap(), 0.03542891944913553);
    for (k, (model, log_l, chi_squared, p)) in expected.into_iter().enumerate() {
        let chi = model.map(Some);
        let off = residuals(&observations.rows, &chi);
        close(log_likelihood(&off, &given.sds(&observations.rows)), log_l);
        let Some(FitTest::ChiSquared { statistic, degrees_of_freedom: 10, p: Some(found) }) =
            fit_test(&observations, &given, &chi, 1)
        else {
            panic!("no χ²");
        };
        close(statistic, chi_squared);
        close(found, p);
        let (sigma, log_l, criterion, f, p) = common[k];
        close(common_sd(&off), sigma);
        let found = log_likelihood(&off, &flat.fitted(&observations.rows, &observations.rows, &chi));
        close(found, log_l);
        close(aicc(found, 3, 11).unwrap(), criterion);
        let Some(FitTest::LackOfFit { statistic, degrees_of_freedom: [2, 8], p: Some(found) }) =
            fit_test(&observations, &flat, &chi, 1)
        else {
            panic!("no F");
        };
        close(statistic, f);
        close(found, p);
        for (unit, part) in loo[k].into_iter().enumerate() {
            close(left_out(&observations, &flat, unit, &chi), part);
        }
    }
    let pair = Pair::of(("A", &loo[0]), ("B", &loo[1]));
    close(pair.delta.unwrap(), 8.965974065819559);
    close(pair.se.unwrap(), 4.170315737337679);
    close(pair.p.unwrap(), 0.12071353353604729);
    // Errors that grow as cells shrink.
    let grown = noise_of(&observations, NoiseKind::Replicates);
    assert!((grown.exponent - 0.5584381167802341).abs() < 1e-6, "{grown:?}");
    assert!((grown.sd.unwrap() - 0.032385312062798814).abs() < 1e-8);
    let off = residuals(&observations.rows, &A.map(Some));
    assert!((log_likelihood(&off, &grown.sds(&observations.rows)) - 22.017138226318526).abs() < 1e-6);
}

/// Number of synthetic tables.
pub(super) const SETS: usize = 200;

/// A synthetic table of cells in embryos about true χ, with errors of one size.
pub(super) fn synthetic(random: &mut Mt64, embryos: usize, truth: &[f64], sd: f64) -> Observations {
    let row = |k: usize, random: &mut Mt64| {
        let (unit, cell) = (k / truth.len(), k % truth.len());
        Observation { cell, unit, chi: truth[cell] + sd * normal(random), sd: Some(sd), volume: None }
    };
    Observations {
        cells: (0..truth.len()).map(|cell| cell.to_string()).collect(),
        units: (0..embryos).map(|unit| unit.to_string()).collect(),
        left_out: LeftOut::Embryo,
        rows: (0..embryos * truth.len()).map(|k| row(k, random)).collect(),
        ..Observations::default()
    }
}

/// Whether a count of `SETS` agrees with a probability, within three standard deviations.
pub(super) fn agrees(count: usize, p: f64) -> bool {
    let sets = SETS as f64;
    (count as f64 - p * sets).abs() <= 3.0 * (p * (1.0 - p) * sets).sqrt()
}

const TRUTH: [f64; 6] = [0.18, 0.17, 0.41, 0.05, 0.41, 0.3];
const SD: f64 = 0.03;

/// A right hypothesis has a p below 0.05 in one table of twenty, and p is even between 0 and 1; a wrong one has it as often as the
/// noncentral distributions say (scipy.stats.ncf and ncx2): 12 embryos, 6 cells, all χ off by 0.012.
#[test]
fn a_wrong_hypothesis_is_rejected_and_the_right_one_kept_at_the_rates_of_p() {
    for (kind, power) in [(NoiseKind::Common, 0.6687960046215606), (NoiseKind::Given, 0.24064876465707208)] {
        let mut random = Mt64::new(11);
        let [mut right, mut wrong] = [(); 2].map(|()| Vec::new());
        for _ in 0..SETS {
            let made = synthetic(&mut random, 12, &TRUTH, SD);
            let noise = noise_of(&made, kind);
            let p = |off: f64| {
                let chi = TRUTH.map(|chi| Some(chi + off));
                fit_test(&made, &noise, &chi, 0).and_then(|test| test.p()).unwrap()
            };
            right.push(p(0.0));
            wrong.push(p(0.012));
        }
        let rejected = |p: &[f64]| p.iter().filter(|p| **p < 0.05).count();
        assert!(agrees(rejected(&right), 0.05), "{kind:?}: {} right ones", rejected(&right));
        assert!(agrees(rejected(&wrong), power), "{kind:?}: {} wrong ones", rejected(&wrong));
        // Kolmogorov and Smirnov: a distance of 1.63/√n in one case of a hundred.
        right.sort_by(f64::total_cmp);
        let distance = right.iter().enumerate().map(|(k, p)| (p - (k as f64 + 0.5) / SETS as f64).abs());
        assert!(distance.fold(0.0, f64::max) < 1.63 / (SETS as f64).sqrt(), "{kind:?}");
    }
}

/// A pair of hypotheses by what each predicts, without a fit.
fn pair(made: &Observations, kind: NoiseKind, predictions: [&[f64; 6]; 2]) -> Pair {
    let parts = predictions.map(|model| {
        let chi = model.map(Some);
        (0..made.units.len()).map(|unit| left_out(made, &noise_of(made, kind), unit, &chi)).collect::<Vec<_>>()
    });
    Pair::of(("a", &parts[0]), ("b", &parts[1]))
}

/// Two hypotheses with equal errors are distinguishable in one table of twenty. A right and a wrong one are distinguishable in four of
/// five tables with the number of embryos that is said to be needed.
#[test]
fn pairs_are_distinguishable_at_the_rates_of_p() {
    let [above, below] = [0.01, -0.01].map(|off| TRUTH.map(|chi| chi + off));
    for kind in [NoiseKind::Common, NoiseKind::Given, NoiseKind::Replicates] {
        let mut random = Mt64::new(5);
        let told = |random: &mut Mt64, embryos: usize, predictions: [&[f64; 6]; 2]| {
            let made = (0..SETS).map(|_| synthetic(random, embryos, &TRUTH, SD));
            let found = made.map(|made| pair(&made, kind, predictions)).filter(|pair| pair.distinguishable);
            found.fold([0, 0], |[a, b], pair| if pair.delta.unwrap() > 0.0 { [a + 1, b] } else { [a, b + 1] })
        };
        let alike = told(&mut random, 12, [&above, &below]);
        assert!(agrees(alike.iter().sum(), 0.05), "{kind:?}: {alike:?}");
        // The mean and the standard deviation of the difference of one embryo for errors known: 6d²/2σ² and √6 d/σ.
        let (mean, sd) = (6.0 * (0.012 / SD).powi(2) / 2.0, 6.0_f64.sqrt() * 0.012 / SD);
        let needed = (2.801_585 * sd / mean).powi(2).ceil() as usize;
        let off = TRUTH.map(|chi| chi + 0.012);
        let [right, wrong] = told(&mut random, needed, [&TRUTH, &off]);
        assert!(wrong == 0 && agrees(right, 0.8), "{kind:?}: {right} of {needed} embryos");
    }
}

/// The mean of the embryos needed, over tables too small to tell, is about the number that the true difference needs.
#[test]
fn the_embryos_needed_are_those_of_the_true_difference() {
    let (off, mut random) = (TRUTH.map(|chi| chi + 0.012), Mt64::new(3));
    let embryos = 1500;
    let found = pair(&synthetic(&mut random, embryos, &TRUTH, SD), NoiseKind::Given, [&TRUTH, &off]);
    let parts = (found.delta.unwrap() / embryos as f64, found.se.unwrap() / (embryos as f64).sqrt());
    assert!((parts.0 / 0.48 - 1.0).abs() < 0.1 && (parts.1 / 0.979_796 - 1.0).abs() < 0.05, "{parts:?}");
    let same = Pair::of(("a", &[1.0, 1.0]), ("b", &[1.0, 1.0]));
    assert_eq!((same.p, same.distinguishable, same.needed), (None, false, None));
}

#[test]
fn tables_are_read_by_their_columns_and_refused_with_reasons() {
    let text = "mother,chi\nP0,0.18\nAB,0.01\nQ9,0.2\nMSap,0.1\n";
    let found = table(text);
    assert_eq!(found.cells, ["P0", "AB", "MSap"]);
    assert_eq!((found.left_out, found.units), (LeftOut::Division, vec!["P0".into(), "AB".into(), "MSap".into()]));
    assert_eq!(found.unused, [Unused { cell: "Q9".into(), n: 1, why: "the lineage has no such cell" }]);
    let cells = ["P0".to_owned(), "EMS".to_owned()];
    let refusal = chosen(text, Chosen { cells: Some(&cells), groups: None }).unwrap_err();
    assert_eq!(refusal, "--cells: cells = \"EMS\": must be measured cells of the lineage: P0, AB, MSap");
    let refusal = chosen("mother,chi\nQ9,0.2\n", Chosen::default()).unwrap_err();
    let start = "t.csv: mother = none of the lineage: must be at least one measured χ of a cell of Caenorhabditis elegans: P0, AB";
    assert!(refusal.starts_with(start) && refusal.contains("; the table has Q9. --names"), "{refusal}");
    // A part of the rows has errors; no cell was measured twice.
    let some = table("mother,chi,sd\nP0,0.18,0.02\nAB,0.01,\n");
    let refused = |kind| Noise::of(&some, kind, false, ("t.csv", "--noise")).unwrap_err().to_string();
    assert!(refused(None).starts_with("t.csv: chi_sd = 1 of 2 rows: must be given in every row"), "{}", refused(None));
    assert!(refused(Some(NoiseKind::Replicates)).contains("no cell was measured in two embryos"));
}

/// Mothers without names are called by the joined texts of columns, several of a class in an embryo. Populations are parts of an embryo:
/// two embryos are left out, and not four.
#[test]
fn mothers_without_names_are_called_by_their_class() {
    let text = "embryo,mother,population,generation,larger_um3,smaller_um3
e1,7,P,0,60,40\ne1,8,P,0,55,45\ne1,9,A,B,50,50\ne2,7,A,B,52,48\ne2,9,P,0,58,42\n";
    let lineage = Lineage::c_elegans().unwrap();
    let read = |class: &str| {
        let class = class.split(',').map(str::to_owned).collect();
        let options = ReadOptions { names: names_of(&lineage), class, ..ReadOptions::default() };
        let mut volumes = Volumes::default();
        volumes.read(text.as_bytes(), "t.csv", &options).map(|()| volumes).map_err(|error| error.to_string())
    };
    let volumes = read("population,Generation").unwrap();
    assert_eq!(volumes.skipped_count, 2, "generations are whole numbers");
    let of =
        |chosen| Observations::of_tables(&volumes, &lineage, chosen, ("t.csv", ["--cells", "--population"])).unwrap();
    let found = of(Chosen::default());
    assert_eq!((found.cells, found.units), (vec!["P0".to_owned()], vec!["e1".to_owned(), "e2".to_owned()]));
    assert_eq!(found.rows.iter().map(|row| row.unit).collect::<Vec<_>>(), [0, 0, 1]);
    let refusal = read("popu").unwrap_err();
    assert!(refusal.contains("no column is called popu; the columns here are \"embryo\", \"mother\""), "{refusal}");
}

/// A fitted number fits no worse than the one that the lineage gives, however short the search.
#[test]
fn a_fitted_number_fits_no_worse_than_the_given_one() {
    let observations = table(TABLE);
    let given = tested(&observations, None, &["germline"], "none", 1);
    let fitted = tested(&observations, None, &["germline"], "epsilon@P2=0.5..0.95,xi_s@P0,r0", 2);
    assert!(fitted.hypotheses[0].log_likelihood >= given.hypotheses[0].log_likelihood - 1e-9, "{fitted}");
    assert_eq!(fitted.hypotheses[0].parameters[2].searched, [2.7, 10.8]);
}

/// A hypothesis with numbers by founder fits no worse than the one with shared numbers that it includes, in any order, however short
/// its search is.
#[test]
fn a_hypothesis_fits_no_worse_than_one_that_it_includes() {
    let observations = table(TABLE);
    let named = |name: &str, free: &[&str]| Named {
        name: name.to_owned(),
        cue: "germline".to_owned(),
        free: Some(free.iter().map(|free| (*free).to_owned()).collect()),
    };
    let large = named("large", &["epsilon", "epsilon@P1", "epsilon@P2"]);
    let small = named("small", &["epsilon"]);
    let found = asked(&observations, None, (&[large, small], None), (2, None));
    let [large, small] = &found.hypotheses[..] else { panic!("{found:?}") };
    assert_eq!((large.name.as_str(), small.name.as_str()), ("large", "small"));
    assert!(large.log_likelihood >= small.log_likelihood - 1e-9, "{found}");
}

#[test]
fn free_numbers_have_classes_that_do_not_overlap() {
    let lineage = Lineage::c_elegans().unwrap();
    let list = |text: &str| {
        let texts: Vec<String> = text.split(',').map(str::to_owned).collect();
        Free::list(&texts, &lineage, "--free").map_err(|error| error.to_string())
    };
    assert_eq!(list("none").unwrap(), []);
    assert_eq!(list("epsilon@somatic, epsilon@P1,cue.amplitude").unwrap().len(), 3);
    for (text, reason) in [
        ("epsilon@P1,epsilon@P1", "each parameter once for a class"),
        ("epsilon,epsilon", "each parameter once for a class"),
        ("epsilon,epsilon@somatic,epsilon@germline", "a class with cells that have no number of their own"),
        ("epsilon@germlin", "did you mean germline?"),
        ("epsilom", "did you mean epsilon?"),
        ("r0@P1", "left out: r0 is the first cell's"),
        ("epsilon=0.9..0.4", "FROM below TO"),
        ("epsilon=0.4..1.4", "a range of epsilon with"),
    ] {
        let refusal = list(text).unwrap_err();
        assert!(refusal.starts_with("--free: free = ") && refusal.contains(reason), "{refusal}");
    }
    let free = list("epsilon@somatic=0.4..0.9,cue.amplitude,cue.u0").unwrap();
    let cell = furrow_cell::Cell::new(5.4);
    let named =
        |cues: &[&str]| Named::list(&cues.iter().map(|cue| (*cue).to_owned()).collect::<Vec<_>>(), "--cue").unwrap();
    let cues = named(&["none", "gradient=tension:gradient,amplitude=-0.3", "germline"]);
    let all = Hypothesis::all(&cues, Some(&free), &lineage, &cell, ["--cue", "--free"]).unwrap();
    assert_eq!(all.iter().map(Hypothesis::free).collect::<Vec<_>>(), [1, 2, 3]);
    let epsilon = &all[1].unknowns[0];
    assert_eq!((epsilon.name().as_str(), epsilon.limits, epsilon.value(0.5)), ("epsilon@somatic", [0.4, 0.9], 0.65));
    let refusal = Hypothesis::all(&cues[..1], Some(&free[1..]), &lineage, &cell, ["--cue", "--free"]).unwrap_err();
    assert!(refusal.to_string().contains("a number that at least one of the hypotheses has"), "{refusal}");
    let twice = named(&["none", "none"]);
    let refusal = Hypothesis::all(&twice, None, &lineage, &cell, ["--cue", "--free"]).unwrap_err();
    assert!(refusal.to_string().contains("names that differ"), "{refusal}");
}

/// The number of a smaller class replaces the number of a larger class, in any order of the list.
#[test]
fn a_smaller_class_has_a_number_of_its_own() {
    let lineage = Lineage::c_elegans().unwrap();
    let place = |name: &str| lineage.founder_named(name).unwrap();
    let texts = ["epsilon@P2", "epsilon", "epsilon@somatic", "epsilon@E"].map(str::to_owned);
    let free = Free::list(&texts, &lineage, "--free").unwrap();
    let cell = furrow_cell::Cell::new(5.4);
    let named = Named::list(&["none".to_owned()], "--cue").unwrap();
    let all = Hypothesis::all(&named, Some(&free), &lineage, &cell, ["--cue", "--free"]).unwrap();
    let of = |name: &str| -> Vec<String> {
        all[0].unknowns.iter().filter(|unknown| unknown.is_of(place(name))).map(|unknown| unknown.name()).collect()
    };
    assert_eq!(
        [of("P0"), of("P2"), of("AB"), of("E")],
        [["epsilon"], ["epsilon@P2"], ["epsilon@somatic"], ["epsilon@E"]]
    );
}

/// Each hypothesis of a file has its own free numbers; a fault names the file and the field.
#[test]
fn hypotheses_are_read_from_a_file() {
    let (folder, lineage) = (tempfile::tempdir().unwrap(), Lineage::c_elegans().unwrap());
    let cell = furrow_cell::Cell::new(5.4);
    let read = |text: &str| {
        let file = folder.path().join("h.ron");
        std::fs::write(&file, text).unwrap();
        let named = Named::file(&file).map_err(|error| error.to_string())?;
        let free = Free::list(&["epsilon".to_owned()], &lineage, "--free").unwrap();
        Hypothesis::all(&named, Some(&free), &lineage, &cell, ["h.ron", "--free"]).map_err(|error| error.to_string())
    };
    let found = read(
        "Hypotheses(hypotheses: [(name: \"a, b\", cue: \"germline\", free: [\"cue.amplitude\", \"cue.amplitude@P2\"]), \
         (name: \"none\", cue: \"none\")])",
    )
    .unwrap();
    let names = |k: usize| found[k].unknowns.iter().map(|unknown| unknown.name()).collect::<Vec<_>>();
    assert_eq!(
        (found[0].name.as_str(), names(0)),
        ("a, b", vec!["cue[0].amplitude".into(), "cue[0].amplitude@P2".into()])
    );
    assert_eq!(names(1), ["epsilon"]);
    for (text, reason) in [
        ("Hypotheses(hypotheses: [])", "h.ron: hypotheses = []: must be at least one hypothesis"),
        ("Hypotheses(hypotheses: [(name: \" \", cue: \"none\")])", "hypotheses[0].name"),
        ("Hypotheses(hypotheses: [(name: \"a\", cue: \"nine\")])", "h.ron: cue = "),
        (
            "Hypotheses(hypotheses: [(name: \"a\", cue: \"none\", free: [\"cue.amplitude\"])])",
            "that the hypothesis a has",
        ),
        ("Hypotheses(hypotheses: [(name: \"a\", kue: \"none\")])", "kue"),
    ] {
        let refusal = read(text).unwrap_err();
        assert!(refusal.contains(reason), "{refusal}");
    }
}

/// Rounds and lifetimes add the logarithm of their normal density to the log likelihood.
#[test]
fn rounds_and_lifetimes_count_beside_chi() {
    let lineage = Lineage::c_elegans().unwrap();
    let given = |observations: Observations, cues: &[&str], free: &str| tested(&observations, None, cues, free, 2);
    let chi = table("mother,chi,sd\nP0,0.08,0.05\nP1,0.08,0.05\n");
    let alone = given(chi.clone(), &["germline"], "none");
    let rounds = Others::rounds(&lineage, 1.0, "--rounds").unwrap();
    assert_eq!(rounds.len(), 6);
    let life = "cell,lifetime_min\nABa,20\nABp,30\nABal,25\nCaaaaaaaaa,60\nQ9,3\n";
    let lifetimes = furrow_measured::lifetimes::Lifetimes::read(life.as_bytes(), "l.csv").unwrap();
    let lifetimes = Others::lifetimes(&lifetimes, &lineage, 0.2, "--lifetimes").unwrap();
    let with = Observations { others: vec![rounds, lifetimes], ..chi };
    let beside = given(with, &["germline"], "none");
    let (alone, beside) = (&alone.hypotheses[0], &beside.hypotheses[0]);
    let [rounds, lifetimes] = &beside.others[..] else { panic!("{beside:?}") };
    // Mean rounds of the default tree: AB 6.25 … P4 0, beside 9.047, 6.681, 4.4, 5.667, 4.4, 1.
    let of = |name: &str| rounds.rows.iter().find(|row| row.name == name).unwrap();
    assert_eq!((of("AB").observed, of("P4").model), (9.047, Some(0.0)));
    let off: Vec<f64> = rounds.rows.iter().map(|row| row.observed - row.model.unwrap()).collect();
    close(rounds.log_likelihood, log_likelihood(&off, &[1.0; 6]));
    let names: Vec<(&str, usize, usize)> =
        lifetimes.rows.iter().map(|row| (row.name.as_str(), row.n, row.resting)).collect();
    assert_eq!(names, [("AB+1", 2, 0), ("AB+2", 1, 0), ("C+9", 1, 1)]);
    close(lifetimes.rows[0].observed, 600.0_f64.sqrt());
    let off = |k: usize| lifetimes.rows[k].model.map_or(1.0, |model| (lifetimes.rows[k].observed / model).ln());
    close(lifetimes.log_likelihood, log_likelihood(&[off(0), off(1), off(2)], &[0.2; 3]));
    close(beside.log_likelihood, alone.log_likelihood + rounds.log_likelihood + lifetimes.log_likelihood);
    // Nothing is fitted: what was left out is predicted as well.
    assert_eq!((rounds.left_out, lifetimes.left_out), (rounds.log_likelihood, lifetimes.log_likelihood));
    let refused = Others::rounds(&lineage, 0.0, "--rounds").unwrap_err().to_string();
    assert_eq!(refused, "--rounds: sd = 0: must be a finite number above 0");
    let bare = Lineage { clock: None, founders: vec![lineage.founders[0].clone()], ..lineage };
    let none = furrow_measured::lifetimes::Lifetimes::default();
    assert!(
        Others::lifetimes(&none, &bare, 0.2, "--lifetimes").unwrap_err().to_string().contains("a lineage with a clock")
    );
}

/// Tests hypotheses on the worm's lineage with coarse divisions.
pub(super) fn tested(
    observations: &Observations,
    kind: Option<NoiseKind>,
    cues: &[&str],
    free: &str,
    threads: usize,
) -> HypothesisTest {
    sampled(observations, kind, cues, free, (threads, None))
}

/// The same with a sample of each posterior.
fn sampled(
    observations: &Observations,
    kind: Option<NoiseKind>,
    cues: &[&str],
    free: &str,
    (threads, sampling): (usize, Option<Sampling>),
) -> HypothesisTest {
    let lineage = Lineage::c_elegans().unwrap();
    let cues: Vec<String> = cues.iter().map(|cue| (*cue).to_owned()).collect();
    let free: Vec<String> = free.split(',').map(str::to_owned).collect();
    let free = Free::list(&free, &lineage, "--free").unwrap();
    let cues = Named::list(&cues, "--cue").unwrap();
    asked(observations, kind, (&cues, Some(&free)), (threads, sampling))
}

/// The hypotheses of a list, which may have free numbers of their own.
fn asked(
    observations: &Observations,
    kind: Option<NoiseKind>,
    (named, free): (&[Named], Option<&[Free]>),
    (threads, sampling): (usize, Option<Sampling>),
) -> HypothesisTest {
    let (lineage, settings, cancel) = (Lineage::c_elegans().unwrap(), coarse(), AtomicBool::new(false));
    let hypotheses = Hypothesis::all(named, free, &lineage, &settings.cell, ["--cue", "--free"]).unwrap();
    let noise = Noise::of(observations, kind, false, ("t.csv", "--noise")).unwrap();
    let SearchBudget { particles, moves, seed } = EFFORT;
    let effort = Effort { particles: Some(particles), moves: Some(moves), seed };
    let question =
        Question { observations, hypotheses: &hypotheses, noise: &noise, effort, sampling, memo: &MEMOS[threads] };
    let reports = Mutex::new(Vec::new());
    let show = |FitProgress { done, of, .. }| reports.lock().unwrap().push((done, of));
    let run = FitRun { progress: Some(&show), ..FitRun::new(&lineage, &settings, threads, &cancel) };
    let found = test(&run, &question).unwrap();
    let reports = reports.into_inner().unwrap();
    // Progress is counted over all hypotheses. Several threads report in any order.
    assert!(reports.iter().all(|&(done, of)| done <= of && of == reports[0].1), "{reports:?}");
    assert!(threads > 1 || reports.is_sorted(), "{reports:?}");
    found
}

/// Divisions of all tests with the same number of threads: their searches begin at the same cells.
static MEMOS: [LazyLock<Memo>; 4] = [const { LazyLock::new(|| Memo::new(Quantisation::EXACT)) }; 4];

const EFFORT: SearchBudget = SearchBudget { particles: 4, moves: 3, seed: 1 };

pub(super) fn coarse() -> TreeSettings {
    TreeSettings { numerics: Numerics { intervals: 32, ..Numerics::default() }, ..TreeSettings::default() }
}

/// One hypothesis with errors of one size is the fit of its cue to the means, and its likelihood follows from χ².
#[test]
fn one_hypothesis_with_flat_noise_is_the_fit_of_its_cue() {
    let text = "Fit(unknowns: [(parameter: p0, from: 0.1, to: 0.2)], founders: [], chi: [
        (cell: \"P0\", mean: 0.17, sd: 0.03), (cell: \"P1\", mean: 0.14, sd: 0.03), (cell: \"P2\", mean: 0.16, sd: 0.03)])";
    let targets: Targets = parse_document(text, "t.ron", "a file of targets", "Fit").unwrap();
    let (lineage, settings, cancel) = (Lineage::c_elegans().unwrap(), coarse(), AtomicBool::new(false));
    let cue = "tension:gradient,amplitude=-0.3";
    let run = FitRun::new(&lineage, &settings, 1, &cancel);
    let fitted = fit_cue(&run, &targets, &cue.parse().unwrap(), EFFORT).unwrap();
    let observations = Observations::of_targets(&targets, &lineage, None, ("t.ron", "--cells")).unwrap();
    let given = tested(&observations, None, &[cue], "cue.amplitude", 2);
    let [found] = &given.hypotheses[..] else { panic!("{given:?}") };
    // As given errors: every number is the same, to the accuracy of a search in steps.
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-6 * b.abs(), "{a} {b}");
    near(found.parameters[0].value, fitted.numbers[0].value);
    near(found.parameters[0].se.unwrap(), fitted.numbers[0].sd.unwrap());
    let chi_squared = fitted.goodness.chi_squared;
    near(found.log_likelihood, -0.5 * (chi_squared + 3.0 * (std::f64::consts::TAU * 0.03 * 0.03).ln()));
    let Some(FitTest::ChiSquared { statistic, p, .. }) = found.fit else { panic!("{found:?}") };
    near(statistic, chi_squared);
    near(p.unwrap(), fitted.goodness.p.unwrap());
    // As one common error: the same place, and the spread of the residuals.
    let flat = tested(&observations, Some(NoiseKind::Common), &[cue], "cue.amplitude", 1);
    let [flat] = &flat.hypotheses[..] else { panic!("{flat:?}") };
    near(flat.parameters[0].value, fitted.numbers[0].value);
    near(flat.sigma.unwrap(), 0.03 * (chi_squared / 3.0).sqrt());
    assert_eq!((flat.k, found.k, flat.log_evidence), (2, 1, None));
    assert!(fitted.goodness.error_scale.unwrap() > 1.0);
    near(flat.parameters[0].se.unwrap(), fitted.numbers[0].sd.unwrap());
}

/// Embryos that follow one cue speak for it; the answer does not depend on the number of threads; a cell that rests is reported and
/// the others count. Numbers of a class change its cells alone.
#[test]
fn the_cue_that_made_the_data_is_found_at_any_number_of_threads() {
    let truth = "tension:gradient,amplitude=-0.12";
    let cells = ["P0", "P1", "P2", "EMS"];
    let one: String = cells.iter().map(|cell| format!("e,{cell},0.1\n")).collect();
    let model = tested(&table(&format!("embryo,mother,chi\n{one}")), None, &[truth], "none", 1);
    let chi: Vec<(String, f64)> =
        model.hypotheses[0].cells.iter().map(|cell| (cell.cell.clone(), cell.chi.unwrap())).collect();
    let mut random = Mt64::new(2);
    let mut text = "embryo,mother,chi_signed\n".to_owned();
    for embryo in 0..6 {
        for (cell, chi) in &chi {
            text += &format!("e{embryo},{cell},{}\n", chi + 0.02 * normal(&mut random));
        }
    }
    let observations = table(&text);
    let cues = ["none", "band=kappa:band,u0=0.465,omega=0.0577,amplitude=0.1", "right=tension:gradient,amplitude=-0.3"];
    let [found, again] =
        [1, 3].map(|threads| tested(&observations, Some(NoiseKind::Replicates), &cues, "cue.amplitude", threads));
    assert_eq!(serde_json::to_string(&found).unwrap(), serde_json::to_string(&again).unwrap());
    let [none, band, right] = &found.hypotheses[..] else { panic!("{found:?}") };
    assert_eq!([none.k, band.k, right.k], [0, 1, 1]);
    let FittedNumber { value, se, .. } = &right.parameters[0];
    assert!((value + 0.12).abs() < 3.0 * se.unwrap(), "{right:?}");
    assert!(right.fit.unwrap().p().unwrap() > 0.01 && none.fit.unwrap().p().unwrap() < 1e-6);
    assert!(right.loo > band.loo && band.loo > none.loo && right.weight.unwrap() > 0.99, "{found}");
    assert!(right.log_evidence.unwrap() < right.log_likelihood && right.log_evidence > none.log_evidence);
    assert!(found.pairs.iter().all(|pair| pair.distinguishable), "{found}");
    // A table without the embryo gives the same fit, to the accuracy of coarse divisions.
    let others: String = text.lines().filter(|line| !line.starts_with("e0,")).map(|line| format!("{line}\n")).collect();
    let without = table(&others);
    let without = tested(&without, Some(NoiseKind::Replicates), &cues[2..], "cue.amplitude", 1);
    let chi: Vec<Option<f64>> = without.hypotheses[0].cells.iter().map(|cell| cell.chi).collect();
    let part = left_out(&observations, &noise_of(&observations, NoiseKind::Replicates), 0, &chi);
    assert!(
        right.loo_parts.len() == 6 && (right.loo_parts[0].unwrap() - part).abs() < 0.02,
        "{:?} {part}",
        right.loo_parts
    );
    let resting = tested(&table("mother,chi\nP0,0.2\nCaaa,0.2\n"), None, &["none"], "none", 1);
    let rests = &resting.hypotheses[0];
    assert_eq!((rests.resting.len(), rests.cells.len()), (1, 2), "{resting}");
    assert!(resting.to_string().contains("Caaa does not divide"), "{resting}");
    // The errors of numbers follow from the cells that divide.
    let text = "mother,chi,sd\nP0,0.17,0.03\nP1,0.14,0.03\nCaaa,0.2,0.05\n";
    let resting = tested(&table(text), None, &cues[2..], "cue.amplitude", 1);
    let rests = &resting.hypotheses[0];
    assert!(
        rests.resting == ["Caaa"] && rests.parameters[0].se.is_some() && rests.loo.unwrap().is_finite(),
        "{resting}"
    );
}

/// One number with small errors: the sample has the fit's mean and standard error, and Laplace's evidence.
#[test]
fn a_sample_agrees_with_the_fit_where_that_is_good() {
    let observations = table("embryo,mother,chi,sd\na,P0,0.165,0.014\nb,P0,0.175,0.014\n");
    let cues = ["tension:gradient,amplitude=-0.3", "none"];
    let sampling = Some(Sampling { particles: 30, seed: 4 });
    let found = sampled(&observations, None, &cues, "cue.amplitude", (2, sampling));
    let [gradient, none] = &found.hypotheses[..] else { panic!("{found:?}") };
    let posterior = gradient.posterior.as_ref().unwrap();
    let (number, fitted) = (&posterior.parameters[0], &gradient.parameters[0]);
    let error = fitted.se.unwrap();
    assert!((number.mean - fitted.value).abs() < error && (number.sd / error - 1.0).abs() < 0.35, "{found}");
    assert!((posterior.log_evidence - gradient.log_evidence.unwrap()).abs() < 0.5, "{found}");
    assert_eq!((posterior.samples, posterior.ridges.len()), (30, 0));
    // Without a free number the sample is the fit; χ = 0 is 17 standard deviations from the measured mean.
    let one = none.posterior.as_ref().unwrap();
    assert!(one.samples == 1 && (one.log_evidence - none.log_likelihood).abs() < 1e-9);
    assert!(one.surprising().count() == 1 && found.to_string().contains("P0 is surprising, p = "), "{found}");
    let csv = samples_of(&found);
    assert!(csv.starts_with("hypothesis,cue[0].amplitude\n\"tension:gradient,amplitude=-0.3\",-0."), "{csv}");
    assert_eq!(csv.lines().count(), 32);
}

fn samples_of(found: &HypothesisTest) -> String {
    let named = |tested: &TestedHypothesis| tested.posterior.clone().map(|posterior| (tested.name.clone(), posterior));
    let all: Vec<(String, Posterior)> = found.hypotheses.iter().filter_map(named).collect();
    samples_csv(all.iter().map(|(name, posterior)| (name.as_str(), posterior)), None)
}

/// Cells that divide equally, measured with errors: the right hypothesis is rejected because \|χ\| > 0, unless it is known that χ has
/// lost its sign. Then it is kept in 19 of 20 tables or more: where χ = 0 the test is cautious.
#[test]
fn equal_divisions_are_not_rejected_for_the_errors_of_their_measurement() {
    let mut random = Mt64::new(12);
    let chi = [Some(0.17), Some(0.0), Some(0.0), Some(0.0)];
    let mut rejected = [[0; 2]; 2];
    for _ in 0..SETS {
        let mut text = "embryo,mother,chi,sd\n".to_owned();
        for embryo in 0..6 {
            for (cell, chi) in ["P0", "AB", "EMS", "MS"].iter().zip(chi) {
                let x = (chi.unwrap() + 0.03 * normal(&mut random)).abs();
                text += &format!("e{embryo},{cell},{x},0.03\n");
            }
        }
        let observations = table(&text);
        for (kind, rejected) in [NoiseKind::Given, NoiseKind::Replicates].into_iter().zip(&mut rejected) {
            for (folded, rejected) in [false, true].into_iter().zip(rejected) {
                let noise = Noise::of(&observations, Some(kind), folded, ("t.csv", "--noise")).unwrap();
                let p = fit_test(&observations, &noise, &chi, 0).and_then(|test| test.p()).unwrap();
                *rejected += usize::from(p < 0.05);
            }
        }
    }
    let [[_, of_given], [of_replicates, cautious]] = rejected;
    assert!(agrees(of_given, 0.05), "{rejected:?}");
    assert!(of_replicates > SETS / 2 && cautious <= SETS / 20 + 8, "{rejected:?}");
}

/// Without a model: a common error leaves ½Γ(n/2)(πΣr²)^(−n/2) of the likelihood.
#[test]
fn a_common_error_is_integrated_out() {
    let observations = table("mother,chi\nP0,0.18\nP1,0.14\nP2,0.3\n");
    let noise = noise_of(&observations, NoiseKind::Common);
    let chi = [0.16, 0.15, 0.25];
    let residuals = residuals(&observations.rows, &chi.map(Some));
    // By the trapezoidal rule over ln σ.
    let steps = (-700..500).map(|k| 0.01 * f64::from(k));
    let integral: f64 = steps.map(|log: f64| 0.01 * log_likelihood(&residuals, &[log.exp(); 3]).exp()).sum();
    let found = super::posterior::log_density_of(&observations.rows, &chi.map(Some), &noise);
    assert!((found - integral.ln()).abs() < 1e-6, "{found} {}", integral.ln());
    // Of χ that has lost its sign, by the same rule over the folded density.
    let noise = Noise { folded: true, ..noise };
    let chi = [Some(0.05), Some(0.0), Some(0.02)];
    let steps = (-700..900).map(|k| 0.01 * f64::from(k));
    let of = |log: f64| 0.01 * noise.log_likelihood(&observations.rows, &chi, &[log.exp(); 3]).exp();
    let found = super::posterior::log_density_of(&observations.rows, &chi, &noise);
    let expected = steps.map(of).sum::<f64>().ln();
    assert!((found - expected).abs() < 1e-6, "{found} {expected}");
}

/// Undefined are the score of a left-out division that is the only one, all weights if there are too few divisions for AICc, errors of
/// replicates that are all equal, and the test of a difference that is the same in each embryo.
#[test]
fn what_is_not_determined_has_no_number() {
    let cues = ["none", "tension:gradient,amplitude=-0.3"];
    let one = table("mother,chi,sd\nP0,0.17,0.03\n");
    let found = tested(&one, None, &cues, "cue.amplitude", 1);
    let [none, gradient] = &found.hypotheses[..] else { panic!("{found:?}") };
    assert_eq!((none.loo, gradient.loo), (Some(none.log_likelihood), None));
    assert_eq!((found.pairs[0].delta, found.pairs[0].p), (None, None));
    let text = found.to_string();
    assert!(
        text.contains("without P0 the data do not determine its fit") && text.contains(": no test, left out"),
        "{text}"
    );
    let two = table("mother,chi,sd\nP0,0.17,0.03\nP1,0.14,0.03\n");
    let found = tested(&two, None, &cues, "cue.amplitude", 1);
    let [none, gradient] = &found.hypotheses[..] else { panic!("{found:?}") };
    assert!(none.aicc.is_some() && gradient.aicc.is_none() && none.weight.is_none() && none.delta_aicc.is_none());
    assert!(
        found.to_string().contains("k = 1 needs 3 data or more; weights need the AICc of every hypothesis"),
        "{found}"
    );
    let constant: String = (0..3).map(|e| format!("e{e},P0,0.17\ne{e},P1,0.14\n")).collect();
    let constant = table(&format!("embryo,mother,chi\n{constant}"));
    let refusal =
        Noise::of(&constant, Some(NoiseKind::Replicates), false, ("t.csv", "--noise")).unwrap_err().to_string();
    assert_eq!(refusal, "--noise: noise = replicates: must be given or common: no cell differs between embryos");
    let found = tested(&constant, None, &cues, "cue.amplitude", 1);
    assert!(found.pairs[0].p.is_none() && !found.pairs[0].distinguishable && found.hypotheses[1].fit.is_none());
    assert!(found.to_string().contains("no test, all parts differ alike: not distinguishable"), "{found}");
}
