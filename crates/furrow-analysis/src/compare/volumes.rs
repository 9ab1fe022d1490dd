//! χ of measured divisions beside the model's (figures 5B, 5D and 6B).
//!
//! The model computes χ of a cell twice: in the tree grown from the zygote, and in a tree with AB and P1 of the sizes measured in a
//! group of embryos. The second can be compared with embryos with a manipulated first division.

use crate::constants::Constants;
use crate::ranges::{Range, each_tree};
use furrow_cell::{Cell, Cue};
use furrow_lineage::batch::scheduler::{SchedulerError, SchedulerOptions};
use furrow_lineage::batch::{Memo, phase, scheduler, solve};
use furrow_lineage::{GrowError, Length, Lineage, Tree, TreeSettings};
use furrow_measured::events::{Division, GroupSummary, MotherSummary, by_group};
use furrow_measured::statistics::{BoxPlot, Line, SPREAD_FROM, box_plot, grouped, line, line_through_origin, mean};
use furrow_measured::trend::{AdjacentTest, VolumeBin, adjacent_tests, volume_bins};
use furrow_mechanics::division::{Division as Computed, DivisionInput, Outcome};
use serde::Serialize;
use std::collections::{BTreeMap, HashMap};
use std::sync::atomic::AtomicBool;

/// The model's division of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ModelDivision {
    /// Its radius R0, in L_h.
    pub r0: f64,
    /// How its division ends; `None` if it is not known.
    pub outcome: Option<Outcome>,
    /// χ, if it divides.
    pub chi: Option<f64>,
}

/// Divisions of a mother in the embryos of a group, beside the model's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MotherComparison {
    /// What was measured.
    #[serde(flatten)]
    pub measured: MotherSummary,
    /// The tree grown from the zygote.
    pub model: Option<ModelDivision>,
    /// The tree with AB and P1 as large as this group measures them; `None` for P0, and where P0 was not measured.
    pub given_first: Option<ModelDivision>,
    /// The tree grown from the zygote, over sets of constants.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub band: Option<Band>,
    /// |χ| of each embryo as a box; `None` for a mother that is known by her mean alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub box_plot: Option<BoxPlot>,
}

impl MotherComparison {
    /// (model − measured)/sd of a χ, of [`SPREAD_FROM`] embryos or more.
    pub fn off(&self, chi: f64) -> Option<f64> {
        self.measured
            .sd
            .filter(|sd| *sd > 0.0 && self.measured.n >= SPREAD_FROM)
            .map(|sd| (chi - self.measured.mean) / sd)
    }
}

/// χ of a cell over sets of constants.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Band {
    /// χ where it divides; `None` where it divides with no set.
    pub chi: Option<Range>,
    /// Share of the weight of the sets with which the cell divides.
    pub divides: f64,
}

/// A group beside the model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GroupComparison {
    /// Its name; empty if the table has no groups.
    pub group: String,
    /// Its embryos with a division.
    pub embryos: usize,
    /// By mother.
    pub events: Vec<MotherComparison>,
    /// |χ| by decades of the mother's volume.
    pub bins: Vec<VolumeBin>,
    /// Each bin beside the next one of larger cells.
    pub tests: Vec<AdjacentTest>,
}

impl GroupComparison {
    /// Leaves out what needs sizes: of a table of χ they are not known.
    pub(crate) fn without_sizes(&mut self) {
        (self.bins, self.tests) = (Vec::new(), Vec::new());
        self.events.iter_mut().for_each(|event| event.measured.mother_volume = None);
    }
}

/// χ of two groups by mother: y of the second over x of the first.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Regression {
    /// The group along x.
    pub x: String,
    /// The group along y.
    pub y: String,
    /// Mothers that both have measured.
    pub mothers: Vec<String>,
    /// Mothers that only the group along x has.
    pub only_x: Vec<String>,
    /// Mothers that only the group along y has.
    pub only_y: Vec<String>,
    /// Through the origin.
    pub through_origin: Option<Line>,
    /// With an intercept.
    pub with_intercept: Option<Line>,
}

