//! Tables with a division in every row.

use std::cell::Cell;
use std::io::Read;

use furrow_input::table::{Row, Table};
use furrow_input::{InputError, rounded_number};

use crate::events::{Division, GENERATION};
use crate::layout::{ChiColumns, DivisionColumns, Share, VolumeUnit, embryo_of_file, is_absent, unit_in};
use crate::names::Names;
use crate::several::Source;
use crate::volumes::{ReadOptions, Rejected, Value, Volumes, fitting, positive, positive_of};

/// The division of a row, with the name of its mother.
type Found<'r> = Result<(Value<'r>, Division), Rejected<'r>>;

impl Volumes {
    /// Adds the divisions of a table. `values` are used of each row, beside the mother's volume.
    pub(crate) fn read_divisions<R: Read>(
        &mut self,
        table: &mut Table<'_, R>,
        (file, class): (&str, &[usize]),
        values: u64,
        division: impl for<'r> Fn(Row<'r>) -> Found<'r>,
    ) -> Result<(), InputError> {
        while let Some(row) = table.next_row()? {
            let found = fitting(row).and_then(&division);
            let found = found.and_then(|found| self.with_clear_class(row, class, found));
            match found.and_then(|found| self.first_of_its_mother(file, found)) {
                Ok(division) => {
                    self.used += values + u64::from(division.mother_measured.is_some());
                    self.division_sources.push(Source { name: division.embryo.clone(), file: file.to_owned() });
                    self.divisions.push(division);
                }
                Err(rejected) => self.skip(file, &rejected),
            }
        }
        Ok(())
    }

    /// The division, unless its class has the name of another one: 1 and 12 join to 112, and so do 11 and 2.
    fn with_clear_class<'r>(
        &mut self,
        row: Row<'r>,
        class: &[usize],
        (mother, division): (Value<'r>, Division),
    ) -> Result<(Value<'r>, Division), Rejected<'r>> {
        let Some(first) = class.first() else { return Ok((mother, division)) };
        let parts: Vec<String> = class.iter().map(|column| Value::new(row, *column).written()).collect();
        let known = self.classes.entry(division.mother.clone()).or_insert_with(|| parts.clone());
        if *known == parts {
            return Ok((mother, division));
        }
        let why =
            format!("the class {} is {} here and {} before", division.mother, parts.join(" + "), known.join(" + "));
        Err((Value::new(row, *first), why))
    }

    /// The division, or the name of a mother that has divided before.
    fn first_of_its_mother<'r>(
        &mut self,
        file: &str,
        (mother, division): (Value<'r>, Division),
    ) -> Result<Division, Rejected<'r>> {
        let name = name_of(mother, &division.embryo, &self.names);
        let key = [file.to_owned(), division.embryo.clone(), division.group.clone(), name];
        let first = *self.division_lines.entry(key).or_insert(mother.line);
        if first == mother.line {
            return Ok(division);
        }
        let hint = if division.embryo == embryo_of_file(file) { " (a column embryo tells embryos apart)" } else { "" };
        Err((mother, format!("a second division of this cell; the first is on line {first}{hint}")))
    }
}

/// The name of a mother, as it is understood or else as it is written.
fn name_of(mother: Value<'_>, embryo: &str, names: &Names) -> String {
    names.understood(embryo, &mother.written()).unwrap_or_else(|| mother.written())
}

/// The class of a row's mother; `None` without columns of classes.
fn class_of<'r>(row: Row<'r>, columns: &[usize]) -> Result<Option<String>, Rejected<'r>> {
    let mut class = String::new();
    for value in columns.iter().map(|column| Value::new(row, *column)) {
        if value.text.is_empty() {
            return Err((value, "no class".to_owned()));
        }
        class += &value.written();
    }
    Ok((!columns.is_empty()).then_some(class))
}

/// The unit of a row's volumes: from the column of units, or else from the headings. `said` keeps the first row's.
fn unit_of_row<'r>(
    row: Row<'r>,
    columns: &DivisionColumns,
    said: &Cell<Option<VolumeUnit>>,
) -> Result<Option<VolumeUnit>, Rejected<'r>> {
    let Some(value) = columns.unit_column.map(|column| Value::new(row, column)) else { return Ok(columns.unit) };
    let unit =
        unit_in(value.text, columns.unit, said.get()).map_err(|allowed| (value, format!("must be {allowed}")))?;
    said.set(said.get().or(Some(unit)));
    Ok(Some(unit))
}

