//! The clock of a lineage, fitted to measured lifetimes and volumes.
//!
//! Of each founder with three cells or more, ln lifetime over ln volume is a straight line by least squares; its slope, with the
//! sign changed, is the exponent. `lifetime_min` is the line's value at `at_volume`, the geometric mean of the founder's volumes,
//! where the errors of both are independent. A founder with fewer cells gets the exponent of the line through all cells.
//!
//! # Equations
//! * \[F.6 clock\] t = t₀ (V/V₀)^−α, of each founder, by least squares of ln t over ln V.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::compare::names_of;
use furrow_input::InputError;
use furrow_lineage::Lineage;
use furrow_measured::lifetimes::{Lifetimes, mean_volumes};
use furrow_measured::names::Names;
use furrow_measured::significance::power;
use furrow_measured::statistics::mean;
use furrow_measured::volumes::{Unit, Volumes};
use serde::Serialize;

/// The line through some cells.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FittedLaw {
    /// The founder, or `all`.
    pub founder: String,
    /// Exponent of the lifetime over the volume, with the sign changed.
    pub exponent: f64,
    /// Its standard error; not given for two sizes, because a line through two points always fits.
    pub se: Option<f64>,
    /// Cells.
    pub n: usize,
    /// Lifetime at `at_volume`, in minutes.
    pub lifetime_min: f64,
    /// The geometric mean of the cells' volumes, as a fraction of the first cell's.
    pub at_volume: f64,
    /// The smallest and the largest of them.
    pub volumes: [f64; 2],
    /// Share of the variation of ln lifetime that the line explains; as `se`.
    pub r_squared: Option<f64>,
    /// Two-sided p value of the exponent; as `se`.
    pub p: Option<f64>,
}

/// A cell that the fit uses.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FittedCell {
    /// The cell.
    pub cell: String,
    /// Its founder.
    pub founder: String,
    /// Its volume, as a fraction of the first cell's.
    pub at_volume: f64,
    /// Its lifetime, in minutes.
    pub lifetime_min: f64,
}

/// A founder with too few cells for a line of its own.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FewCells {
    /// The founder.
    pub founder: String,
    /// Cells.
    pub n: usize,
    /// The geometric mean of their lifetimes, in minutes.
    pub lifetime_min: f64,
    /// The geometric mean of their volumes, as a fraction of the first cell's volume.
    pub at_volume: f64,
}

/// A cell that the fit does not use.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Unused {
    /// The cell.
    pub cell: String,
    /// Why.
    pub why: &'static str,
}

/// A fitted clock.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FittedClock {
    /// The line through all cells.
    pub all: FittedLaw,
    /// The founders' lines, in the order of the lineage.
    pub exponents: Vec<FittedLaw>,
    /// Founders with one cell or two.
    pub few: Vec<FewCells>,
    /// Mean volume of the first cell, in the unit of the table.
    pub first_volume: f64,
    /// The first cell, if its lifetime is not measured: its division is minute 0 then.
    pub origin: Option<String>,
    /// The cells of the fit.
    pub cells: Vec<FittedCell>,
    /// Cells with a lifetime that the fit does not use.
    pub skipped: Vec<Unused>,
}

/// Fits the clock of a lineage to lifetimes and volumes.
///
/// # Errors
/// The first cell has no volume, or fewer than three cells have a lifetime and a volume; both name the tables as `files`.
pub fn fit_clock(
    lineage: &Lineage,
    lifetimes: &Lifetimes,
    volumes: &Volumes,
    files: &str,
) -> Result<FittedClock, InputError> {
    let (first, means) = (lineage.first(), mean_volumes(volumes));
    let first_volume = first_volume(lineage, &means, volumes.unit, files)?;
    let (names, mut cells, mut skipped) = (names_of(lineage), Vec::new(), Vec::new());
    for cell in &lifetimes.cells {
        let placed = founder_of(lineage, &names, &cell.cell).ok_or("no founder of the lineage is above it");
        match placed.and_then(|founder| Ok((founder, means.get(&cell.cell).ok_or("no volume")?))) {
            Ok((founder, volume)) => {
                let (at_volume, lifetime_min) = (volume / first_volume, cell.mean);
                let founder = lineage.founders[founder].name.clone();
                cells.push(FittedCell { cell: cell.cell.clone(), founder, at_volume, lifetime_min });
            }
            Err(why) => skipped.push(Unused { cell: cell.cell.clone(), why }),
        }
    }
    let of = |name: &str| -> Vec<[f64; 2]> {
        let own = cells.iter().filter(|cell: &&FittedCell| cell.founder == name);
        own.map(|cell| [cell.at_volume.ln(), cell.lifetime_min.ln()]).collect()
    };
    let points: Vec<Vec<[f64; 2]>> = lineage.founders.iter().map(|founder| of(&founder.name)).collect();
    let all = law("all", &points.concat()).ok_or_else(|| {
        let allowed = "three cells or more with a lifetime and a volume, and volumes that differ";
        InputError::not_allowed(files, "cells", cells.len(), allowed)
    })?;
    let named = || lineage.founders.iter().map(|founder| founder.name.as_str()).zip(&points);
    let few = |(name, points): (&str, &Vec<[f64; 2]>)| {
        let (founder, n, [at_volume, lifetime_min]) = (name.to_owned(), points.len(), centre(points));
        (n > 0 && law(name, points).is_none()).then_some(FewCells { founder, n, lifetime_min, at_volume })
    };
    Ok(FittedClock {
        exponents: named().filter_map(|(name, points)| law(name, points)).collect(),
        few: named().filter_map(few).collect(),
        all,
        first_volume,
        origin: points[first].is_empty().then(|| lineage.founders[first].name.clone()),
        cells,
        skipped,
    })
}