/// The model's division of every cell of a tree, by name.
pub fn modelled(tree: &Tree) -> Cells {
    let of = |id| {
        let cell = tree.cell(id);
        let modelled = ModelDivision { r0: cell.r0, outcome: cell.fate.outcome(), chi: cell.fate.chi() };
        (cell.name.clone(), modelled)
    };
    tree.cells().map(of).collect()
}

/// The lineage with AB and P1 as large as a group of embryos measures them, of a zygote of radius `r0`; `None` where P0 was not
/// measured, or the lineage has no such founders.
pub fn with_first_division_of(lineage: &Lineage, group: &GroupSummary, r0: f64) -> Option<Lineage> {
    let p0 = group.events.iter().find(|event| event.mother == "P0")?;
    // Without a sign AB is the larger.
    let chi = p0.mean_signed.unwrap_or(p0.mean);
    let mut lineage = lineage.clone();
    for (name, way) in [("AB", 1.0), ("P1", -1.0)] {
        let founder = lineage.founders.iter_mut().find(|founder| founder.name == name)?;
        founder.r0 = Some(Length::Natural(r0 * (0.5 * (1.0 + way * chi)).cbrt()));
    }
    Some(lineage)
}

/// Most groups that get a tree with their own first division.
const MOST_GROUPS: usize = 50;

/// χ of every cell of a tree by its name.
pub type Cells = BTreeMap<String, ModelDivision>;

/// The model's cells for groups of embryos: of the tree grown from a zygote of radius `r0`, and for each of the first fifty
/// groups that measure P0, of the tree [with its first division](with_first_division_of). `grow` grows the trees of lineages.
///
/// # Errors
/// The error of `grow`.
pub fn model<E>(
    lineage: &Lineage,
    r0: f64,
    groups: &[GroupSummary],
    grow: impl FnOnce(Vec<Lineage>) -> Result<Vec<Tree>, E>,
) -> Result<(Cells, BTreeMap<String, Cells>), E> {
    let with_first = |group: &GroupSummary| Some((group.group.clone(), with_first_division_of(lineage, group, r0)?));
    let given: Vec<(String, Lineage)> = groups.iter().filter_map(with_first).take(MOST_GROUPS).collect();
    let lineages = std::iter::once(lineage.clone()).chain(given.iter().map(|(_, lineage)| lineage.clone())).collect();
    let mut trees = grow(lineages)?.into_iter().map(|tree| modelled(&tree));
    let free = trees.next().unwrap_or_default();
    Ok((free, given.into_iter().map(|(group, _)| group).zip(trees).collect()))
}

/// Measured groups beside the model: `free` is the tree grown from the zygote, `given` those with each group's first division.
/// Of groups that are known by their means alone there are no `divisions`, and no bins.
pub(crate) fn compare_groups(
    groups: Vec<GroupSummary>,
    divisions: &[Division],
    free: &Cells,
    given: &BTreeMap<String, Cells>,
    edges: Option<&[f64]>,
) -> Vec<GroupComparison> {
    let mut own_of: HashMap<&str, Vec<&Division>> = by_group(divisions).into_iter().collect();
    let of = |group: GroupSummary| {
        let first = given.get(&group.group);
        let own: Vec<Division> = own_of.remove(group.group.as_str()).into_iter().flatten().cloned().collect();
        let chi_of: HashMap<&str, Vec<f64>> =
            grouped(own.iter().map(|division| (division.mother.as_str(), division.chi()))).into_iter().collect();
        let event = |measured: MotherSummary| MotherComparison {
            band: None,
            box_plot: chi_of.get(measured.mother.as_str()).and_then(|chi| box_plot(chi)),
            model: free.get(&measured.mother).copied(),
            given_first: first
                .filter(|_| measured.mother != "P0")
                .and_then(|cells| cells.get(&measured.mother))
                .copied(),
            measured,
        };
        let bins = volume_bins(&own, edges);
        GroupComparison {
            group: group.group,
            embryos: group.embryos,
            events: group.events.into_iter().map(event).collect(),
            tests: adjacent_tests(&bins),
            bins,
        }
    };
    groups.into_iter().map(of).collect()
}

