//! Figures 5 to 7: the lineage that the model grows.

use std::collections::BTreeMap;

use super::lab::{Finding, Found, Lab, LabError, Shown};
use super::paper::Statement;
use crate::cell::{Cell, Cue};
use crate::division::{DivisionInput, Outcome, divide};
use crate::lineage::{Grower, Length, Lineage, Thresholds, Tree, TreeSettings, founder_rounds};
use crate::shapes::CriticalRadii;
use crate::study::compare::counts::counts;

/// Volume of P0, in µm³, as a caption of the paper gives it.
const ZYGOTE_VOLUME: f64 = 20_890.0;

/// The lineage with the lab's constants.
fn grow(lab: &Lab<'_>, lineage: &Lineage) -> Result<Tree, LabError> {
    let numerics = lab.numerics();
    let r0 = lineage.given_r0(lineage.first()).unwrap_or(lab.settings.cell.r0);
    let settings = TreeSettings {
        cell: Cell { r0, ..lab.settings.cell.clone() },
        numerics,
        seed: 0,
        r0_step: lab.memo.quantisation().relative_step(),
    };
    let rule = Thresholds::new(CriticalRadii::new(&numerics).interrupted_by(lab.interrupt));
    let ends = |cell: &Cell| rule.of(cell);
    let grower = Grower { lineage, settings, ends: &ends, memo: lab.memo, options: lab.options() };
    let (tree, _) = grower.grow(divide)?;
    lab.go_on()?;
    Ok(tree)
}

/// Figure 5A: rounds of the founders, by every reading.
pub fn rounds(lab: &Lab<'_>, _: &[Statement]) -> Result<Found, LabError> {
    let mut found = Found::default();
    let tree = grow(lab, &Lineage::c_elegans()?)?;
    let sentence = counts(&tree)?.sentence;
    let named = |holds: bool| -> Vec<&str> {
        let reading = |reading| match reading {
            "min" => "fewest",
            "max" => "most",
            "full_doublings" => "full doublings",
            other => other,
        };
        sentence.iter().filter(|of| of.holds == holds).map(|of| reading(of.reading)).collect()
    };
    let words = |names: Vec<&str>| if names.is_empty() { "none".to_owned() } else { names.join(", ") };
    let text = format!("true of rounds read as: {}; not as: {}", words(named(true)), words(named(false)));
    found.say(Finding::open("rounds", text));
    found.show("5A", Shown::Tree(Box::new(tree)));
    Ok(found)
}

/// Figures 5B and 5C: AB, and the germline.
pub fn germline(lab: &Lab<'_>, _: &[Statement]) -> Result<Found, LabError> {
    let mut found = Found::default();
    let tree = grow(lab, &Lineage::c_elegans()?)?;
    let symmetric = founder_rounds(&tree)
        .into_iter()
        .find(|row| tree.lineage.founders.get(row.founder).is_some_and(|founder| founder.name == "AB"))
        .and_then(|row| row.rounds)
        .map(|rounds| rounds.symmetric);
    found.say(match symmetric {
        Some(rounds) => Finding::number("ab_rounds", f64::from(rounds)),
        None => Finding::not_computed("ab_rounds", "AB is not born"),
    });
    let chi = chi_of(&tree, &["P0", "P1", "P2", "P3"]);
    let p4 = outcome_of(&tree, "P4");
    found.say(match chi[..] {
        [Some(p0), Some(p1), Some(p2), Some(p3)] => {
            let largest = p0.max(p1).max(p2);
            let holds = largest < 0.25 && p3 >= 2.0 * largest && p4.is_none();
            let p4 = if p4.is_none() { "does not divide" } else { "divides" };
            Finding::words("germline", holds, format!("{p0:.3}, {p1:.3}, {p2:.3}, {p3:.3}; P4 {p4}"))
        }
        _ => Finding::words("germline", false, "not all of P0 to P3 divide".to_owned()),
    });
    found.say(match chi.first() {
        Some(Some(p0)) => Finding::number("zygote", *p0),
        _ => Finding::not_computed("zygote", "P0 does not divide"),
    });
    Ok(found)
}

/// χ of cells by name; none of one that does not divide.
fn chi_of(tree: &Tree, names: &[&str]) -> Vec<Option<f64>> {
    let cells: BTreeMap<&str, Option<f64>> =
        tree.cells().map(|id| (tree.cell(id).name.as_str(), tree.cell(id).fate.chi())).collect();
    names.iter().map(|name| cells.get(name).copied().flatten()).collect()
}

