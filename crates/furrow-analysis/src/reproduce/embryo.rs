//! Figures 5 to 7, the lineage that the model grows; and Table S3, its constants.

use super::context::{Artifact, Figure, Finding, ReproduceError};
use super::readings::chi_in_words;
use crate::compare::counts::counts;
use crate::tree_settings;
use furrow_cell::cue::Quantity;
use furrow_cell::settings::Settings;
use furrow_cell::{Cell, Cue, Parameter};
use furrow_lineage::{EndRule, Grower, Length, Lineage, Thresholds, Tree, TreeCell, founder_rounds};
use furrow_mechanics::division::{Outcome, divide};
use furrow_mechanics::equilibria::CriticalRadii;
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

/// Figure 5A: rounds of the founders, by every definition of rounds.
pub fn rounds(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let tree = grow(figure, &Lineage::c_elegans()?)?;
    let sentence = counts(&tree)?.sentence;
    let named = |holds: bool| {
        let names = sentence.iter().filter(|of| of.holds == holds).map(|of| match of.reading {
            "min" => "fewest",
            "max" => "most",
            "full_doublings" => "full doublings",
            other => other,
        });
        let names = names.collect::<Vec<_>>().join(", ");
        if names.is_empty() { "none".to_owned() } else { names }
    };
    figure.report("rounds", format!("true of rounds read as: {}; not as: {}", named(true), named(false)));
    figure.show("5A", Artifact::Tree(Box::new(tree)));
    Ok(())
}

/// Figures 5B and 5C: AB, and the germline.
pub fn germline(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let tree = grow(figure, &Lineage::c_elegans()?)?;
    let ab = founder_rounds(&tree).into_iter().find(|row| tree.lineage.founders[row.founder].name == "AB");
    let symmetric = ab.and_then(|row| row.rounds).map(|rounds| f64::from(rounds.symmetric));
    figure.number("ab_rounds", symmetric.ok_or("AB is not born"));
    let chi = chi_of(&tree, ["P0", "P1", "P2", "P3"]);
    let outcome = cell_named(&tree, "P4").and_then(|cell| cell.fate.outcome());
    let p4_divides = outcome.is_some_and(|outcome| outcome != Outcome::Arrested);
    match chi {
        [Some(p0), Some(p1), Some(p2), Some(p3)] => {
            let largest = p0.max(p1).max(p2);
            let p4 = if p4_divides { "divides" } else { "does not divide" };
            let text = format!("{p0:.3}, {p1:.3}, {p2:.3}, {p3:.3}; P4 {p4}");
            figure.judge("germline", largest < 0.25 && p3 >= 2.0 * largest && !p4_divides, text);
        }
        _ => figure.judge("germline", false, "not all of P0 to P3 divide".to_owned()),
    }
    figure.number("zygote", chi[0].ok_or("P0 does not divide"));
    Ok(())
}

/// Figures 6D and 6E: χ over size and over confinement.
pub fn trends(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let tree = grow(figure, &Lineage::c_elegans()?)?;
    let mut decades: BTreeMap<i32, Vec<f64>> = BTreeMap::new();
    for cell in tree.cells().map(|id| tree.cell(id)).filter(|cell| cell.cue.is_none()) {
        if let Some(chi) = cell.fate.chi() {
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
    let note = "volumes by P0's 20,890 µm³; at this place the paper tests measured cells, which are not public";
    figure.findings.push(Finding::judged("volume_trend", (falls, named.join(", "))).noting(note));
    let compression = compression(figure, &tree)?;
    figure.findings.push(compression);
    Ok(())
}

/// χ of the germline's cells, as large as in the tree, in looser shells and in that of the tree.
fn compression(figure: &mut Figure<'_>, tree: &Tree) -> Result<Finding, ReproduceError> {
    let (mut rises, mut words) = (true, Vec::new());
    for name in ["P0", "P1", "P2", "P3"] {
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

/// Figure 7: the germline if the first division is equal.
pub fn equalised(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let mut lineage = Lineage::c_elegans()?;
    let r0 = lineage.given_r0(lineage.first()).unwrap_or(figure.context.settings.cell.r0);
    let free = chi_of(&grow(figure, &lineage)?, ["P1", "P2", "P3"]);
    for founder in lineage.founders.iter_mut().filter(|founder| matches!(founder.name.as_str(), "AB" | "P1")) {
        founder.r0 = Some(Length::Natural(r0 * 0.5_f64.cbrt()));
    }
    let equal = chi_of(&grow(figure, &lineage)?, ["P1", "P2", "P3"]);
    let note = "measured of embryos that were equalised and hatched, by Jankele et al. 2021: 0.153, 0.220, 0.214";
    let text = format!("{} (free: {})", joined(&equal), joined(&free));
    figure.findings.push(Finding::new("equalised", text).noting(note));
    Ok(())
}

/// Table S3: the constants in force beside those printed, and the shell, which the table does not print.
pub fn constants(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let cell = &figure.context.settings.cell;
    let cue = Lineage::c_elegans()?.cue("germline");
    let term = cue.as_ref().and_then(|cue| cue.terms().first());
    for statement in figure.statements {
        let value = match statement.constant.as_deref() {
            None => continue,
            Some("xi_b") => Some(cell.xi_s * cell.material.xi_ratio),
            Some("cue.amplitude") => term.map(|term| term.amplitude),
            Some("cue.omega") => term.and_then(|term| term.profile.quantity(Quantity::Omega)),
            Some("cue.u0") => term.and_then(|term| term.profile.quantity(Quantity::U0)),
            Some(name) => name.parse::<Parameter>().ok().map(|parameter| parameter.get(cell)),
        };
        figure.number(&statement.id, value.ok_or("there is no such constant"));
    }
    let (shell, gain) = (cell.shell, cell.material.gain);
    let text = format!("a/b = {}, p0 = {}, w = {}; g = {gain}", shell.aspect, shell.p0, shell.w);
    figure.report("table_shell", text);
    Ok(())
}
