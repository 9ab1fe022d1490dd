//! The measured χ, by cell and embryo.

use std::collections::BTreeMap;

use furrow_input::{InputError, listed, parse_document, read_text};
use furrow_lineage::Lineage;
use furrow_measured::events::{Division, divisions, place};
use furrow_measured::matching::Matched;
use furrow_measured::statistics::distinct;
use furrow_measured::tracked::EmbryoFile;
use furrow_measured::volumes::{EmbryoSize, ReadOptions, Skipped, Unit, Volumes};
use serde::Serialize;

use super::others::Others;
use crate::fit::Targets;
use crate::fit::chain::Kin;

/// One measured division.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// The place of its cell.
    pub cell: usize,
    /// The place of its unit: the divisions of a unit are left out together.
    pub unit: usize,
    /// |χ|.
    pub chi: f64,
    /// Its standard deviation, if the table has it.
    pub sd: Option<f64>,
    /// The mother's volume, in the unit of the table.
    pub volume: Option<f64>,
}

/// The unit that is left out in turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LeftOut {
    /// All divisions of an embryo.
    #[default]
    Embryo,
    /// A division: the table has fewer than two embryos.
    Division,
}

impl LeftOut {
    /// The word for `count` of them.
    pub fn word(self, count: usize) -> &'static str {
        match (self, count) {
            (LeftOut::Embryo, 1) => "embryo",
            (LeftOut::Embryo, _) => "embryos",
            (LeftOut::Division, 1) => "division",
            (LeftOut::Division, _) => "divisions",
        }
    }
}

/// Measured divisions of a cell that cannot be used.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Unused {
    /// The cell.
    pub cell: String,
    /// Divisions.
    pub n: usize,
    /// Why.
    pub why: &'static str,
}

/// Measured χ.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Observations {
    /// Cells that divide, by generation and name.
    pub cells: Vec<String>,
    /// Names of the units that are left out in turn, embryos or divisions.
    pub units: Vec<String>,
    /// Their kind.
    pub left_out: LeftOut,
    /// The divisions, in the order of the table.
    pub rows: Vec<Observation>,
    /// What was observed beside χ.
    pub others: Vec<Others>,
    /// Divisions that cannot be used, by cell.
    pub unused: Vec<Unused>,
    /// The first values of the table that could not be read.
    pub skipped: Vec<Skipped>,
    /// How many there are.
    pub skipped_count: u64,
    /// Whether volumes are of nuclei rather than of cells.
    pub of_nuclei: bool,
    /// Groups of embryos that are taken together; empty if there are fewer than two.
    pub pooled: Vec<String>,
    /// Each embryo beside the others, by size.
    pub embryos: Vec<EmbryoSize>,
    /// How the cells of embryos that were followed were matched to the lineage.
    pub matched: Vec<Matched>,
}

/// Which divisions of a table are used.
#[derive(Clone, Copy, Debug, Default)]
pub struct Chosen<'a> {
    /// Cells; `None` for all that the lineage has.
    pub cells: Option<&'a [String]>,
    /// Groups; `None` for all.
    pub groups: Option<&'a [String]>,
}

/// How cells get names of the lineage.
const CALLED: &str = "--names and --root match single cells, --class names classes of cells by columns of the table";

const NOT_OF_LINEAGE: &str = "the lineage has no such cell";

