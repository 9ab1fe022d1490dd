//! Asymmetry of a division over the dose of a protein.
//!
//! Tables have the columns `dose` (or a name that ends in `_dose` or `_dosage`) and `larger_share`, the larger daughter's share of
//! the size of both, and optionally `condition`. The wild type has dose 1. Sizes are areas of an image or volumes; both readings
//! are kept, because sources do not always say which:
//!
//! * \[volume\] χ = 2s − 1
//! * \[area\] χ = (s^{3/2} − (1 − s)^{3/2})/(s^{3/2} + (1 − s)^{3/2}), of daughters of one shape
//!
//! # References
//! Rodrigues et al. (2024): two-cell stage of *C. elegans* over the dosage of PAR-6, CC BY 4.0.

use std::io::Read;

use furrow_input::table::{Header, NamedUnit, Row, Table, split_unit};
use furrow_input::{InputError, rounded_number};
use serde::{Deserialize, Serialize};

use crate::layout::{GroupColumn, SHARES, SUMMARY, embryo_column, is_summary};
use crate::statistics::{Line, RankCorrelation, grouped, line, mean, rank_correlation, sd};
use crate::volumes::{Rejected, Skipped, Value, fitting, note};

/// A division of a cell with a dose.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DosedDivision {
    /// The dose; 1 in the wild type.
    pub dose: f64,
    /// Share of the two daughters' size that the larger one has.
    pub larger_share: f64,
    /// The condition; empty if the table has no conditions.
    pub condition: String,
}

impl DosedDivision {
    /// χ if sizes are areas.
    pub fn chi_area(&self) -> f64 {
        let [large, small] = [self.larger_share, 1.0 - self.larger_share].map(|share| share.powf(1.5));
        (large - small) / (large + small)
    }

    /// χ if sizes are volumes.
    pub fn chi_volume(&self) -> f64 {
        2.0 * self.larger_share - 1.0
    }
}

/// A table of doses.
#[derive(Clone, Debug, Default)]
pub struct Doses {
    /// Its divisions, in its order.
    pub divisions: Vec<DosedDivision>,
    /// Rows that could not be used, at most [`MOST_PLACES`](crate::volumes::MOST_PLACES).
    pub skipped: Vec<Skipped>,
    /// How many there are.
    pub skipped_count: u64,
}

impl Doses {
    /// Reads a table. Reports name it `file`.
    ///
    /// # Errors
    /// A table without the required columns, or without a usable row.
    pub fn read(from: impl Read, file: &str) -> Result<Doses, InputError> {
        let mut table = Table::open(from, file)?;
        let columns = Columns::of(&table.columns(|_| false)?)?;
        let mut doses = Doses::default();
        while let Some(row) = table.next_row()? {
            match fitting(row).and_then(|row| columns.division(row)) {
                Ok(division) => doses.divisions.push(division),
                Err(rejected) => note(&mut doses.skipped, &mut doses.skipped_count, || Skipped::new(file, &rejected)),
            }
        }
        let first = doses.skipped.first().map_or("the table has no rows".to_owned(), Skipped::described);
        let allowed = format!("at least one that can be used ({first})");
        InputError::require(!doses.divisions.is_empty(), file, "rows", "none used", allowed)?;
        Ok(doses)
    }
}

/// Units of doses: shares of the wild type's.
const DOSES: [NamedUnit<()>; 2] = [
    NamedUnit { kind: (), size: 1.0, words: &["1", "relative", "fraction", "fold", "wt", "wildtype"] },
    NamedUnit { kind: (), size: 0.01, words: &["%", "percent", "%wt", "%ofwt", "%wildtype", "%ofwildtype"] },
];

struct Columns {
    dose: usize,
    /// Its unit, as a share of the wild type's dose.
    unit: f64,
    share: usize,
    /// Its unit, as a share.
    share_unit: f64,
    condition: GroupColumn,
    embryo: Option<usize>,
}

impl Columns {
    fn of(header: &Header<'_>) -> Result<Columns, InputError> {
        let is_dose = |name: &str| {
            let (name, _) = split_unit(name);
            let name = name.trim_end_matches(['_', '/']).trim_end_matches("_(%)");
            ["dose", "dosage"].iter().any(|end| name == *end || name.ends_with(&format!("_{end}")))
        };
        let dose = header.find_only("dose", |name| is_dose(name.trim_end_matches(['%', '_', '/'])))?;
        let is_logarithm = |name: &str| ["log", "ln", "lg"].iter().any(|start| name.starts_with(start));
        if let Some(column) = dose.filter(|column| is_logarithm(&header.names[*column].to_lowercase())) {
            let why =
                format!("column {}, {:?}, must have doses and not their logarithms", column + 1, header.names[column]);
            return Err(header.refused(why));
        }
        let share = header.only("share", &header.quantity("larger_share", &SHARES)?)?;
        let condition = GroupColumn::of(header);
        let embryo = embryo_column(header);
        let missing = |name: &str| {
            let table =
                "a table of doses has the columns dose (or one whose name ends in _dose or _dosage) and larger_share";
            header.missing(&[(name, None)], table)
        };
        let dose = dose.ok_or_else(|| missing("dose"))?;
        let (share, of_share) = share.ok_or_else(|| missing("larger_share"))?;
        let unit = header.unit(dose, &DOSES)?.map_or(1.0, |unit| unit.size);
        let share_unit = of_share.map_or(1.0, |unit| unit.size);
        Ok(Columns { dose, unit, share, share_unit, condition, embryo })
    }

