//! When a tree with a clock leaves a measured embryo: by the numbers of cells alive, and by single divisions.

use super::counts::is_of_worm;
use furrow_lineage::clock::last_divisions;
use furrow_lineage::{CellId, CellTimes, Tree};
use furrow_measured::lifetimes::{CellsOverTime, EmbryoOverTime, Lifetimes, Step, cells_over_time};
use furrow_measured::published::jankele2021_lifetimes;
use ordered_float::OrderedFloat;
use serde::Serialize;
use std::collections::{HashMap, HashSet};

/// Cells alive over time, in the minutes of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OverTime {
    /// The embryo's.
    pub measured: EmbryoOverTime,
    /// The model's: descendants of the same cells. `None` without a clock, or if one of these cells or the reference is never
    /// born in it.
    pub model: Option<CellsOverTime>,
    /// The cell that aligns the model's clock with the table's by its birth: the first-born of the cells measured in the most embryos.
    pub reference: Option<String>,
    /// Minutes from the model's zero to the table's.
    pub shift_min: Option<f64>,
    /// The last division in the model of each founder and its descendants, in the minutes of the table; those without one are left
    /// out.
    pub last_divisions: Vec<LastDivision>,
}

/// The last division of a founder and its descendants.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LastDivision {
    /// The founder.
    pub founder: String,
    /// When, in the minutes of the table.
    pub min: f64,
}

/// Numbers of cells at a time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Counts {
    /// Minutes in the table's clock.
    pub min: f64,
    /// The embryo's cells.
    pub cells: usize,
    /// The model's.
    pub model: usize,
}

/// A division that the embryo or the model has alone.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LoneDivision {
    /// The cell that divides.
    pub cell: String,
    /// When, and how many cells there are then, its daughters included.
    #[serde(flatten)]
    pub at: Counts,
}

/// When the model's tree leaves the embryo's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Departure {
    /// Numbers of cells are compared up to this minute: [`EmbryoOverTime::known_until`].
    pub known_until: f64,
    /// The definition of numbers that are apart.
    pub apart: &'static str,
    /// The first minute at which the numbers of cells are apart.
    pub first: Option<Counts>,
    /// The minute from which on they stay apart.
    pub lasting: Option<Counts>,
    /// The first division of the embryo that the model lacks: its cell never divides, or is never born.
    pub lacking: Option<LoneDivision>,
    /// How many it lacks.
    pub lacking_count: usize,
    /// The first division of the model, up to `known_until`, that the table does not have.
    pub extra: Option<LoneDivision>,
    /// How many there are.
    pub extra_count: usize,
    /// Divisions of the embryo that the model has too.
    pub shared: usize,
}

/// What [`is_apart`] asks for.
const APART: &str = "more than one cell and more than 10 % of the embryo's cells";

fn is_apart(Counts { cells, model, .. }: &Counts) -> bool {
    let off = cells.abs_diff(*model);
    off > 1 && 10 * off > *cells
}

/// The embryo's cells over time beside the model's; `None` if the table has no births.
pub(super) fn over_time(
    tree: &Tree,
    modelled: &HashMap<&str, CellId>,
    times: Option<&[CellTimes]>,
    lifetimes: &Lifetimes,
) -> Option<OverTime> {
    let measured = cells_over_time(lifetimes)?;
    let reference = lifetimes.reference();
    let shift_min = reference.zip(times).and_then(|(cell, times)| {
        let id = modelled.get(cell.cell.as_str())?;
        Some(cell.birth? - times[id.index()].birth_min)
    });
    let model = shift_min.zip(times).and_then(|(shift, times)| {
        let names = &measured.over_time.roots;
        let roots = names.iter().map(|root| modelled.get(root.as_str()).copied()).collect::<Option<HashSet<_>>>()?;
        let division = |id: CellId| Some((tree.cell(id).name.clone(), times[id.index()].division_min? + shift));
        Some(CellsOverTime::new(names.clone(), descendants(tree, &roots).filter_map(division)))
    });
    let last = shift_min.zip(times).map(|(shift, times)| {
        let founders = tree.lineage.founders.iter().zip(last_divisions(tree, times));
        founders
            .filter_map(|(founder, min)| Some(LastDivision { founder: founder.name.clone(), min: min? + shift }))
            .collect()
    });
    let reference = reference.map(|cell| cell.cell.clone());
    Some(OverTime { measured, model, reference, shift_min, last_divisions: last.unwrap_or_default() })
}

/// The cells of a tree of *C. elegans* with a clock over time beside published means of embryos; `None` for another animal.
pub fn of_worm(tree: &Tree) -> Option<OverTime> {
    let times = tree.times().filter(|_| is_of_worm(&tree.lineage))?;
    let modelled = tree.cells().map(|id| (tree.cell(id).name.as_str(), id)).collect();
    over_time(tree, &modelled, Some(&times), &jankele2021_lifetimes().ok()?)
}

/// Some cells and all that descend from them.
fn descendants<'t>(tree: &'t Tree, roots: &HashSet<CellId>) -> impl Iterator<Item = CellId> + use<'t> {
    let mut within: Vec<bool> = tree.cells().map(|id| roots.contains(&id)).collect();
    // Mothers come before daughters.
    tree.cells().filter(move |id| {
        within[id.index()] |= tree.mother(*id).is_some_and(|mother| within[mother.index()]);
        within[id.index()]
    })
}

/// When the model leaves the embryo; `None` if their cells over time cannot be compared.
pub(super) fn departure(found: &OverTime) -> Option<Departure> {
    let (EmbryoOverTime { over_time: embryo, known_until }, model) = (&found.measured, found.model.as_ref()?);
    let at = |min: f64| Counts { min, cells: embryo.at(min), model: model.at(min) };
    let steps = embryo.steps.iter().chain(&model.steps).map(|step| step.min).filter(|min| min <= known_until);
    let mut counts: Vec<Counts> = steps.map(at).collect();
    counts.sort_by_cached_key(|item| OrderedFloat(item.min));
    let together = counts.iter().rposition(|counts| !is_apart(counts)).map_or(0, |k| k + 1);
    let names = |of: &CellsOverTime| of.steps.iter().map(|step| step.cell.clone()).collect::<HashSet<String>>();
    let (of_embryo, of_model) = (names(embryo), names(model));
    let lacking: Vec<&Step> = embryo.steps.iter().filter(|step| !of_model.contains(&step.cell)).collect();
    let early = model.steps.iter().filter(|step| step.min <= *known_until);
    let extra: Vec<&Step> = early.filter(|step| !of_embryo.contains(&step.cell)).collect();
    let lone = |step: &&Step| LoneDivision { cell: step.cell.clone(), at: at(step.min) };
    Some(Departure {
        known_until: *known_until,
        apart: APART,
        first: counts.iter().find(|counts| is_apart(counts)).copied(),
        lasting: counts.get(together).copied(),
        lacking: lacking.first().map(lone),
        lacking_count: lacking.len(),
        extra: extra.first().map(lone),
        extra_count: extra.len(),
        shared: embryo.steps.len() - lacking.len(),
    })
}
