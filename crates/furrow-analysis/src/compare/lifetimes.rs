//! Lifetimes of measured cells beside the lifetimes in a tree with a clock.
//!
//! A clock is fitted to lifetimes, so the model's lifetimes are no predictions. Mechanics predicts the cells, their sizes and,
//! from the sizes, the sister of each pair that divides first.

use crate::compare::departure::{Departure, OverTime, departure, over_time};
use furrow_lineage::{CellId, CellTimes, Tree};
use furrow_measured::lifetimes::{Agreement, Lifetime, Lifetimes, Sisters, Slopes, agreement, sisters, slopes};
use furrow_measured::published::SOURCE;
use furrow_measured::significance::Trend;
use furrow_measured::statistics::{SPREAD_FROM, grouped, mean, sd, smaller};
use furrow_measured::volumes::Volumes;
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::{BTreeMap, HashMap};

/// A measured cell beside the model's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CellComparison {
    /// What was measured.
    #[serde(flatten)]
    pub measured: Lifetime,
    /// Its mean measured volume, in the unit of the table of volumes.
    pub volume: Option<f64>,
    /// The model's lifetime in minutes; `None` without a clock, and for a cell that the model does not divide.
    pub model: Option<f64>,
    /// Whether the model's cell divides; `None` if it is never born.
    pub model_divides: Option<bool>,
    /// The model's volume as a fraction of its first cell's.
    pub model_volume: Option<f64>,
}

impl CellComparison {
    /// (model − measured)/sd, of [`SPREAD_FROM`] embryos or more.
    pub fn off(&self) -> Option<f64> {
        let sd = self.measured.sd.filter(|sd| *sd > 0.0 && self.measured.n >= SPREAD_FROM as u64)?;
        Some((self.model? - self.measured.mean) / sd)
    }
}

/// The measured cells of a founder beside the model's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FounderComparison {
    /// The founder.
    pub founder: String,
    /// Measured cells.
    pub n: usize,
    /// Mean of their mean lifetimes, in minutes.
    pub mean: f64,
    /// Standard deviation between cells.
    pub sd: Option<f64>,
    /// Mean of the model's lifetimes of the same cells, those that divide in it.
    pub model: Option<f64>,
    /// How many of them divide in it.
    pub model_n: usize,
    /// ln lifetime over ln volume, of cells with a measured volume.
    pub slope: Option<Trend>,
    /// The same over all cells of the model that divide.
    pub model_slope: Option<Trend>,
}

/// Two sisters beside the model's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SistersComparison {
    /// What was measured.
    #[serde(flatten)]
    pub measured: Sisters,
    /// Which has the larger measured volume: 0 or 1; `None` where they are equal, or not measured.
    pub larger: Option<usize>,
    /// Which divides first in the model; `None` where they divide at the same time, or one does not.
    pub model_first: Option<usize>,
}

/// The order of divisions of sisters.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Order {
    /// Pairs with measured lifetimes.
    pub pairs: Vec<SistersComparison>,
    /// How often the larger sister, by measured volume, divides first.
    pub larger_first: Agreement,
    /// How often the model's first is the measured one; `None` without a clock.
    pub model: Option<Agreement>,
}

/// How far the model's lifetimes are from the measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Deviation {
    /// Cells with both.
    pub cells: usize,
    /// Root mean square of ln(model/measured).
    pub rms_ln: f64,
    /// Its mean: negative where the model's lifetimes are too short.
    pub mean_ln: f64,
    /// Cells with a shorter lifetime in the model.
    pub too_short: usize,
    /// Cells with a longer one.
    pub too_long: usize,
    /// Of these cells, with a standard deviation over [`SPREAD_FROM`] embryos or more.
    pub with_sd: usize,
    /// Of these, within two of it.
    pub within_two_sd: usize,
}

