//! Figures 4 and 5: the lineage that the model grows, beside the embryo.

use super::context::{Artifact, Figure, Finding, ReproduceError};
use super::readings::chi_in_words;
use crate::compare::counts::counts;
use crate::tree_settings;
use furrow_cell::settings::Settings;
use furrow_input::InputError;
use furrow_lineage::batch::{critical_radii, solve};
use furrow_lineage::{EndRule, Grower, Lineage, Thresholds, Tree, TreeCell, founder_rounds};
use furrow_measured::events::Division as Measured;
use furrow_measured::published::{SOURCE, jankele2021_divisions};
use furrow_measured::statistics::{grouped, mean, rank_sum};
use furrow_mechanics::division::Outcome;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Volume of P0, in µm³, as a caption of the paper gives it.
const ZYGOTE_VOLUME: f64 = 20_890.0;

/// Grows a lineage with the constants of the settings.
pub fn grow(figure: &Figure<'_>, lineage: &Lineage) -> Result<Tree, ReproduceError> {
    let context = figure.context;
    let numerics = context.converged();
    let settings = Settings { numerics, ..context.settings.clone() };
    let settings = tree_settings(settings, lineage, 0, context.memo.quantisation());
    let rule = Thresholds::new(critical_radii(&numerics, None).interrupted_by(context.cancel));
    let ends = EndRule::Thresholds(&rule);
    let grower = Grower { lineage, settings, ends, memo: context.memo, options: context.options() };
    let (tree, _) = grower.grow(solve)?;
    context.check_cancelled()?;
    Ok(tree)
}

pub fn cell_named<'t>(tree: &'t Tree, name: &str) -> Option<&'t TreeCell> {
    tree.cells().map(|id| tree.cell(id)).find(|cell| cell.name == name)
}

/// χ of cells by name; `None` for one that does not divide.
fn chi_of<const N: usize>(tree: &Tree, names: [&str; N]) -> [Option<f64>; N] {
    names.map(|name| cell_named(tree, name)?.fate.chi())
}

fn joined(chi: &[Option<f64>]) -> String {
    chi.iter().map(|chi| chi_in_words(*chi)).collect::<Vec<_>>().join(", ")
}

/// Figure 4C: rounds of the founders, read as the most of any of their cells.
pub fn rounds(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let tree = grow(figure, &Lineage::c_elegans()?)?;
    let counts = counts(&tree, "c_elegans.ron (built in)")?;
    let hatching = counts.stages.last();
    let named = ["AB", "EMS", "C", "D"].map(|name| {
        let founder = hatching.and_then(|stage| stage.founders.iter().find(|founder| founder.founder == name));
        let most = founder.and_then(|founder| founder.counts.get("max"));
        most.map_or(format!("{name} -"), |count| {
            format!("{name} {} for {}", count.model.map_or("-".to_owned(), |n| n.to_string()), count.observed)
        })
    });
    let [germline, observed] = counts.germline.unwrap_or_default();
    let others = counts.sentence.iter().filter(|of| of.holds).map(|of| of.reading).collect::<Vec<_>>().join(", ");
    let holds = counts.sentence.iter().any(|of| of.reading == "max" && of.holds);
    let text = format!("{}, P {germline} for {observed}", named.join(", "));
    let note = format!(
        "readings of rounds by which the sentence is true: {}",
        if others.is_empty() { "none" } else { &others }
    );
    figure.findings.push(Finding::judged("rounds", (holds, text)).noting(note));
    figure.show("4C", Artifact::Tree(Box::new(tree)));
    Ok(())
}

/// Figure 4B: AB, and the germline.
pub fn divisions(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let tree = grow(figure, &Lineage::c_elegans()?)?;
    let ab = tree.lineage.founder_named("AB");
    let symmetric = ab.and_then(|ab| founder_rounds(&tree)[ab]).map(|rounds| f64::from(rounds.symmetric));
    figure.number("ab_rounds", symmetric.ok_or("AB is not born"));
    let chi = chi_of(&tree, GERMLINE);
    let outcome = cell_named(&tree, "P4").and_then(|cell| cell.fate.outcome());
    let p4 = if outcome.is_some_and(|outcome| outcome != Outcome::Arrested) { "divides" } else { "does not divide" };
    figure.judge("germline", escalates(&chi), format!("{}; P4 {p4}", joined(&chi)));
    Ok(())
}

/// Whether all cells divide, each more unequally than the one before.
fn escalates(chi: &[Option<f64>]) -> bool {
    chi.windows(2).all(|pair| pair[0].zip(pair[1]).is_some_and(|(before, next)| next > before))
}

/// Cells of AB's descent that figure 5C shows, by falling volume.
const DESCENT: [&str; 4] = ["ABa", "ABal", "ABalap", "ABalaa"];

/// Figure 5C: χ along AB's descent, of the model and of a table of the user's that has all of these divisions.
pub fn descent(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let tree = grow(figure, &Lineage::c_elegans()?)?;
    let chi = chi_of(&tree, DESCENT);
    figure.judge("descent_model", escalates(&chi), joined(&chi));
    if let Some((table, divisions)) = figure.context.measured {
        let means = DESCENT.map(|name| {
            let chi: Vec<f64> = divisions.iter().filter(|d| d.mother == name).map(Measured::chi).collect();
            (!chi.is_empty()).then(|| mean(&chi))
        });
        if means.iter().all(Option::is_some) {
            figure
                .findings
                .push(Finding::judged("descent_measured", (escalates(&means), joined(&means))).noting(table));
        }
    }
    Ok(())
}

