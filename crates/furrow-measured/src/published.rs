//! Published size asymmetries as means over embryos, the default of a comparison.
//!
//! # References
//! Jankele, Jelier & Gönczy, *eLife* 10, e61714 (2021): segmented volumes of 6 wild-type embryos (`wt`), 8 of the same strain as
//! the changed ones (`ctrl`), and embryos with a first division made equal by moving the spindle, 11 that hatched (`alive`) and
//! 12 that did not (`dead`). For the last two only signed means are known, which equal means of |χ| where all signs are alike.
//!
//! Villoutreix et al., *Sci. Rep.* 6, 37438 (2016): 1,702 divisions of five blastulae of *Paracentrotus lividus*, by population
//! (macromeres, mesomeres, large and small micromeres) and generation. χ is the larger minus the smaller daughter.
//!
//! Rodrigues et al. (2024), CC BY 4.0: 83 two-cell embryos over the dosage of PAR-6, wild type, heterozygous and after RNAi.

use furrow_input::InputError;
use furrow_input::table::malformed;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::dose::{DoseGroup, Spread};
use crate::events::{Division, GroupSummary, MotherSummary, divisions, place};
use crate::lifetimes::Lifetimes;
use crate::volumes::{ReadOptions, Volumes};

/// The table, as shipped.
const JANKELE: &str = include_str!("../data/jankele2021.csv");

/// Volumes of cells of single embryos, of the groups `wt` and `ctrl`.
const VOLUMES: &str = include_str!("../data/jankele2021_volumes.csv");

/// Lifetimes of the cells of 28 embryos of both groups: means of those measured in at least five.
const LIFETIMES: &str = include_str!("../data/jankele2021_lifetimes.csv");
/// Divisions of five sea-urchin embryos, by population and generation.
const VILLOUTREIX: &str = include_str!("../data/villoutreix2016.csv");

/// The cells of Sulston's lineage with their mothers, births and fates.
const SULSTON: &str = include_str!("../data/sulston1983_lineage.csv");

/// The source of the divisions of sea-urchin embryos.
pub const SEA_URCHIN_SOURCE: &str = "Villoutreix et al. 2016, Sci. Rep. 6:37438";

/// Asymmetry over the dose of PAR-6, by condition and in bins of the dose.
const RODRIGUES: &str = include_str!("../data/rodrigues2024.csv");

/// The source of the asymmetries over the dose of PAR-6.
pub const DOSE_SOURCE: &str = "Rodrigues et al. 2024, dosage of PAR-6 and asymmetry of the two-cell stage";

/// The source of the table of volumes.
pub const SOURCE: &str = "Jankele, Jelier & Gönczy 2021, eLife 10:e61714";

#[derive(Deserialize)]
struct Row {
    group: String,
    mother: String,
    n: usize,
    mean: Option<f64>,
    sd: Option<f64>,
    /// None where daughters are named larger and smaller: their difference has no sign of its own.
    #[serde(default)]
    mean_signed: Option<f64>,
    #[serde(default)]
    sd_signed: Option<f64>,
    #[serde(default)]
    mother_volume: Option<f64>,
    #[serde(default)]
    embryos: Option<usize>,
}

/// Divisions of 14 embryos, of the groups `wt` and `ctrl`.
///
/// # Errors
/// Only if the shipped table is invalid.
pub fn jankele2021_divisions() -> Result<Vec<Division>, InputError> {
    Ok(divisions(&jankele2021_volumes()?).divisions)
}

/// Volumes of the cells of these embryos.
///
/// # Errors
/// Only if the shipped table is invalid.
pub fn jankele2021_volumes() -> Result<Volumes, InputError> {
    let mut volumes = Volumes::default();
    volumes.read(VOLUMES.as_bytes(), "jankele2021_volumes.csv", &ReadOptions::default())?;
    Ok(volumes)
}

/// Lifetimes of the cells of 28 unperturbed embryos, from both groups.
///
/// # Errors
/// Only if the shipped table is invalid.
pub fn jankele2021_lifetimes() -> Result<Lifetimes, InputError> {
    Lifetimes::read(LIFETIMES.as_bytes(), "jankele2021_lifetimes.csv")
}

