//! Figures 4 to 6: the lineage that the model grows, beside the embryo.

use super::context::{Artifact, Figure, Finding, ReproduceError};
use super::readings::chi_in_words;
use crate::compare::counts::counts;
use crate::tree_settings;
use furrow_cell::settings::Settings;
use furrow_cell::{Cell, Cue};
use furrow_input::InputError;
use furrow_lineage::{EndRule, Grower, Lineage, Thresholds, Tree, TreeCell, founder_rounds};
use furrow_measured::events::{Division as Measured, MotherSummary, summaries};
use furrow_measured::published::{SOURCE, jankele2021_divisions};
use furrow_measured::statistics::{line_through_origin, mean, rank_sum};
use furrow_mechanics::critical::CriticalRadii;
use furrow_mechanics::division::{Outcome, divide};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Volume of P0, in µm³, as a caption of the paper gives it.
const ZYGOTE_VOLUME: f64 = 20_890.0;

/// Grows a lineage with the constants of the settings.
fn grow(figure: &Figure<'_>, lineage: &Lineage) -> Result<Tree, ReproduceError> {
    let context = figure.context;
    let numerics = context.converged();
    let settings = Settings { numerics, ..context.settings.clone() };
    let settings = tree_settings(settings, lineage, 0, context.memo.quantisation());
    let rule = Thresholds::new(CriticalRadii::new(&numerics).interrupted_by(context.cancel));
    let ends = EndRule::Thresholds(&rule);
    let grower = Grower { lineage, settings, ends, memo: context.memo, options: context.options() };
    let (tree, _) = grower.grow(divide)?;
    context.check_cancelled()?;
    Ok(tree)
}

fn cell_named<'t>(tree: &'t Tree, name: &str) -> Option<&'t TreeCell> {
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
    let ab = founder_rounds(&tree).into_iter().find(|row| tree.lineage.founders[row.founder].name == "AB");
    let symmetric = ab.and_then(|row| row.rounds).map(|rounds| f64::from(rounds.symmetric));
    figure.number("ab_rounds", symmetric.ok_or("AB is not born"));
    let chi = chi_of(&tree, GERMLINE);
    let outcome = cell_named(&tree, "P4").and_then(|cell| cell.fate.outcome());
    let p4 = if outcome.is_some_and(|outcome| outcome != Outcome::Arrested) { "divides" } else { "does not divide" };
    let holds = match chi {
        [Some(p0), Some(p1), Some(p2), Some(p3)] => {
            let largest = p0.max(p1).max(p2);
            largest < 0.25 && p3 >= 2.0 * largest
        }
        _ => false,
    };
    figure.judge("germline", holds, format!("{}; P4 {p4}", joined(&chi)));
    Ok(())
}

/// Values by decades of volume in µm³.
type Decades = BTreeMap<i32, Vec<f64>>;

/// Whether means fall from each decade to the next larger one, and in words.
fn falls(decades: &Decades) -> (bool, String) {
    let means: Vec<f64> = decades.values().map(|chi| mean(chi)).collect();
    let falls = means.len() > 1 && means.windows(2).all(|pair| pair[1] < pair[0]);
    let named = decades.iter().zip(&means).map(|((decade, chi), mean)| {
        format!("{mean:.2} from {} µm³ (n = {})", 10_i64.pow(decade.unsigned_abs()), chi.len())
    });
    (falls, named.collect::<Vec<_>>().join(", "))
}

