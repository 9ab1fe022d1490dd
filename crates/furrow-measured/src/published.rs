//! Published size asymmetries as means over embryos, the default of a comparison.
//!
//! # References
//! Jankele, Jelier & Gönczy, *eLife* 10, e61714 (2021): segmented volumes of 6 wild-type embryos (`wt`), 8 of the same strain as
//! the changed ones (`ctrl`), and embryos whose first division was made equal by moving the spindle, 11 that hatched (`alive`) and
//! 12 that did not (`dead`). Of the last two signed means alone are known, which are means of |χ| where all signs are alike.

use furrow_input::InputError;
use serde::Deserialize;

use crate::events::{Division, GroupSummary, MotherSummary, divisions, place};
use crate::lifetimes::Lifetimes;
use crate::table::malformed;
use crate::volumes::{ReadOptions, Volumes};

/// The table, as shipped.
const JANKELE: &str = include_str!("../data/jankele2021.csv");

/// Volumes of cells of single embryos, of the groups `wt` and `ctrl`.
const VOLUMES: &str = include_str!("../data/jankele2021_volumes.csv");

/// Lifetimes of the cells of 28 embryos of both groups: means of those measured in at least five.
const LIFETIMES: &str = include_str!("../data/jankele2021_lifetimes.csv");

/// What it is called.
pub const SOURCE: &str = "Jankele, Jelier & Gönczy 2021, eLife 10:e61714";

#[derive(Deserialize)]
struct Row {
    group: String,
    mother: String,
    n: usize,
    mean: Option<f64>,
    sd: Option<f64>,
    mean_signed: f64,
    sd_signed: Option<f64>,
}

/// Divisions of 14 embryos, of the groups `wt` and `ctrl`.
///
/// # Errors
/// None, as long as the shipped table is one.
pub fn jankele2021_divisions() -> Result<Vec<Division>, InputError> {
    Ok(divisions(&jankele2021_volumes()?).divisions)
}

/// Volumes of the cells of these embryos.
///
/// # Errors
/// None, as long as the shipped table is one.
pub fn jankele2021_volumes() -> Result<Volumes, InputError> {
    let mut volumes = Volumes::default();
    volumes.read(VOLUMES.as_bytes(), "jankele2021_volumes.csv", &ReadOptions::default())?;
    Ok(volumes)
}

/// Lifetimes of the cells of 28 unperturbed embryos, those of both groups.
///
/// # Errors
/// None, as long as the shipped table is one.
pub fn jankele2021_lifetimes() -> Result<Lifetimes, InputError> {
    Lifetimes::read(LIFETIMES.as_bytes(), "jankele2021_lifetimes.csv")
}

/// The published groups.
///
/// # Errors
/// None, as long as the shipped table is one.
pub fn jankele2021() -> Result<Vec<GroupSummary>, InputError> {
    let mut groups: Vec<GroupSummary> = Vec::new();
    for row in csv::Reader::from_reader(JANKELE.as_bytes()).deserialize() {
        let row: Row = row.map_err(|error| {
            malformed("jankele2021.csv", error.position().map_or(1, csv::Position::line) as usize, error.to_string())
        })?;
        let event = MotherSummary {
            mother: row.mother,
            n: row.n,
            mean: row.mean.unwrap_or(row.mean_signed.abs()),
            sd: row.sd.or(row.sd_signed),
            mean_signed: row.mean_signed,
            sd_signed: row.sd_signed,
            mother_volume: None,
        };
        match groups.iter_mut().find(|group| group.group == row.group) {
            Some(group) => {
                group.embryos = group.embryos.max(event.n);
                group.events.push(event);
            }
            None => groups.push(GroupSummary { group: row.group, embryos: event.n, events: vec![event] }),
        }
    }
    for group in &mut groups {
        group.events.sort_by(|a, b| place(&a.mother).cmp(&place(&b.mother)));
    }
    Ok(groups)
}