/// Mean |χ| of one group over the other's, by the mothers measured in both.
fn regression(x: &GroupComparison, y: &GroupComparison) -> Regression {
    let of = |group: &GroupComparison, mother: &str| {
        group.events.iter().find(|event| event.measured.mother == mother).map(|event| event.measured.mean)
    };
    let names = x.events.iter().map(|event| event.measured.mother.clone());
    let matched: Vec<(String, [f64; 2])> =
        names.filter_map(|name| Some((name.clone(), [of(x, &name)?, of(y, &name)?]))).collect();
    let without = |these: &GroupComparison, others: &GroupComparison| {
        let names = these.events.iter().map(|event| event.measured.mother.clone());
        names.filter(|name| of(others, name).is_none()).collect()
    };
    let points: Vec<[f64; 2]> = matched.iter().map(|(_, point)| *point).collect();
    Regression {
        x: x.group.clone(),
        y: y.group.clone(),
        only_x: without(x, y),
        only_y: without(y, x),
        mothers: matched.into_iter().map(|(name, _)| name).collect(),
        through_origin: line_through_origin(&points),
        with_intercept: line(&points),
    }
}

/// The regression of two groups, given by their names; `None` unless both are there.
pub fn regression_of(groups: &[GroupComparison], x: &str, y: &str) -> Option<Regression> {
    let find = |name: &str| groups.iter().find(|group| group.group == name);
    Some(regression(find(x)?, find(y)?))
}

/// Adds χ over sets of constants to all mothers in `free`, the tree from the zygote; nothing without sets.
///
/// # Errors
/// [`GrowError`] of the first set without a tree.
pub(crate) fn add_bands(
    groups: &mut [GroupComparison],
    free: &Cells,
    lineage: &Lineage,
    settings: &TreeSettings,
    sets: &[Constants],
    threads: usize,
    cancel: &AtomicBool,
) -> Result<(), GrowError> {
    if sets.is_empty() {
        return Ok(());
    }
    let trees = each_tree(lineage, settings, sets, threads, cancel, |set, tree, _| (set.weight, modelled(tree)))?;
    let total: f64 = trees.iter().map(|(weight, _)| weight).sum();
    let band = |mother: &String| {
        let divided = trees.iter().filter_map(|(weight, cells)| Some((cells.get(mother)?.chi?, *weight)));
        let divided: Vec<(f64, f64)> = divided.collect();
        // Adding 0 takes the sign from a zero.
        let divides = divided.iter().map(|(_, weight)| weight).sum::<f64>() / total + 0.0;
        Band { chi: Range::of(divided), divides }
    };
    for event in groups.iter_mut().flat_map(|group| &mut group.events) {
        let mother = &event.measured.mother;
        event.band = free.contains_key(mother).then(|| band(mother));
    }
    Ok(())
}

/// How many of a table's units one L_h is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Scale {
    /// One L_h, in the cube root of the unit of the volumes.
    pub length: f64,
    /// Its source.
    pub from: ScaleFrom,
}

/// The source of a scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ScaleFrom {
    /// It was given.
    Given,
    /// The lineage file's.
    Lineage,
    /// P0, as large as its daughters together, has the radius R0 of the model's.
    P0,
    /// All mothers that the model has: the mean of the logarithms of measured over modelled radii is 0.
    Fitted,
}

/// The scale from P0's divisions, or, if P0 was not measured or `by_p0` is false, from all mothers'; `None` if the model has no
/// measured mother.
pub fn scale(divisions: &[Division], cells: &Cells, by_p0: bool) -> Option<Scale> {
    let radius = |volume: f64| (0.75 / std::f64::consts::PI * volume).cbrt();
    let zygote: Vec<f64> = divisions.iter().filter(|d| d.mother == "P0").map(Division::mother_volume).collect();
    if let (false, true, Some(p0)) = (zygote.is_empty(), by_p0, cells.get("P0")) {
        return Some(Scale { length: radius(mean(&zygote)) / p0.r0, from: ScaleFrom::P0 });
    }
    let ratio = |d: &Division| Some((radius(d.mother_volume()) / cells.get(&d.mother)?.r0).ln());
    let ratios: Vec<f64> = divisions.iter().filter_map(ratio).collect();
    (!ratios.is_empty()).then(|| Scale { length: mean(&ratios).exp(), from: ScaleFrom::Fitted })
}