/// The cells of Sulston's lineage: name, mother (empty for P0) and birth in minutes, if it is known. Mothers come before their daughters.
pub fn sulston() -> impl Iterator<Item = (&'static str, &'static str, Option<f64>)> {
    let rows = SULSTON.lines().filter(|line| !line.starts_with('#')).skip(1).map(|line| line.split(','));
    rows.filter_map(|mut fields| Some((fields.next()?, fields.next()?, fields.next()?.parse().ok())))
}

/// The published groups of worms.
///
/// # Errors
/// Only if the shipped table is invalid.
pub fn jankele2021() -> Result<Vec<GroupSummary>, InputError> {
    groups_of(JANKELE, "jankele2021.csv")
}

/// The published populations of sea urchins, by generation.
///
/// # Errors
/// Only if the shipped table is invalid.
pub fn villoutreix2016() -> Result<Vec<GroupSummary>, InputError> {
    groups_of(VILLOUTREIX, "villoutreix2016.csv")
}

/// The rows of a shipped table.
fn rows<T: DeserializeOwned>(table: &str, file: &str) -> Result<Vec<T>, InputError> {
    let refused = |error: csv::Error| {
        malformed(file, error.position().map_or(1, csv::Position::line) as usize, error.to_string())
    };
    csv::Reader::from_reader(table.as_bytes()).into_deserialize().collect::<Result<_, _>>().map_err(refused)
}

fn groups_of(table: &str, file: &str) -> Result<Vec<GroupSummary>, InputError> {
    let mut groups: Vec<GroupSummary> = Vec::new();
    for row in rows::<Row>(table, file)? {
        let Some(mean) = row.mean.or(row.mean_signed.map(f64::abs)) else {
            return Err(InputError::not_allowed(file, "mean", "none", "given, or mean_signed in its place"));
        };
        let event = MotherSummary {
            mother: row.mother,
            n: row.n,
            mean,
            sd: row.sd.or(row.sd_signed),
            mean_signed: row.mean_signed,
            sd_signed: row.sd_signed,
            mother_volume: row.mother_volume,
        };
        match groups.iter_mut().find(|group| group.group == row.group) {
            Some(group) => {
                group.embryos = row.embryos.unwrap_or(group.embryos.max(event.n));
                group.events.push(event);
            }
            None => {
                let embryos = row.embryos.unwrap_or(event.n);
                groups.push(GroupSummary { group: row.group, embryos, events: vec![event] });
            }
        }
    }
    for group in &mut groups {
        group.events.sort_by(|a, b| place(&a.mother).cmp(&place(&b.mother)));
    }
    Ok(groups)
}

#[derive(Deserialize)]
struct DoseRow {
    by: String,
    name: String,
    n: usize,
    dose: f64,
    dose_sd: Option<f64>,
    larger_share: f64,
    larger_share_sd: Option<f64>,
    chi_area: f64,
    chi_area_sd: Option<f64>,
    chi_volume: f64,
    chi_volume_sd: Option<f64>,
}

/// Published asymmetries of the worm's first division over the dose of PAR-6: by condition, and in bins of the dose.
///
/// # Errors
/// Only if the shipped table is invalid.
pub fn rodrigues2024() -> Result<[Vec<DoseGroup>; 2], InputError> {
    let mut groups = [Vec::new(), Vec::new()];
    for row in rows::<DoseRow>(RODRIGUES, "rodrigues2024.csv")? {
        let spread = |mean: f64, sd: Option<f64>| Spread { mean, sd };
        groups[usize::from(row.by != "condition")].push(DoseGroup {
            name: row.name,
            n: row.n,
            dose: spread(row.dose, row.dose_sd),
            larger_share: spread(row.larger_share, row.larger_share_sd),
            chi_area: spread(row.chi_area, row.chi_area_sd),
            chi_volume: spread(row.chi_volume, row.chi_volume_sd),
        });
    }
    Ok(groups)
}