impl Observations {
    /// The divisions of files: tables and embryos that other programs followed, as [`Volumes::read_file`] reads them, or targets of
    /// a fit (`.ron`). Errors name the files, and the `options` of cells and groups.
    ///
    /// # Errors
    /// A file that cannot be read; else as [`Observations::of_tables`] and [`Observations::of_targets`].
    pub fn read(
        files: &[EmbryoFile],
        reading: &ReadOptions,
        lineage: &Lineage,
        chosen: Chosen<'_>,
        options: [&str; 2],
    ) -> Result<Observations, InputError> {
        let is_ron =
            |file: &&EmbryoFile| file.path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("ron"));
        let Some(EmbryoFile { path: file, .. }) = files.iter().find(is_ron) else {
            let volumes = Volumes::of_files(files, reading)?;
            reading.names.require_met()?;
            let source: Vec<String> = files.iter().map(|file| file.path.display().to_string()).collect();
            let source = listed(source.iter().map(String::as_str), ", ");
            return Observations::of_tables(&volumes, lineage, chosen, (&source, options));
        };
        let source = file.display().to_string();
        InputError::require(
            files.len() == 1,
            &source,
            "tables",
            files.len(),
            "this file alone: it has targets of a fit",
        )?;
        let targets: Targets = parse_document(&read_text(file)?, &source, "a file of targets of a fit", "Fit")?;
        targets.check(&source, lineage)?;
        Observations::of_targets(&targets, lineage, chosen.cells, (&source, options[0]))
    }

    /// The divisions of tables. Errors name `source`, the tables, and the `options` of cells and groups.
    ///
    /// # Errors
    /// Chosen cells or groups that the tables lack, and tables without a division of a cell of the lineage.
    pub fn of_tables(
        volumes: &Volumes,
        lineage: &Lineage,
        chosen: Chosen<'_>,
        (source, options): (&str, [&str; 2]),
    ) -> Result<Observations, InputError> {
        let mut found = divisions(volumes);
        if let Some(groups) = chosen.groups {
            found.keep_populations(options[1], groups)?;
        }
        let has_sizes = volumes.unit != Some(Unit::OfMother);
        let row = |division: &Division| Measured {
            cell: division.mother.clone(),
            embryo: match volumes.of_populations {
                true => division.embryo.clone(),
                false => [&division.group, &division.embryo].map(String::as_str).join("\u{1f}"),
            },
            name: division.embryo.clone(),
            chi: division.chi(),
            sd: division.chi_sd,
            volume: if has_sizes { Some(division.mother_volume()) } else { division.mother_measured },
        };
        let rows = found.divisions.iter().map(row).collect();
        let mut pooled: Vec<String> = found.divisions.iter().map(|division| division.group.clone()).collect();
        pooled.sort_unstable();
        pooled.dedup();
        if volumes.of_populations || pooled.len() < 2 {
            pooled.clear();
        }
        let observations = Observations::of(rows, lineage, chosen.cells, (source, options[0]))?;
        Ok(Observations {
            skipped: volumes.skipped.clone(),
            skipped_count: volumes.skipped_count,
            of_nuclei: volumes.of_nuclei,
            pooled,
            embryos: volumes.sizes(),
            matched: volumes.matched.clone(),
            ..observations
        })
    }

    /// The χ of a file of targets, each a division by itself.
    ///
    /// # Errors
    /// Chosen cells that the targets lack, and targets without χ.
    pub fn of_targets(
        targets: &Targets,
        lineage: &Lineage,
        cells: Option<&[String]>,
        source: (&str, &str),
    ) -> Result<Observations, InputError> {
        let row = |chi: &crate::fit::targets::MeasuredChi| Measured {
            cell: chi.cell.clone(),
            embryo: String::new(),
            name: String::new(),
            chi: chi.mean,
            sd: Some(chi.sd),
            volume: None,
        };
        Observations::of(targets.chi.iter().map(row).collect(), lineage, cells, source)
    }

    fn of(
        measured: Vec<Measured>,
        lineage: &Lineage,
        chosen: Option<&[String]>,
        (source, option): (&str, &str),
    ) -> Result<Observations, InputError> {
        let kin = Kin::of(lineage, measured.iter().map(|row| row.cell.as_str()));
        let known = |cell: &str| kin.place(cell).is_some();
        let mut all: Vec<&str> = measured.iter().map(|row| row.cell.as_str()).collect();
        all.sort_by_cached_key(|cell| place(cell));
        all.dedup();
        if let Some(name) = chosen.into_iter().flatten().find(|name| !all.contains(&name.trim()) || !known(name.trim()))
        {
            let names: Vec<&str> = all.iter().copied().filter(|cell| known(cell)).collect();
            let allowed = format!("measured cells of the lineage: {}", names.join(", "));
            return Err(InputError::not_allowed(option, "cells", format!("{name:?}"), allowed));
        }
        let wanted = |cell: &str| chosen.is_none_or(|names| names.iter().any(|name| name.trim() == cell));
        let mut unused: BTreeMap<(u32, &str), Unused> = BTreeMap::new();
        for row in measured.iter().filter(|row| !known(&row.cell)) {
            let of = || Unused { cell: row.cell.clone(), n: 0, why: NOT_OF_LINEAGE };
            unused.entry(place(&row.cell)).or_insert_with(of).n += 1;
        }
        let kept: Vec<&Measured> = measured.iter().filter(|row| known(&row.cell) && wanted(&row.cell)).collect();
        let refused = || {
            let cells = lineage.founders.iter().map(|founder| founder.name.as_str());
            format!(
                "at least one measured χ of a cell of {}: {}; the table has {}. {CALLED}",
                lineage.name,
                listed(cells, ", "),
                listed(all.iter().copied(), ", ")
            )
        };
        if kept.is_empty() {
            return Err(InputError::not_allowed(source, "mother", "none of the lineage", refused()));
        }
        let cells: Vec<String> =
            all.into_iter().filter(|cell| known(cell) && wanted(cell)).map(str::to_owned).collect();
        let (left_out, units) = units(&kept);
        let row = |(k, row): (usize, &&Measured)| Observation {
            cell: cells.iter().position(|cell| *cell == row.cell).unwrap_or(0),
            unit: match left_out {
                LeftOut::Division => k,
                LeftOut::Embryo => units.iter().position(|(embryo, _)| *embryo == row.embryo).unwrap_or(0),
            },
            chi: row.chi,
            sd: row.sd,
            volume: row.volume,
        };
        let rows = kept.iter().enumerate().map(row).collect();
        let units = units.iter().map(|(_, name)| (*name).to_owned()).collect();
        let unused = unused.into_values().collect();
        Ok(Observations { cells, units, left_out, rows, unused, ..Observations::default() })
    }

    /// |χ| of a cell.
    pub fn chi_of(&self, cell: usize) -> Vec<f64> {
        self.rows.iter().filter(|row| row.cell == cell).map(|row| row.chi).collect()
    }
}

/// A measured division as it was read.
struct Measured {
    cell: String,
    /// The embryo, different for embryos of the same name in different groups.
    embryo: String,
    name: String,
    chi: f64,
    sd: Option<f64>,
    volume: Option<f64>,
}

/// The units that are left out in turn, by key and name.
fn units<'a>(rows: &[&'a Measured]) -> (LeftOut, Vec<(&'a str, &'a str)>) {
    let embryos = distinct(rows.iter().map(|row| (row.embryo.as_str(), row.name.as_str())));
    if embryos.len() > 1 {
        return (LeftOut::Embryo, embryos);
    }
    (LeftOut::Division, rows.iter().map(|row| (row.cell.as_str(), row.cell.as_str())).collect())
}