/// A table of lifetimes beside a tree.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LifetimesComparison {
    /// The tree's lineage.
    pub lineage: String,
    /// Whether it has a clock.
    pub has_clock: bool,
    /// By cell, in the order of the table.
    pub cells: Vec<CellComparison>,
    /// By founder, in the order of the table.
    pub founders: Vec<FounderComparison>,
    /// ln lifetime over ln volume of all cells with a measured volume.
    pub slope: Option<Trend>,
    /// The same over all cells of the model that divide.
    pub model_slope: Option<Trend>,
    /// `None` without a clock.
    pub deviation: Option<Deviation>,
    /// The deviation of cells without a measured volume, to which a clock over volume cannot have been fitted; `None` without such cells.
    pub deviation_without_volume: Option<Deviation>,
    /// Which sister divides first.
    pub order: Order,
    /// Cells alive over time; `None` if the table has no births.
    pub over_time: Option<OverTime>,
    /// When the model's tree leaves the embryo's; `None` without births, without a clock, or without a cell that both have.
    pub departure: Option<Departure>,
}

/// The model's cells by name.
type CellsByName<'t> = HashMap<&'t str, CellId>;

/// A tree beside measured lifetimes and the mean volumes of measured cells.
pub fn compare_lifetimes(tree: &Tree, lifetimes: &Lifetimes, volumes: &BTreeMap<String, f64>) -> LifetimesComparison {
    let times = tree.times();
    let modelled: CellsByName<'_> = tree.cells().map(|id| (tree.cell(id).name.as_str(), id)).collect();
    let cells: Vec<CellComparison> =
        lifetimes.cells.iter().map(|cell| cell_beside(cell, tree, (&modelled, times.as_deref()), volumes)).collect();
    let measured =
        slopes(cells.iter().filter_map(|cell| Some((&*cell.measured.founder, cell.volume?, cell.measured.mean))));
    let model = times.as_deref().map(|times| model_slopes(tree, times));
    let over_time = over_time(tree, &modelled, times.as_deref(), lifetimes);
    LifetimesComparison {
        lineage: tree.lineage.name.clone(),
        has_clock: times.is_some(),
        founders: founders_beside(&cells, &measured, model.as_ref()),
        slope: measured.all,
        model_slope: model.and_then(|model| model.all),
        deviation: deviation(&cells, |_| true),
        deviation_without_volume: deviation(&cells, |cell| cell.volume.is_none()),
        order: order(lifetimes, &cells, times.is_some()),
        cells,
        departure: over_time.as_ref().and_then(departure),
        over_time,
    }
}

/// The comparison as JSON, with what was read; `published` says whether the lifetimes and the volumes are the published ones.
pub fn document(
    found: &LifetimesComparison,
    lifetimes: &Lifetimes,
    volumes: &Volumes,
    [of_lifetimes, of_volumes]: [bool; 2],
) -> Value {
    let mut document = json!(found);
    document["source"] = json!(of_lifetimes.then_some(SOURCE));
    document["volumes_source"] = json!(of_volumes.then_some(SOURCE));
    document["volumes_unit"] = json!(volumes.unit);
    document["used"] = json!(lifetimes.used);
    document["skipped"] = json!(lifetimes.skipped);
    document["skipped_count"] = json!(lifetimes.skipped_count);
    document["embryos"] = json!(lifetimes.embryos);
    document["matched"] = json!(lifetimes.matched);
    document["volumes_skipped"] = json!(volumes.skipped);
    document["volumes_skipped_count"] = json!(volumes.skipped_count);
    document
}