/// The fewest divisions of a decade that are compared with others.
const ENOUGH: usize = 5;

/// Whether means of χ fall from each decade of the volume in µm³ with enough divisions to the next larger one, in words, and p that χ is
/// larger in the smaller one. Divisions are volumes and χ.
fn falls(divisions: impl Iterator<Item = (f64, f64)>) -> (bool, String, String) {
    let decades = grouped(divisions.map(|(volume, chi)| (volume.log10().floor() as i32, chi)));
    let decades: BTreeMap<i32, Vec<f64>> = decades.into_iter().collect();
    let enough: Vec<&Vec<f64>> = decades.values().filter(|chi| chi.len() >= ENOUGH).collect();
    let falls = enough.len() > 1 && enough.windows(2).all(|pair| mean(pair[1]) < mean(pair[0]));
    let named = decades.iter().map(|(decade, chi)| {
        let left_out = if chi.len() < ENOUGH { ", left out" } else { "" };
        format!("{:.2} from {} µm³ (n = {}{left_out})", mean(chi), 10_i64.pow(decade.unsigned_abs()), chi.len())
    });
    let tests = enough.windows(2).filter_map(|pair| Some(format!("{:.1e}", rank_sum(pair[0], pair[1])?.p)));
    let tests = tests.collect::<Vec<_>>().join(", ");
    (falls, named.collect::<Vec<_>>().join(", "), format!("one-sided p of neighbouring decades {tests}"))
}

/// Figure 5B: χ over the mother's volume, of the model and as measured.
pub fn volumes(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let tree = grow(figure, &Lineage::c_elegans()?)?;
    let cells = tree.cells().map(|id| tree.cell(id)).filter(|cell| cell.cue.is_none());
    let modelled = cells.filter_map(|cell| Some((ZYGOTE_VOLUME * cell.volume_fraction, cell.fate.chi()?)));
    let (holds, text, tests) = falls(modelled);
    let note = format!("volumes by P0's 20,890 µm³; {tests}");
    figure.findings.push(Finding::judged("volume_trend", (holds, text)).noting(note));
    let (table, divisions) = measured(figure)?;
    let somatic = divisions.iter().filter(|division| !OF_GERMLINE.contains(&division.mother.as_str()));
    let (holds, text, tests) = falls(somatic.map(|division| (division.mother_volume(), division.chi())));
    figure.findings.push(Finding::judged("volume_decades", (holds, text)).noting(format!("{table}; {tests}")));
    Ok(())
}

/// The germline's cells, and χ that follows from their mean volumes as the paper prints them.
pub const GERMLINE: [&str; 4] = ["P0", "P1", "P2", "P3"];
/// Cells that are not somatic.
const OF_GERMLINE: [&str; 7] = ["P0", "P1", "P2", "P3", "P4", "Z2", "Z3"];
const PRINTED: [f64; 3] = [0.184, 0.183, 0.374];

/// Figure 5D: χ of the germline, of the model and as measured.
pub fn germline(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let tree = grow(figure, &Lineage::c_elegans()?)?;
    let chi = chi_of(&tree, GERMLINE);
    let near = |k: usize| chi[k].is_some_and(|chi: f64| (chi / PRINTED[k] - 1.0).abs() < 0.25);
    figure.judge("germline_model", near(0) && near(1), joined(&chi));
    let late = match chi {
        [Some(p0), Some(p1), Some(p2), Some(p3)] => {
            let largest = p0.max(p1).max(p2);
            largest < 0.25 && p3 >= 2.0 * largest
        }
        _ => false,
    };
    figure.judge("germline_late", late, joined(&chi));
    let (table, divisions) = measured(figure)?;
    figure.findings.push(by_ranks(&divisions).noting(table));
    Ok(())
}

/// Measured divisions with the name of their table: the user's, else the shipped one.
fn measured<'a>(figure: &Figure<'a>) -> Result<(String, Cow<'a, [Measured]>), InputError> {
    Ok(match figure.context.measured {
        Some((table, divisions)) => (table.to_owned(), divisions.into()),
        None => (format!("14 embryos of {SOURCE}, other ones than the paper's"), jankele2021_divisions()?.into()),
    })
}

/// Rank-sum tests of neighbouring germline cells.
fn by_ranks(divisions: &[Measured]) -> Finding {
    let of = |name: &str| divisions.iter().filter(|d| d.mother == name).map(Measured::chi).collect::<Vec<f64>>();
    let all = GERMLINE.map(of);
    let tests: Option<Vec<f64>> = all.windows(2).map(|pair| rank_sum(&pair[1], &pair[0]).map(|test| test.p)).collect();
    let Some(p) = tests else { return Finding::not_computed("germline_trend", "not all of P0 to P3 are measured") };
    let means = all.each_ref().map(|chi| Some(mean(chi)));
    let text = format!("{}; p = {:.3}, {:.1e}, {:.3}", joined(&means), p[0], p[1], p[2]);
    Finding::judged("germline_trend", (p[0] > 0.1 && p[1] < 0.001 && p[2] < 0.05, text))
}