/// The division of a row with volumes.
pub(crate) fn division<'r>(
    row: Row<'r>,
    columns: &DivisionColumns,
    options: &ReadOptions,
    said: &Cell<Option<VolumeUnit>>,
) -> Found<'r> {
    let at = |column: usize| Value::new(row, column);
    let [larger, smaller] = columns.daughters.map(at);
    let volumes = [positive(larger)?, positive(smaller)?];
    if volumes[0] < volumes[1] {
        return Err((larger, "the larger daughter must not be the smaller one".to_owned()));
    }
    let own = columns.mother_volume.map(at).filter(|value| !is_absent(value.text)).map(positive).transpose()?;
    let (embryo, mother) = (at(columns.embryo).named("an embryo")?, at(columns.mother));
    mother.named("a mother")?;
    let generation = columns.generation.map(at).filter(|value| !is_absent(value.text));
    let whole = |value: Value<'r>| {
        let number = value.number().ok().filter(|number| number.fract() == 0.0 && (0.0..1e9).contains(number));
        number.ok_or_else(|| (value, "not a whole number of a generation".to_owned()))
    };
    let generation = generation.map(whole).transpose()?;
    let factor = options.factor(unit_of_row(row, columns, said)?, &embryo);
    let name = name_of(mother, &embryo, &options.names);
    let chi_signed = (volumes[0] - volumes[1]) / (volumes[0] + volumes[1]);
    for value in columns.chi.map(at).into_iter().filter(|value| !is_absent(value.text)) {
        agrees(value, value.number()?.abs(), chi_signed, "that of the volumes")?;
    }
    let group = columns.population.group_of(row, options.group.as_ref())?;
    columns.common.require(row, &embryo, &group)?;
    let division = Division {
        embryo,
        group,
        // Without classes mothers of different embryos share only their generation.
        mother: class_of(row, &columns.class)?
            .or(generation.map(|number| format!("{GENERATION}{number}")))
            .unwrap_or_else(|| name.clone()),
        daughters: ["larger", "smaller"].map(|which| format!("{name} {which}")),
        volumes: volumes.map(|volume| factor * volume),
        chi_signed,
        is_signed: false,
        mother_measured: own.map(|volume| factor * volume),
        chi_sd: None,
    };
    Ok((mother, division))
}

/// The name of the error of χ in messages.
const SD: &str = "a standard deviation of χ";

/// Two values of χ of one division may differ by rounding alone.
const ROUNDED: f64 = 0.011;

/// Requires that two columns agree on χ.
fn agrees<'r>(value: Value<'r>, chi: f64, other: f64, what: &str) -> Result<(), Rejected<'r>> {
    match (chi - other).abs() <= ROUNDED {
        true => Ok(()),
        false => Err((value, format!("this χ is not {what}, {}", rounded_number(other, 3)))),
    }
}

/// The division of a row of χ: daughters are fractions of their mother.
pub(crate) fn chi_division<'r>(row: Row<'r>, columns: &ChiColumns, (file, options): (&str, &ReadOptions)) -> Found<'r> {
    let at = |column: usize| Value::new(row, column);
    let (mother, value) = (at(columns.mother), at(columns.chi.column));
    mother.named("a mother")?;
    let chi = columns.chi.size * value.number()?;
    if chi.abs() >= 1.0 {
        return Err((value, "χ must be above -1 and below 1".to_owned()));
    }
    let given = |column: Option<usize>| column.map(at).filter(|value| !is_absent(value.text));
    if let Some((Share { size, .. }, value)) = columns.absolute.and_then(|of| Some((of, given(Some(of.column))?))) {
        agrees(value, size * value.number()?, chi.abs(), "the signed one without its sign")?;
    }
    let own = given(columns.mother_volume.map(|(column, _)| column)).map(positive).transpose()?;
    let embryo = match columns.embryo.map(at) {
        None => embryo_of_file(file),
        // Divisions of one embryo may have no name.
        Some(value) if is_absent(value.text) => String::new(),
        Some(value) => value.named("an embryo")?,
    };
    let size = columns.mother_volume.map_or(1.0, |(_, unit)| options.factor(Some(unit), &embryo));
    let name = name_of(mother, &embryo, &options.names);
    let group = columns.group.group_of(row, options.group.as_ref())?;
    columns.common.require(row, &embryo, &group)?;
    let sd = |Share { column, size }: Share| {
        given(Some(column)).map(|value| match size * positive_of(value, SD)? {
            sd if sd < 1.0 => Ok(sd),
            _ => Err((value, format!("{SD} must be below 1, as |χ| is"))),
        })
    };
    let division = Division {
        embryo,
        group,
        daughters: ["first", "second"].map(|which| format!("{name} {which}")),
        mother: class_of(row, &columns.class)?.unwrap_or(name),
        volumes: [0.5 * (1.0 + chi), 0.5 * (1.0 - chi)],
        chi_signed: chi,
        is_signed: columns.is_signed,
        mother_measured: own.map(|volume| size * volume),
        chi_sd: columns.chi_sd.and_then(sd).transpose()?,
    };
    Ok((mother, division))
}
