//! Tables of profiles, and profiles in JSON.
//!
//! A table has the columns `z` and `r`: the distance from the axis at positions along it, from pole to pole, with r = 0 at both. The
//! unit is arbitrary, since the size of a shell follows from the cell. The pole at larger z is the posterior one, u = 0.

use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::fit::{Fitted, Moments, Unfit, fit};
use super::{Factor, MOST_TERMS, ShellProfile};
use furrow_input::table::{Table, malformed, split_unit, unit_word};
use furrow_input::{InputError, open_file};

/// Smallest number of rows of a table.
const FEWEST: usize = 9;

/// Largest number of rows of a table.
const MOST: usize = 20_000;

/// Largest allowed distance of a point from the profile, relative to its distance from the origin.
const FARTHEST: f64 = 0.02;

/// Largest deviation from 1 of the volume of a profile in JSON.
const VOLUME: f64 = 1e-6;

impl ShellProfile {
    /// Reads a table.
    ///
    /// # Errors
    /// Names file, line, field, value and the allowed values for rows that cannot be read, columns in two units, a negative r, a profile
    /// that is not closed or not star-shaped about a point on its axis, and too few points.
    pub fn read(path: &Path) -> Result<ShellProfile, InputError> {
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        ShellProfile::from_table(open_file(path)?, &name, &path.display().to_string())
    }

    /// Reads the table of a profile with a name; `file` is its name in errors.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn from_table(table: impl Read, name: &str, file: &str) -> Result<ShellProfile, InputError> {
        let mut rows = rows(table, file)?;
        if rows.len() > 1 && rows[0].z < rows[1].z {
            rows.reverse();
        }
        check(&rows, file)?;
        let points: Vec<[f64; 2]> = rows.iter().map(|row| [row.z, row.r]).collect();
        let Fitted { aspect, factor, error, worst } = fit(&points).map_err(|unfit| unfit.of_file(&rows, file))?;
        if error > FARTHEST {
            let why = format!(
                "r = {} lies {:.1} % off the smooth profile that fits best; at most {:.0} % is allowed: give more points, or smooth them",
                rows[worst].r,
                100.0 * error,
                100.0 * FARTHEST
            );
            return Err(malformed(file, rows[worst].line, why));
        }
        Ok(ShellProfile { name: name.to_owned(), aspect, error, factor })
    }
}

struct Row {
    line: usize,
    z: f64,
    r: f64,
}

fn rows(table: impl Read, file: &str) -> Result<Vec<Row>, InputError> {
    let mut table = Table::open(table, file)?;
    let (line, header) = table.header(|_| false)?;
    let column = |name: &str| {
        let named = |heading: &&String| split_unit(heading).0.eq_ignore_ascii_case(name);
        let (at, heading) = header.iter().enumerate().find(|(_, heading)| named(heading)).ok_or_else(|| {
            let known = furrow_input::table::columns_listed(&header);
            malformed(
                file,
                line,
                format!("no column {name:?}: a profile has the columns z and r; this table has {known}"),
            )
        })?;
        Ok((at, split_unit(heading).1.map(unit_word)))
    };
    let ((z, unit_z), (r, unit_r)) = (column("z")?, column("r")?);
    if unit_z != unit_r {
        let [z, r] = [unit_z, unit_r].map(|unit| unit.unwrap_or_else(|| "none".to_owned()));
        return Err(malformed(file, line, format!("z and r must have one unit; z has {z}, r has {r}")));
    }
    let mut rows = Vec::new();
    while let Some(row) = table.next_row()? {
        let line = row.line as usize;
        if rows.len() == MOST {
            return Err(malformed(file, line, format!("a profile has at most {MOST} rows")));
        }
        let number = |column: usize| {
            let read = row.number(column);
            read.map_err(|why| malformed(file, line, format!("{}: {why}", row.name(column))))
        };
        rows.push(Row { line, z: number(z)?, r: number(r)? });
    }
    Ok(rows)
}

/// Checks rows in the order of decreasing z.
fn check(rows: &[Row], file: &str) -> Result<(), InputError> {
    let last_line = rows.iter().map(|row| row.line).max().unwrap_or(1);
    if rows.len() < FEWEST {
        return Err(malformed(
            file,
            last_line,
            format!("the profile has {} rows; at least {FEWEST} are needed", rows.len()),
        ));
    }
    if let Some(Row { line, r, .. }) = rows.iter().find(|row| row.r < 0.0) {
        return Err(malformed(file, *line, format!("r = {r}: a distance from the axis is 0 or above")));
    }
    let widest = rows.iter().map(|row| row.r).fold(0.0, f64::max);
    for Row { line, r, z } in [&rows[0], &rows[rows.len() - 1]] {
        if *r > 1e-6 * widest || widest == 0.0 {
            let why = format!("r = {r} at z = {z}: a shell is closed, with r = 0 in its first row and in its last");
            return Err(malformed(file, *line, why));
        }
    }
    for pair in rows.windows(2) {
        let (earlier, later) = if pair[0].line < pair[1].line { (&pair[0], &pair[1]) } else { (&pair[1], &pair[0]) };
        if pair[0].z <= pair[1].z {
            let why = format!(
                "z = {} after z = {}: z must rise from row to row, or fall from row to row",
                later.z, earlier.z
            );
            return Err(malformed(file, later.line, why));
        }
    }
    match rows[1..rows.len() - 1].iter().find(|row| row.r == 0.0) {
        Some(Row { line, .. }) => Err(malformed(file, *line, "r = 0: between the poles r is above 0")),
        None => Ok(()),
    }
}

impl Unfit {
    fn of_file(self, rows: &[Row], file: &str) -> InputError {
        match self {
            Unfit::Hidden { point, origin } => {
                let Row { line, z, r } = rows[point];
                let why = format!(
                    "z = {z}, r = {r} is hidden from z = {origin:.4} on the axis, the middle of the volume: the whole profile must be seen from there"
                );
                malformed(file, line, why)
            }
            Unfit::Gap { point, angle } => {
                let Row { line, z, .. } = rows[point];
                let why = format!(
                    "{angle:.0} degrees without a point before z = {z}, seen from the middle of the volume; 45 at most: give more points, near the poles too"
                );
                malformed(file, line, why)
            }
            Unfit::Open => malformed(file, rows[0].line, "no smooth closed profile fits these points"),
        }
    }
}

/// A profile as stored in JSON.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Document {
    name: String,
    aspect: f64,
    error: f64,
    series: Vec<f64>,
}

impl From<ShellProfile> for Document {
    fn from(ShellProfile { name, aspect, error, factor }: ShellProfile) -> Document {
        Document { name, aspect, error, series: factor.series().to_vec() }
    }
}

impl TryFrom<Document> for ShellProfile {
    type Error = String;

    fn try_from(Document { name, aspect, error, series }: Document) -> Result<ShellProfile, String> {
        let terms = series.len();
        if !(1..=MOST_TERMS).contains(&terms) {
            return Err(format!("shell_profile.series has {terms} numbers: must be from 1 to {MOST_TERMS}"));
        }
        let factor = Factor(Arc::from(series));
        let volume = Moments::of(&factor).map_or(f64::NAN, |moments| moments.volume);
        if volume.is_nan() || (volume - 1.0).abs() > VOLUME || !(aspect.is_finite() && aspect > 0.0) {
            return Err(format!("shell_profile.series has the volume {volume}: must be 1, with aspect above 0"));
        }
        Ok(ShellProfile { name, aspect, error, factor })
    }
}