/// The geometric means of the volumes and the lifetimes of some points.
fn centre(points: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|k| mean(&points.iter().map(|point| point[k]).collect::<Vec<_>>()).exp())
}

fn law(founder: &str, points: &[[f64; 2]]) -> Option<FittedLaw> {
    let found = power(points)?;
    let [at_volume, lifetime_min] = centre(points);
    Some(FittedLaw {
        founder: founder.to_owned(),
        // A slope of 0 has no sign.
        exponent: 0.0 - found.line.slope,
        se: Some(found.line.slope_error).filter(|error| !error.is_nan()),
        n: found.line.n,
        lifetime_min,
        at_volume,
        volumes: [f64::min, f64::max].map(|pick| points.iter().map(|point| point[0]).fold(points[0][0], pick).exp()),
        r_squared: found.line.r_squared,
        p: found.p,
    })
}

/// The founder of the lineage that a cell is or descends from, the nearest one.
fn founder_of(lineage: &Lineage, names: &Names, cell: &str) -> Option<usize> {
    let mut line = std::iter::successors(Some(cell), |cell| names.birth(cell).map(|(mother, ..)| mother));
    line.find_map(|cell| lineage.founder_named(cell))
}

/// The volume of the first cell: measured, or 1 where volumes are fractions, or the sum of her daughters'.
fn first_volume(
    lineage: &Lineage,
    means: &BTreeMap<String, f64>,
    unit: Option<Unit>,
    files: &str,
) -> Result<f64, InputError> {
    let first = &lineage.founders[lineage.first()].name;
    let daughters = || names_of(lineage).daughters(first).map(|daughters| daughters.map(|name| means.get(&name)));
    match (means.get(first), unit, daughters()) {
        (Some(volume), ..) => Ok(*volume),
        (None, Some(Unit::Relative), _) => Ok(1.0),
        (None, _, Some([Some(one), Some(other)])) => Ok(one + other),
        (None, ..) => {
            let allowed =
                format!("given for the first cell, {first}, or both its daughters: lifetimes are relative to it");
            Err(InputError::not_allowed(files, "volumes", "(not given)", allowed))
        }
    }
}

impl FittedClock {
    /// The clock as a lineage file: one that differs from the built-in lineage, or without `base` one with the fields to copy.
    pub fn as_ron(&self, base: Option<&str>) -> String {
        let law = |lifetime: f64, volume: f64, exponent: f64, [least, most]: [f64; 2]| {
            format!(
                "lifetime_min: {lifetime:.2}, at_volume: {volume:.5}, exponent: {exponent:.4}, volumes: ({least:.5}, {most:.5})"
            )
        };
        let mut out = "// Found by furrow fit clock.\nLineage(\n".to_owned();
        if let Some(base) = base {
            let _ = writeln!(out, "    base: {base:?},");
        }
        let FittedLaw { lifetime_min, at_volume, exponent, volumes, .. } = self.all;
        let origin = self.origin.as_ref().map(|first| format!(", origin: division({first:?})"));
        let (law_of_all, origin) = (law(lifetime_min, at_volume, exponent, volumes), origin.unwrap_or_default());
        let _ = writeln!(out, "    clock: ({law_of_all}{origin}),\n    founders: [");
        let own = self
            .exponents
            .iter()
            .map(|own| (&own.founder, law(own.lifetime_min, own.at_volume, own.exponent, own.volumes)));
        let few = self.few.iter().map(|few| (&few.founder, law(few.lifetime_min, few.at_volume, exponent, volumes)));
        for (name, clock) in own.chain(few) {
            let _ = writeln!(out, "        (name: {name:?}, clock: ({clock})),");
        }
        out + "    ],\n)\n"
    }
}