/// The model's cell without a cue beside the divisions of a bin.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BinModel {
    /// The bin.
    pub bin: String,
    /// Mean volume of its mothers, in the unit of the table.
    pub volume: f64,
    /// A cell of this volume.
    pub model: ModelDivision,
}

/// Cells of the model, one for the mean size of the mothers of each bin: without a cue, which has no name, and then with each of
/// these cues. One L_h is `length` in the cube root of the unit.
///
/// # Errors
/// [`SchedulerError`] if no workers can be started. A division that cannot be computed has no outcome.
pub fn model_by_bin(
    settings: &TreeSettings,
    cues: Option<&BTreeMap<String, Cue>>,
    bins: &[VolumeBin],
    length: f64,
    memo: &Memo,
    options: &SchedulerOptions<'_>,
) -> Result<Vec<(String, Vec<BinModel>)>, SchedulerError> {
    let radius = |bin: &VolumeBin| (0.75 / std::f64::consts::PI * bin.mother_volume).cbrt() / length;
    let cues = cues.into_iter().flatten().map(|(name, cue)| (name.clone(), cue.clone()));
    let found = divide_by_cue(settings, cues, &bins.iter().map(radius).collect::<Vec<_>>(), memo, options)?;
    let row = |(bin, found): (&VolumeBin, Option<Computed>)| {
        let (outcome, chi) = (found.as_ref().map(Computed::outcome), found.as_ref().and_then(Computed::chi));
        BinModel { bin: bin.name(), volume: bin.mother_volume, model: ModelDivision { r0: radius(bin), outcome, chi } }
    };
    Ok(found.into_iter().map(|(cue, found)| (cue, bins.iter().zip(found).map(row).collect())).collect())
}

/// The name of a cue, and divisions with it.
type ByCue = (String, Vec<Option<Computed>>);

/// Divisions of cells of these radii, without a cue and with each of the others; each list with the name of its cue.
fn divide_by_cue(
    settings: &TreeSettings,
    cues: impl Iterator<Item = (String, Cue)>,
    radii: &[f64],
    memo: &Memo,
    options: &SchedulerOptions<'_>,
) -> Result<Vec<ByCue>, SchedulerError> {
    let mut all = vec![(String::new(), Cue::none())];
    all.extend(cues.filter(|(_, cue)| settings.cell.clone().with_cue(cue.clone()).has_cue()));
    let input = |cue: &Cue, r0: &f64| {
        let cell = Cell { r0: *r0, ..settings.cell.clone().with_cue(cue.clone()) };
        DivisionInput { cell, numerics: settings.numerics, seed: settings.seed }
    };
    let inputs = all.iter().flat_map(|(_, cue)| radii.iter().map(move |r0| input(cue, r0)));
    let mut found = scheduler::solve_all(inputs, memo, options, solve)?.divisions.into_iter();
    Ok(all.into_iter().map(|(name, _)| (name, found.by_ref().take(radii.len()).collect())).collect())
}

/// χ over the size of a cell.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SizeCurve {
    /// The cell's cue, as the lineage calls it; empty without one.
    pub cue: String,
    /// R0 in L_h and χ; `None` for a cell that does not divide, or could not be computed.
    pub points: Vec<(f64, Option<f64>)>,
}

/// Points of a curve over size.
const POINTS: usize = 48;

/// χ over size, from one radius to another, of cells without a cue and with each of the lineage's cues: the model's result for
/// every cell, not only for the cells of one tree.
///
/// # Errors
/// [`SchedulerError`] if no workers can be started. A division that cannot be computed leaves a gap.
pub fn size_curves(
    lineage: &Lineage,
    settings: &TreeSettings,
    [from, to]: [f64; 2],
    memo: &Memo,
    options: &SchedulerOptions<'_>,
) -> Result<Vec<SizeCurve>, SchedulerError> {
    let radii: Vec<f64> = phase::spaced(from.ln(), to.ln(), POINTS).into_iter().map(f64::exp).collect();
    let found = divide_by_cue(settings, lineage.cues.clone().into_iter(), &radii, memo, options)?;
    let curve = |(cue, found): ByCue| SizeCurve {
        cue,
        points: radii.iter().copied().zip(found.iter().map(|found| found.as_ref()?.chi())).collect(),
    };
    Ok(found.into_iter().map(curve).collect())
}
