//! Size asymmetries of divisions with both daughters measured.
//!
//! * \[χ\] χ = |V₁ − V₂|/(V₁ + V₂); signed, (V₁ − V₂)/(V₁ + V₂), where V₁ belongs to the daughter named first.
//!
//! A mother's volume is the sum of her daughters': segmentations do not always show her, and she grows while they do.

use std::collections::{BTreeMap, BTreeSet};

use furrow_input::InputError;
use serde::Serialize;

use crate::names::generation;
use crate::statistics::{grouped, mean, sd};
use crate::volumes::Volumes;

/// A division.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Division {
    /// The embryo.
    pub embryo: String,
    /// Its group; empty without groups.
    pub group: String,
    /// The cell that divides.
    pub mother: String,
    /// Its daughters, in the order of their names.
    pub daughters: [String; 2],
    /// Their volumes, in the unit of the table.
    pub volumes: [f64; 2],
    /// (V₁ − V₂)/(V₁ + V₂).
    pub chi_signed: f64,
    /// Whether its sign is known: of a table without signs it is positive.
    #[serde(skip)]
    pub is_signed: bool,
    /// The mother's own volume, where a table has it beside the division.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mother_measured: Option<f64>,
    /// The standard deviation of χ, where a table of χ has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chi_sd: Option<f64>,
}

impl Division {
    /// |V₁ − V₂|/(V₁ + V₂).
    pub fn chi(&self) -> f64 {
        self.chi_signed.abs()
    }

    /// V₁ + V₂.
    pub fn mother_volume(&self) -> f64 {
        self.volumes[0] + self.volumes[1]
    }
}

/// A division with only one daughter measured.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct HalfSeen {
    /// The embryo.
    pub embryo: String,
    /// Its group.
    pub group: String,
    /// The cell that divides.
    pub mother: String,
    /// The daughter that is not measured.
    pub missing: String,
}

/// The divisions in a table.
#[derive(Clone, Debug, Default)]
pub struct Divisions {
    /// Divisions with both daughters measured.
    pub divisions: Vec<Division>,
    /// Divisions with one daughter measured.
    pub half_seen: Vec<HalfSeen>,
}

impl Divisions {
    /// Leaves the divisions with both daughters of these populations, which are the groups of a table of divisions.
    ///
    /// # Errors
    /// A population that has no such division; errors say the name came from `source_name`.
    pub fn keep_populations(&mut self, source_name: &str, wanted: &[String]) -> Result<(), InputError> {
        let known: BTreeSet<&str> = self.divisions.iter().map(|division| division.group.as_str()).collect();
        if let Some(name) = wanted.iter().find(|name| !known.contains(name.trim())) {
            let allowed = match known.iter().all(|name| name.is_empty()) {
                true => "left out: the tables have no populations (a column population, group or condition)".to_owned(),
                false => format!("populations of the tables: {}", Vec::from_iter(known).join(", ")),
            };
            return Err(InputError::not_allowed(source_name, "population", name, allowed));
        }
        self.divisions.retain(|division| wanted.iter().any(|name| name.trim() == division.group));
        Ok(())
    }
}

/// All divisions of all embryos.
pub fn divisions(volumes: &Volumes) -> Divisions {
    let mut found = Divisions { divisions: volumes.divisions.clone(), half_seen: Vec::new() };
    for embryo in &volumes.embryos {
        let measured = embryo.cells.iter().filter(|cell| cell.frames > 0);
        let known: BTreeMap<&str, f64> = measured.map(|cell| (cell.cell.as_str(), cell.volume())).collect();
        for (&name, &volume) in &known {
            let Some((mother, other, is_first)) = volumes.names.birth(name) else { continue };
            let (embryo, group, mother) = (embryo.name.clone(), embryo.group.clone(), mother.to_owned());
            match known.get(other.as_str()) {
                None => found.half_seen.push(HalfSeen { embryo, group, mother, missing: other }),
                Some(second) if is_first => {
                    let (daughters, volumes) = ([name.to_owned(), other], [volume, *second]);
                    let chi_signed = (volume - second) / (volume + second);
                    let division = Division { embryo, group, mother, daughters, volumes, ..Division::default() };
                    found.divisions.push(Division { chi_signed, is_signed: true, ..division });
                }
                Some(_) => {}
            }
        }
    }
    found
}

/// Divisions of one mother in all embryos of a group.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MotherSummary {
    /// The cell that divides.
    pub mother: String,
    /// Embryos.
    pub n: usize,
    /// Mean of |χ|.
    pub mean: f64,
    /// Its sample standard deviation; `None` for one embryo.
    pub sd: Option<f64>,
    /// Mean of the signed χ; `None` where a table has no signs.
    pub mean_signed: Option<f64>,
    /// Its standard deviation.
    pub sd_signed: Option<f64>,
    /// Mean volume of the mother; `None` where it is not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mother_volume: Option<f64>,
}

/// The divisions of a group.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GroupSummary {
    /// The group; empty if the table has no groups.
    pub group: String,
    /// Its embryos with a division.
    pub embryos: usize,
    /// By mother, in the order of the lineage.
    pub events: Vec<MotherSummary>,
}

/// Divisions by their group, groups in the order of the table.
pub fn by_group(divisions: &[Division]) -> Vec<(&str, Vec<&Division>)> {
    grouped(divisions.iter().map(|division| (division.group.as_str(), division)))
}

/// χ by group, in the order of the table, and mother.
pub fn summaries(divisions: &[Division]) -> Vec<GroupSummary> {
    by_group(divisions).into_iter().map(|(group, divisions)| summary(group, &divisions)).collect()
}

fn summary(group: &str, divisions: &[&Division]) -> GroupSummary {
    let embryos: BTreeSet<&str> = divisions.iter().map(|division| division.embryo.as_str()).collect();
    let mut by_mother = grouped(divisions.iter().map(|division| (place(&division.mother), *division)));
    by_mother.sort_by_key(|(place, _)| *place);
    let of = |((_, mother), of): ((u32, &str), Vec<&Division>)| {
        let each = |get: fn(&Division) -> f64| of.iter().map(|division| get(division)).collect::<Vec<f64>>();
        let chi = each(Division::chi);
        let signed = of.iter().all(|division| division.is_signed).then(|| each(|division| division.chi_signed));
        MotherSummary {
            mother: mother.to_owned(),
            n: chi.len(),
            mean: mean(&chi),
            sd: sd(&chi),
            mean_signed: signed.as_deref().map(mean),
            sd_signed: signed.as_deref().and_then(sd),
            mother_volume: Some(mean(&each(Division::mother_volume))),
        }
    };
    GroupSummary { group: group.to_owned(), embryos: embryos.len(), events: by_mother.into_iter().map(of).collect() }
}

/// Precedes the number of a generation. Divisions of tables without Sulston's names are summarised by it.
pub(crate) const GENERATION: &str = "generation ";

/// The order of cells: by generation, then by name.
pub fn place(name: &str) -> (u32, &str) {
    let counted = name.strip_prefix(GENERATION).and_then(|number| number.parse().ok());
    (counted.unwrap_or_else(|| generation(name)), name)
}
