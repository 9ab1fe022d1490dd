//! The columns and rows of tables of lifetimes.

use std::collections::HashMap;

use furrow_input::table::{Header, Row, TIMES, columns_listed};
use furrow_input::{InputError, rounded_number};

use crate::layout::{GROUP, cell_column, embryo_column, is_absent};
use crate::lifetimes::Lifetime;
use crate::names::Names;
use crate::volumes::{Rejected, Value, fitting};

/// A column of times and the minutes in its unit.
type TimeColumn = (usize, f64);

/// What says how long a cell lives.
enum Life {
    Lifetime(TimeColumn),
    /// Its birth and its division, and the column of its mother, if there is one: without a mother its birth was not seen.
    Times(TimeColumn, TimeColumn, Option<usize>),
}

/// The columns of a table.
pub(crate) struct Columns {
    pub(crate) cell: usize,
    life: Life,
    pub(crate) n: Option<usize>,
    sd: Option<TimeColumn>,
    birth: Option<TimeColumn>,
    division: Option<TimeColumn>,
    pub(crate) embryo: Option<usize>,
    /// The columns of groups.
    groups: Vec<usize>,
    /// Whether a recording ended before the cell divided.
    censored: Option<usize>,
}

impl Columns {
    pub(crate) fn of(header: &Header<'_>) -> Result<Columns, InputError> {
        let time = |what: &str| -> Result<Option<TimeColumn>, InputError> {
            let refused = |column: usize, why: String| {
                let named: Vec<String> = TIMES.iter().map(|unit| format!("{what}_{}", unit.words[0])).collect();
                header.refused(format!("column {} is {why} {}", column + 1, named.join(", ")))
            };
            match header.quantity(what, &TIMES)?[..] {
                [] => Ok(None),
                [(column, Some(unit))] => Ok(Some((column, unit.size))),
                [(column, None), ..] => {
                    Err(refused(column, format!("called {what:?}: its name must have the unit, as")))
                }
                [_, (second, _), ..] => Err(refused(second, format!("a second one for the {what}; allowed is one of"))),
            }
        };
        let missing = |what: &str| {
            let here = columns_listed(&header.names);
            header.refused(format!("no column is called {what}; the columns are {here}"))
        };
        let cell = cell_column(header).ok_or_else(|| missing("cell"))?;
        let (lifetime, n, sd, birth) = (time("lifetime")?, header.find(&["n"]), time("sd")?, time("birth")?);
        let division = match lifetime {
            None if birth.is_some() => time("division")?,
            // Beside a lifetime a column of this name may be something else.
            _ => header.quantity("division", &TIMES)?.into_iter().find_map(|(at, unit)| Some((at, unit?.size))),
        };
        let life = match (lifetime, birth, division) {
            (Some(lifetime), ..) => Life::Lifetime(lifetime),
            (None, Some(birth), Some(division)) => Life::Times(birth, division, header.find(&["mother"])),
            (None, ..) => return Err(missing("lifetime_min, nor are there both birth_min and division_min")),
        };
        if let (None, Some((column, _))) = (n, sd) {
            let why = format!("column {} is a standard deviation, but no column is called n", column + 1);
            return Err(header.refused(why));
        }
        if let Life::Lifetime((column, _)) = life
            && let Some(other) =
                header.find(&["lifetime_mean", "lifetime_max", "lifetime_median", "mean_lifetime", "max_lifetime"])
            && header.names[column].to_lowercase().ends_with("_min")
        {
            let (name, other) = (&header.names[column], &header.names[other]);
            let why = format!(
                "column {}, {name:?}, may be the minimum or in minutes beside {other:?}: call it lifetime (min)",
                column + 1
            );
            return Err(header.refused(why));
        }
        let embryo = embryo_column(header);
        if embryo.is_some() && n.is_some() {
            let why = "a row is of one embryo, with a column embryo, or a mean over n embryos: leave out one of the two columns";
            return Err(header.refused(why));
        }
        let groups = GROUP.iter().filter_map(|name| header.find(&[name])).collect();
        let censored = header.find(&["censored", "is_censored", "right_censored"]);
        Ok(Columns { cell, life, n, sd, birth, division, embryo, groups, censored })
    }

    /// The columns of times.
    pub(crate) fn times(&self) -> impl Iterator<Item = usize> {
        let of_life = match self.life {
            Life::Lifetime(column) => [Some(column), None],
            Life::Times(birth, division, _) => [Some(birth), Some(division)],
        };
        of_life.into_iter().chain([self.sd, self.birth]).flatten().map(|(column, _)| column)
    }