fn cell_beside(
    measured: &Lifetime,
    tree: &Tree,
    (modelled, times): (&CellsByName<'_>, Option<&[CellTimes]>),
    volumes: &BTreeMap<String, f64>,
) -> CellComparison {
    let id = modelled.get(measured.cell.as_str()).copied();
    CellComparison {
        volume: volumes.get(&measured.cell).copied(),
        model: id.zip(times).and_then(|(id, times)| times[id.index()].lifetime_min()),
        model_divides: id.map(|id| tree.daughter_count(id) > 0),
        model_volume: id.map(|id| tree.cell(id).volume_fraction),
        measured: measured.clone(),
    }
}

/// ln lifetime over ln volume of all cells of a tree that divide.
fn model_slopes(tree: &Tree, times: &[CellTimes]) -> Slopes {
    slopes(tree.cells().filter_map(|id| {
        Some((tree.founder_name(id), tree.cell(id).volume_fraction, times[id.index()].lifetime_min()?))
    }))
}

fn founders_beside(cells: &[CellComparison], measured: &Slopes, model: Option<&Slopes>) -> Vec<FounderComparison> {
    let of = |(founder, own): (&str, Vec<&CellComparison>)| {
        let means: Vec<f64> = own.iter().map(|cell| cell.measured.mean).collect();
        let modelled: Vec<f64> = own.iter().filter_map(|cell| cell.model).collect();
        FounderComparison {
            founder: founder.to_owned(),
            n: means.len(),
            mean: mean(&means),
            sd: sd(&means),
            model: (!modelled.is_empty()).then(|| mean(&modelled)),
            model_n: modelled.len(),
            slope: measured.founders.get(founder).copied(),
            model_slope: model.and_then(|model| model.founders.get(founder).copied()),
        }
    };
    let by_founder = grouped(cells.iter().map(|cell| (cell.measured.founder.as_str(), cell)));
    by_founder.into_iter().map(of).collect()
}

fn deviation(cells: &[CellComparison], of: fn(&CellComparison) -> bool) -> Option<Deviation> {
    let chosen = || cells.iter().filter(|cell| of(cell));
    let ratios: Vec<f64> = chosen().filter_map(|cell| Some((cell.model? / cell.measured.mean).ln())).collect();
    let off: Vec<f64> = chosen().filter_map(CellComparison::off).collect();
    let within_two_sd = off.iter().filter(|off| off.abs() <= 2.0).count();
    (!ratios.is_empty()).then(|| Deviation {
        cells: ratios.len(),
        rms_ln: mean(&ratios.iter().map(|ratio| ratio * ratio).collect::<Vec<_>>()).sqrt(),
        mean_ln: mean(&ratios),
        too_short: ratios.iter().filter(|ratio| **ratio < 0.0).count(),
        too_long: ratios.iter().filter(|ratio| **ratio > 0.0).count(),
        with_sd: off.len(),
        within_two_sd,
    })
}

/// Lifetimes of the model that differ by less, relatively, are one: sisters of equal size differ by rounding alone.
const SAME: f64 = 1e-9;

fn order(lifetimes: &Lifetimes, cells: &[CellComparison], has_clock: bool) -> Order {
    let by_name: HashMap<&str, &CellComparison> =
        cells.iter().map(|cell| (cell.measured.cell.as_str(), cell)).collect();
    let both = |pair: &Sisters, of: fn(&CellComparison) -> Option<f64>| {
        let value = |k: usize| by_name.get(pair.daughters[k].as_str()).and_then(|cell| of(cell));
        Some([value(0)?, value(1)?])
    };
    let larger = |pair: &Sisters| both(pair, |cell| cell.volume).and_then(|[a, b]| smaller([-a, -b]));
    let model_first = |pair: &Sisters| {
        let apart = |[a, b]: &[f64; 2]| (a - b).abs() > SAME * a.max(*b);
        // Sisters of equal size with different clocks only repeat the order of the given clocks.
        both(pair, |cell| cell.model_volume).filter(apart)?;
        both(pair, |cell| cell.model).filter(apart).and_then(smaller)
    };
    let measured = sisters(lifetimes);
    let (larger_first, model) = (agreement(&measured, larger), agreement(&measured, model_first));
    let pairs = measured.into_iter().map(|pair| {
        let (larger, model_first) = (larger(&pair), model_first(&pair));
        SistersComparison { measured: pair, larger, model_first }
    });
    Order { pairs: pairs.collect(), larger_first, model: has_clock.then_some(model) }
}
