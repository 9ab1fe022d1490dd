//! χ of measured divisions beside the model's (figures 5C, 6D and 6E, 7B).
//!
//! The model says χ of a cell twice. Free, it grows from a zygote and has only the constants to thank for what it says. Given the
//! first division as a group of embryos measures it, AB and P1 are as large as in these, and what the model says of their
//! descendants can be held against embryos whose first division was changed.

use std::collections::{BTreeMap, HashMap};

use measured::events::{Division, GroupSummary, MotherSummary, by_group};
use measured::statistics::{Line, line, line_through_origin};
use measured::trend::{AdjacentTest, VolumeBin, adjacent_tests, volume_bins};
use serde::Serialize;

use crate::division::Outcome;
use crate::lineage::{Length, Lineage, Tree};

/// The model's division of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Modelled {
    /// Its radius R0, in L_h.
    pub r0: f64,
    /// How its division ends; none where that is not known.
    pub outcome: Option<Outcome>,
    /// χ, if it divides.
    pub chi: Option<f64>,
}

/// Divisions of a mother in the embryos of a group, beside the model's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Beside {
    /// What was measured.
    #[serde(flatten)]
    pub measured: MotherSummary,
    /// The tree grown from the zygote.
    pub model: Option<Modelled>,
    /// The tree with AB and P1 as large as this group measures them; none of P0, and where P0 was not measured.
    pub given_first: Option<Modelled>,
}

impl Beside {
    /// (model − measured)/sd of a χ.
    pub fn off(&self, chi: f64) -> Option<f64> {
        self.measured.sd.filter(|sd| *sd > 0.0).map(|sd| (chi - self.measured.mean) / sd)
    }
}

/// A group beside the model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GroupBeside {
    /// Its name; empty if the table has none.
    pub group: String,
    /// Its embryos with a division.
    pub embryos: usize,
    /// By mother.
    pub events: Vec<Beside>,
    /// |χ| by decades of the mother's volume.
    pub bins: Vec<VolumeBin>,
    /// Each bin beside the next one of larger cells.
    pub tests: Vec<AdjacentTest>,
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
    /// Through the origin.
    pub through_origin: Option<Line>,
    /// With an intercept.
    pub with_intercept: Option<Line>,
}

/// What a tree says of every cell by its name.
pub fn modelled(tree: &Tree) -> BTreeMap<String, Modelled> {
    let of = |id| {
        let cell = tree.cell(id);
        let modelled = Modelled { r0: cell.r0, outcome: cell.fate.outcome(), chi: cell.fate.chi() };
        (cell.name.clone(), modelled)
    };
    tree.cells().map(of).collect()
}

/// The lineage with AB and P1 as large as a group of embryos measures them, of a zygote of radius `r0`; none where P0 was not
/// measured, or the lineage has no such founders.
pub fn with_first_division_of(lineage: &Lineage, group: &GroupSummary, r0: f64) -> Option<Lineage> {
    let p0 = group.events.iter().find(|event| event.mother == "P0")?;
    let mut lineage = lineage.clone();
    for (name, way) in [("AB", 1.0), ("P1", -1.0)] {
        let founder = lineage.founders.iter_mut().find(|founder| founder.name == name)?;
        founder.r0 = Some(Length::Natural(r0 * (0.5 * (1.0 + way * p0.mean_signed)).cbrt()));
    }
    Some(lineage)
}

/// Measured groups beside the model: `free` is the tree grown from the zygote, `given` those with each group's first division.
/// Of groups that are known by their means alone there are no `divisions`, and no bins.
pub fn beside(
    groups: Vec<GroupSummary>,
    divisions: &[Division],
    free: &BTreeMap<String, Modelled>,
    given: &BTreeMap<String, BTreeMap<String, Modelled>>,
    edges: Option<&[f64]>,
) -> Vec<GroupBeside> {
    let mut own_of: HashMap<&str, Vec<&Division>> = by_group(divisions).into_iter().collect();
    let of = |group: GroupSummary| {
        let first = given.get(&group.group);
        let event = |measured: MotherSummary| Beside {
            model: free.get(&measured.mother).copied(),
            given_first: first
                .filter(|_| measured.mother != "P0")
                .and_then(|cells| cells.get(&measured.mother))
                .copied(),
            measured,
        };
        let own: Vec<Division> = own_of.remove(group.group.as_str()).into_iter().flatten().cloned().collect();
        let bins = volume_bins(&own, edges);
        GroupBeside {
            group: group.group,
            embryos: group.embryos,
            events: group.events.into_iter().map(event).collect(),
            tests: adjacent_tests(&bins),
            bins,
        }
    };
    groups.into_iter().map(of).collect()
}

/// Mean |χ| of one group over that of another, by the mothers that both have measured.
pub fn regression(x: &GroupBeside, y: &GroupBeside) -> Regression {
    let of = |group: &GroupBeside, mother: &str| {
        group.events.iter().find(|event| event.measured.mother == mother).map(|event| event.measured.mean)
    };
    let names = x.events.iter().map(|event| event.measured.mother.clone());
    let matched: Vec<(String, [f64; 2])> =
        names.filter_map(|name| Some((name.clone(), [of(x, &name)?, of(y, &name)?]))).collect();
    let points: Vec<[f64; 2]> = matched.iter().map(|(_, point)| *point).collect();
    Regression {
        x: x.group.clone(),
        y: y.group.clone(),
        mothers: matched.into_iter().map(|(name, _)| name).collect(),
        through_origin: line_through_origin(&points),
        with_intercept: line(&points),
    }
}

/// Length of one L_h, in µm, by which P0, as large as its daughters, has the radius `r0`; none where it was not measured.
pub fn length_scale(divisions: &[Division], r0: f64) -> Option<f64> {
    let volumes: Vec<f64> = divisions.iter().filter(|d| d.mother == "P0").map(Division::mother_volume).collect();
    let radius = (0.75 / std::f64::consts::PI * measured::statistics::mean(&volumes)).cbrt();
    (!volumes.is_empty()).then(|| radius / r0)
}
