//! Tables with a division in every row.

use std::io::Read;

use furrow_input::InputError;
use furrow_input::table::Table;

use crate::cell_tables::factor;
use crate::events::{Division, GENERATION};
use crate::layout::{ChiColumns, DivisionColumns, Unit, embryo_of_file};
use crate::volumes::{ReadOptions, Rejected, Value, Volumes, fitting, positive};

impl Volumes {
    pub(crate) fn read_divisions<R: Read>(
        &mut self,
        table: &mut Table<'_, R>,
        file: &str,
        options: &ReadOptions,
        columns: &DivisionColumns,
    ) -> Result<Unit, InputError> {
        while let Some(row) = table.next_row()? {
            let found = fitting(row).and_then(|row| division(columns, |column| Value::new(row, column), options));
            match found.and_then(|found| self.first_of_its_mother(file, found)) {
                Ok(division) => {
                    self.used += 2 + u64::from(division.mother_measured.is_some());
                    self.divisions.push(division);
                }
                Err(rejected) => self.skip(file, &rejected),
            }
        }
        Ok(columns.unit.kind)
    }

    pub(crate) fn read_chi<R: Read>(
        &mut self,
        table: &mut Table<'_, R>,
        file: &str,
        options: &ReadOptions,
        columns: &ChiColumns,
    ) -> Result<Unit, InputError> {
        while let Some(row) = table.next_row()? {
            let at = |column: usize| Value::new(row, column);
            let found = fitting(row).and_then(|_| chi_division(columns, at, (file, options)));
            match found.and_then(|found| self.first_of_its_mother(file, found)) {
                Ok(division) => {
                    self.used += 1;
                    self.divisions.push(division);
                }
                Err(rejected) => self.skip(file, &rejected),
            }
        }
        Ok(Unit::OfMother)
    }

    /// The division, or the name of a mother that has divided before.
    fn first_of_its_mother<'r>(
        &mut self,
        file: &str,
        (mother, division): (Value<'r>, Division),
    ) -> Result<Division, Rejected<'r>> {
        let name = self.names.understood(&mother.written()).unwrap_or_else(|| mother.written());
        let key = (file.to_owned(), division.embryo.clone(), name);
        match self.division_lines.insert(key.clone(), mother.line) {
            None => Ok(division),
            Some(first) => {
                self.division_lines.insert(key, first);
                Err((mother, format!("a second division of this cell; the first is on line {first}")))
            }
        }
    }
}

/// The division of a row, with the name of its mother.
fn division<'r>(
    columns: &DivisionColumns,
    at: impl Fn(usize) -> Value<'r>,
    options: &ReadOptions,
) -> Result<(Value<'r>, Division), Rejected<'r>> {
    let [larger, smaller] = columns.daughters.map(&at);
    let volumes = [positive(larger)?, positive(smaller)?];
    if volumes[0] < volumes[1] {
        return Err((larger, "the larger daughter must not be the smaller one".to_owned()));
    }
    let own = columns.mother_volume.map(&at).filter(|value| !value.text.is_empty()).map(positive).transpose()?;
    let (embryo, mother) = (at(columns.embryo), at(columns.mother));
    for (value, what) in [(embryo, "no name of an embryo"), (mother, "no name of a mother")] {
        if value.text.is_empty() {
            return Err((value, what.to_owned()));
        }
    }
    let generation = columns.generation.map(&at).filter(|value| !value.text.is_empty());
    if let Some(value) = generation.filter(|value| value.written().parse::<u32>().is_err()) {
        return Err((value, "not a whole number of a generation".to_owned()));
    }
    let factor = factor(Some(columns.unit), options);
    let name = options.names.understood(&mother.written()).unwrap_or_else(|| mother.written());
    let group = columns.population.map(|column| at(column).written()).unwrap_or_default();
    let division = Division {
        embryo: embryo.written(),
        group: options.group.clone().filter(|_| group.is_empty()).unwrap_or(group),
        // Mothers of different embryos share only their generation.
        mother: generation.map_or_else(|| name.clone(), |number| format!("{GENERATION}{}", number.written())),
        daughters: ["larger", "smaller"].map(|which| format!("{name} {which}")),
        volumes: volumes.map(|volume| factor * volume),
        chi_signed: (volumes[0] - volumes[1]) / (volumes[0] + volumes[1]),
        mother_measured: own.map(|volume| factor * volume),
    };
    Ok((mother, division))
}

/// The division of a row of χ: daughters are fractions of their mother.
fn chi_division<'r>(
    columns: &ChiColumns,
    at: impl Fn(usize) -> Value<'r>,
    (file, options): (&str, &ReadOptions),
) -> Result<(Value<'r>, Division), Rejected<'r>> {
    let (mother, value) = (at(columns.mother), at(columns.chi));
    if mother.text.is_empty() {
        return Err((mother, "no name of a mother".to_owned()));
    }
    let chi = value.number()?;
    if chi.abs() >= 1.0 {
        return Err((value, "χ must be above -1 and below 1".to_owned()));
    }
    let group = columns.group.map(|column| at(column).written()).unwrap_or_default();
    let name = options.names.understood(&mother.written()).unwrap_or_else(|| mother.written());
    let division = Division {
        embryo: columns.embryo.map_or_else(|| embryo_of_file(file), |column| at(column).written()),
        group: options.group.clone().filter(|_| group.is_empty()).unwrap_or(group),
        daughters: ["first", "second"].map(|which| format!("{name} {which}")),
        mother: name,
        volumes: [0.5 * (1.0 + chi), 0.5 * (1.0 - chi)],
        chi_signed: chi,
        mother_measured: None,
    };
    Ok((mother, division))
}