/// How a cell divides, if it does.
fn outcome_of(tree: &Tree, name: &str) -> Option<Outcome> {
    let id = tree.cells().find(|id| tree.cell(*id).name == name)?;
    tree.cell(id).fate.outcome().filter(|outcome| *outcome != Outcome::Failed)
}

/// Figures 6D and 6E: what the model says of size and of confinement.
pub fn trends(lab: &Lab<'_>, _: &[Statement]) -> Result<Found, LabError> {
    let mut found = Found::default();
    let tree = grow(lab, &Lineage::c_elegans()?)?;
    let mut decades: BTreeMap<i32, Vec<f64>> = BTreeMap::new();
    for id in tree.cells() {
        let cell = tree.cell(id);
        if let (Some(chi), true) = (cell.fate.chi(), cell.cue.is_none()) {
            let decade = (ZYGOTE_VOLUME * cell.volume_fraction).log10().floor() as i32;
            decades.entry(decade).or_default().push(chi);
        }
    }
    let means: Vec<f64> = decades.values().map(|chi| chi.iter().sum::<f64>() / chi.len() as f64).collect();
    let falls = means.len() > 1 && means.windows(2).all(|pair| pair[1] < pair[0]);
    let named = decades.iter().zip(&means).map(|((decade, chi), mean)| {
        format!("{mean:.2} from {} µm³ (n = {})", 10_i64.pow(decade.unsigned_abs()), chi.len())
    });
    let named: Vec<String> = named.collect();
    found.say(
        Finding::words("volume_trend", falls, named.join(", "))
            .noting("volumes by P0's 20,890 µm³; at this place the paper tests measured cells, which are not public"),
    );
    let compression = compression(lab, &tree, &mut found)?;
    found.say(compression);
    Ok(found)
}

/// χ of the germline's cells, as large as in the tree, in looser shells and in that of the tree.
fn compression(lab: &Lab<'_>, tree: &Tree, found: &mut Found) -> Result<Finding, LabError> {
    let (mut rises, mut words) = (true, Vec::new());
    for name in ["P0", "P1", "P2", "P3"] {
        let Some(cell) = tree.cells().map(|id| tree.cell(id)).find(|cell| cell.name == name) else {
            return Ok(Finding::not_computed("compression", format!("{name} is not born")));
        };
        let input = |epsilon: f64| {
            let cell = Cell { r0: cell.r0, epsilon, ..lab.settings.cell.clone() }.with_cue(Cue::published());
            DivisionInput { numerics: lab.numerics(), ..DivisionInput::new(cell) }
        };
        let divisions = lab.divisions([0.83, 0.85, 0.87].map(input).to_vec(), found)?;
        let chi: Option<Vec<f64>> = divisions.iter().map(|division| division.as_ref()?.chi).collect();
        rises &= chi.as_ref().is_some_and(|chi| chi.windows(2).all(|pair| pair[1] > pair[0]));
        let each = chi.map_or("-".to_owned(), |chi| {
            let each: Vec<String> = chi.iter().map(|chi| format!("{chi:.3}")).collect();
            each.join(", ")
        });
        words.push(format!("{name} {each}"));
    }
    Ok(Finding::words("compression", rises, words.join("; ")))
}

/// Figure 7: the model's germline if the first division is equal.
pub fn equalised(lab: &Lab<'_>, _: &[Statement]) -> Result<Found, LabError> {
    let mut found = Found::default();
    let mut lineage = Lineage::c_elegans()?;
    let r0 = lineage.given_r0(lineage.first()).unwrap_or(lab.settings.cell.r0);
    let free = chi_of(&grow(lab, &lineage)?, &["P1", "P2", "P3"]);
    for founder in lineage.founders.iter_mut().filter(|founder| matches!(founder.name.as_str(), "AB" | "P1")) {
        founder.r0 = Some(Length::Natural(r0 * 0.5_f64.cbrt()));
    }
    let equal = chi_of(&grow(lab, &lineage)?, &["P1", "P2", "P3"]);
    let words = |chi: &[Option<f64>]| {
        let each: Vec<String> = chi.iter().map(|chi| chi.map_or("-".to_owned(), |chi| format!("{chi:.3}"))).collect();
        each.join(", ")
    };
    found
        .say(Finding::open("equalised", format!("{} (free: {})", words(&equal), words(&free))).noting(
            "measured of embryos that were equalised and hatched, by Jankele et al. 2021: 0.153, 0.220, 0.214",
        ));
    Ok(found)
}