    fn division<'r>(&self, row: Row<'r>) -> Result<DosedDivision, Rejected<'r>> {
        let at = |column: usize| Value::new(row, column);
        // A summary may be called so in the column of either.
        for value in [self.embryo, self.condition.column].into_iter().flatten().map(at) {
            if is_summary(value.text) {
                return Err((value, SUMMARY.to_owned()));
            }
        }
        let read = |column: usize, fits: fn(f64) -> bool, allowed: &str| {
            let value = at(column);
            let number = value.number()?;
            if fits(number) { Ok(number) } else { Err((value, format!("must be {allowed}"))) }
        };
        let dose =
            self.unit * read(self.dose, |dose| (0.0..=1e6).contains(&dose), "from 0 to 1e6; 1 is the wild type")?;
        let larger_share = match self.share_unit {
            1.0 => {
                read(self.share, |share| (0.5..1.0).contains(&share), "from 0.5, the larger daughter's, and below 1")?
            }
            unit => {
                let allowed = "from 50 %, the larger daughter's, and below 100 %";
                unit * read(self.share, |share| (50.0..100.0).contains(&share), allowed)?
            }
        };
        let condition = self.condition.group_of(row, None)?;
        Ok(DosedDivision { dose, larger_share, condition })
    }
}

/// A mean and the standard deviation of the sample.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// The mean.
    pub mean: f64,
    /// The standard deviation, by n − 1; `None` of one value.
    pub sd: Option<f64>,
}

impl Spread {
    fn of(values: &[f64]) -> Spread {
        Spread { mean: mean(values), sd: sd(values) }
    }
}

/// Divisions of one condition, or with doses of one bin.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DoseGroup {
    /// The condition, or the bin's doses.
    pub name: String,
    /// Divisions.
    pub n: usize,
    /// The dose.
    pub dose: Spread,
    /// The share of the larger daughter.
    pub larger_share: Spread,
    /// χ if sizes are areas.
    pub chi_area: Spread,
    /// χ if sizes are volumes.
    pub chi_volume: Spread,
}

impl DoseGroup {
    fn of(name: String, divisions: &[&DosedDivision]) -> DoseGroup {
        let each = |get: fn(&DosedDivision) -> f64| Spread::of(&divisions.iter().map(|d| get(d)).collect::<Vec<f64>>());
        DoseGroup {
            name,
            n: divisions.len(),
            dose: each(|division| division.dose),
            larger_share: each(|division| division.larger_share),
            chi_area: each(DosedDivision::chi_area),
            chi_volume: each(DosedDivision::chi_volume),
        }
    }
}

/// Divisions by condition, in the order of the table.
pub fn by_condition(divisions: &[DosedDivision]) -> Vec<DoseGroup> {
    let conditions = grouped(divisions.iter().map(|division| (division.condition.as_str(), division)));
    conditions.into_iter().map(|(name, divisions)| DoseGroup::of(name.to_owned(), &divisions)).collect()
}

/// Most bins that are made without edges.
const MOST_BINS: usize = 50;

/// Divisions in bins of the dose, those without a division left out. `edges` rise; without them bins are 0.2 wide, or
/// if these were too many a fiftieth of the largest dose.
pub fn by_dose(divisions: &[DosedDivision], edges: Option<&[f64]>) -> Vec<DoseGroup> {
    let most = divisions.iter().map(|division| division.dose).fold(0.0, f64::max);
    let default = || {
        let count = (most * 5.0).floor() as usize + 1;
        match count <= MOST_BINS {
            true => (0..=count).map(|k| k as f64 / 5.0).collect(),
            false => (0..=MOST_BINS).map(|k| k as f64 * 1.001 * most / MOST_BINS as f64).collect::<Vec<f64>>(),
        }
    };
    let edges = edges.map_or_else(default, <[f64]>::to_vec);
    let bin = |pair: &[f64]| {
        let inside = |division: &&DosedDivision| (pair[0]..pair[1]).contains(&division.dose);
        let inside: Vec<&DosedDivision> = divisions.iter().filter(inside).collect();
        (!inside.is_empty()).then(|| {
            DoseGroup::of(pair.iter().map(|edge| rounded_number(*edge, 4)).collect::<Vec<_>>().join(".."), &inside)
        })
    };
    edges.windows(2).filter_map(bin).collect()
}

/// The trend of asymmetry over the dose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DoseTrend {
    /// Rank correlation of dose and share, the same for every reading of the share.
    pub spearman: Option<RankCorrelation>,
    /// The share of the larger daughter over the dose; its intercept is the share without the protein.
    pub larger_share: Option<Line>,
    /// χ over the dose if sizes are areas.
    pub chi_area: Option<Line>,
    /// χ over the dose if sizes are volumes.
    pub chi_volume: Option<Line>,
}

/// The trend of some divisions.
pub fn trend(divisions: &[DosedDivision]) -> DoseTrend {
    let over = |get: fn(&DosedDivision) -> f64| divisions.iter().map(|d| [d.dose, get(d)]).collect::<Vec<[f64; 2]>>();
    let share = over(|division| division.larger_share);
    DoseTrend {
        spearman: rank_correlation(&share),
        larger_share: line(&share),
        chi_area: line(&over(DosedDivision::chi_area)),
        chi_volume: line(&over(DosedDivision::chi_volume)),
    }
}