    /// Requires that all rows are of one group, since lifetimes are averaged. `of_table` keeps the groups of the table.
    pub(crate) fn require_group(
        &self,
        row: Row<'_>,
        of_table: &mut HashMap<usize, String>,
        file: &str,
    ) -> Result<(), InputError> {
        let groups = self.groups.iter().map(|column| (*column, Value::new(row, *column)));
        for (column, value) in groups.filter(|(_, value)| !is_absent(value.text)) {
            let (group, before) = (value.written(), of_table.entry(column).or_insert_with(|| value.written()));
            let allowed = format!("{before:?}, the group of the rows before: each group needs a table of its own");
            InputError::require(group == *before, file, value.field(), format!("{group:?}"), allowed)?;
        }
        Ok(())
    }

    /// The embryo of a row; `None` without such a column.
    pub(crate) fn embryo_of<'r>(&self, row: Row<'r>) -> Result<Option<String>, Rejected<'r>> {
        self.embryo.map(|column| Value::new(row, column).named("an embryo")).transpose()
    }
}

/// Limits of a time, in minutes: sums beyond them could overflow.
const TIMES_OF_CELLS: [f64; 2] = [1e-9, 1e12];

/// Times of one life may differ by rounding, relative to it.
const ROUNDED: f64 = 0.05;

/// Minutes in a column that are in the limits.
fn minutes<'r>(row: Row<'r>, (column, unit): TimeColumn, least: f64, allowed: &str) -> Result<f64, Rejected<'r>> {
    let value = Value::new(row, column);
    let time = value.number().map_err(|(value, why)| (value, format!("{allowed} ({why})")))? * unit;
    if (least..=TIMES_OF_CELLS[1]).contains(&time) { Ok(time) } else { Err((value, allowed.to_owned())) }
}

/// Whether a value says no.
fn is_no(value: &Value<'_>) -> bool {
    [&b"no"[..], b"n", b"false", b"f"].iter().any(|no| value.text.eq_ignore_ascii_case(no))
}

/// The lifetime in a row of an embryo.
pub(crate) fn read_row<'r>(
    row: Row<'r>,
    columns: &Columns,
    embryo: &str,
    names: &Names,
) -> Result<Lifetime, Rejected<'r>> {
    let row = fitting(row)?;
    let at = |column: usize| Value::new(row, column);
    let cell = at(columns.cell);
    let cell = names.understood(embryo, &cell.written()).ok_or_else(|| (cell, names.unknown().to_owned()))?;
    let optional = |column: Option<TimeColumn>, least: f64, allowed: &str| {
        let given = column.filter(|(column, _)| !is_absent(row.text(*column)));
        given.map(|column| minutes(row, column, least, allowed)).transpose()
    };
    let is_censored =
        |value: &Value<'_>| !is_absent(value.text) && ![&b"0"[..], b"0.0"].contains(&value.text) && !is_no(value);
    if let Some(value) = columns.censored.map(at).filter(is_censored) {
        return Err((value, "censored: the cell was not seen to divide".to_owned()));
    }
    let mean = match columns.life {
        Life::Lifetime(column) => minutes(row, column, TIMES_OF_CELLS[0], "must be a time above 0")?,
        Life::Times(birth, division, mother) => {
            let is_unknown =
                |value: &Value<'_>| is_absent(value.text) || [&b"0"[..], b"-1", b"unknown"].contains(&value.text);
            if let Some(value) = mother.map(at).filter(is_unknown) {
                return Err((value, "no mother: when the cell was born was not seen".to_owned()));
            }
            let [born, divided] = [birth, division].map(|of| minutes(row, of, -TIMES_OF_CELLS[1], "must be a time"));
            let lifetime = divided? - born?;
            if lifetime < TIMES_OF_CELLS[0] {
                return Err((at(division.0), "must be a time after the birth".to_owned()));
            }
            lifetime
        }
    };
    let n = match columns.n.map(at) {
        None => 1,
        Some(value) => {
            let n = value.number().ok().filter(|n| (1.0..=1e9).contains(n) && n.fract() == 0.0);
            n.ok_or((value, "must be a number of embryos, at least 1".to_owned()))? as u64
        }
    };
    let sd = optional(columns.sd, 0.0, "must be a time of 0 or more, or empty")?;
    let birth = optional(columns.birth, -TIMES_OF_CELLS[1], "must be a time, or empty")?;
    let division = optional(columns.division, -TIMES_OF_CELLS[1], "must be a time, or empty")?;
    if let (Some(birth), Some(division), Some((column, _))) = (birth, division, columns.division)
        && (division - birth - mean).abs() > ROUNDED * mean.max(1.0)
    {
        let why = format!("not birth and lifetime together, {} min", rounded_number(birth + mean, 5));
        return Err((at(column), why));
    }
    let founder = names.founder(&cell).unwrap_or_default().to_owned();
    Ok(Lifetime { cell, founder, n, mean, sd, birth })
}