/// Figure 5B: χ over the mother's volume, of the model and as measured.
pub fn volumes(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let tree = grow(figure, &Lineage::c_elegans()?)?;
    let mut decades = Decades::new();
    for cell in tree.cells().map(|id| tree.cell(id)).filter(|cell| cell.cue.is_none()) {
        if let Some(chi) = cell.fate.chi() {
            let decade = (ZYGOTE_VOLUME * cell.volume_fraction).log10().floor() as i32;
            decades.entry(decade).or_default().push(chi);
        }
    }
    figure.findings.push(Finding::judged("volume_trend", falls(&decades)).noting("volumes by P0's 20,890 µm³"));
    let (table, divisions) = measured(figure)?;
    let mut decades = Decades::new();
    for division in divisions.iter() {
        decades.entry(division.mother_volume().log10().floor() as i32).or_default().push(division.chi());
    }
    let (holds, text) = falls(&decades);
    let all: Vec<&Vec<f64>> = decades.values().collect();
    let tests = all.windows(2).filter_map(|pair| Some(format!("{:.3}", rank_sum(pair[0], pair[1])?.p)));
    let note = format!("{table}; p of neighbouring decades {}", tests.collect::<Vec<_>>().join(", "));
    figure.findings.push(Finding::judged("volume_decades", (holds, text)).noting(note));
    Ok(())
}

/// The germline's cells, and χ that follows from their mean volumes as the paper prints them.
const GERMLINE: [&str; 4] = ["P0", "P1", "P2", "P3"];
const PRINTED: [f64; 3] = [0.184, 0.183, 0.374];

/// Figure 5D: χ of the germline, of the model and as measured.
pub fn germline(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let tree = grow(figure, &Lineage::c_elegans()?)?;
    let chi = chi_of(&tree, GERMLINE);
    let near = |k: usize| chi[k].is_some_and(|chi: f64| (chi / PRINTED[k] - 1.0).abs() < 0.25);
    figure.judge("germline_model", near(0) && near(1), joined(&chi));
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

/// Groups of a table whose embryos are compressed, or not.
const COMPRESSED: [&str; 2] = ["uncompressed", "compressed"];

/// The slope of χ in compressed embryos over that in others, by mother; none if there are no such groups.
fn slope(divisions: &[Measured]) -> Option<Finding> {
    let groups = summaries(divisions);
    let [x, y] = COMPRESSED.map(|name| groups.iter().find(|group| group.group == name));
    let (x, y) = (x?, y?);
    let both = |event: &MotherSummary| {
        let other = y.events.iter().find(|other| other.mother == event.mother)?;
        Some([event.mean, other.mean])
    };
    let points: Vec<[f64; 2]> = x.events.iter().filter_map(both).collect();
    let line = line_through_origin(&points)?;
    let note = format!("R² = {:.3} of {} mothers", line.r_squared, points.len());
    Some(Finding::new("compression_slope", line.slope).noting(note))
}

/// Figure 6B: χ of the germline in looser shells.
pub fn compression(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let tree = grow(figure, &Lineage::c_elegans()?)?;
    let finding = compressed(figure, &tree)?;
    figure.findings.push(finding);
    figure.findings.extend(figure.context.measured.and_then(|(_, divisions)| slope(divisions)));
    Ok(())
}

/// χ of the germline's cells, as large as in the tree, in looser shells and in that of the tree.
fn compressed(figure: &mut Figure<'_>, tree: &Tree) -> Result<Finding, ReproduceError> {
    let (mut rises, mut words) = (true, Vec::new());
    for name in GERMLINE {
        let Some(cell) = cell_named(tree, name) else {
            return Ok(Finding::not_computed("compression", format!("{name} is not born")));
        };
        let context = figure.context;
        let input = |epsilon: f64| {
            let cell = Cell { r0: cell.r0, epsilon, ..context.settings.cell.clone() };
            context.input(cell.with_cue(Cue::published()))
        };
        let divisions = figure.divisions([0.83, 0.85, 0.87].map(input).to_vec())?;
        let chi: Option<Vec<f64>> = divisions.iter().map(|division| division.as_ref()?.chi()).collect();
        rises &= chi.as_ref().is_some_and(|chi| chi.windows(2).all(|pair| pair[1] > pair[0]));
        let each = chi.map_or("-".to_owned(), |chi| joined(&chi.into_iter().map(Some).collect::<Vec<_>>()));
        words.push(format!("{name} {each}"));
    }
    Ok(Finding::judged("compression", (rises, words.join("; "))))
}
