//! Hypotheses, and the numbers that are fitted.

use furrow_cell::{Cell, CueError, Parameter};
use furrow_input::{InputError, did_you_mean};

use crate::constants::founders_of;
use furrow_lineage::{Lineage, named_cue};

use crate::fit::unknowns::{Unknown, unknowns};
use crate::solve::default_range;

/// A number that is fitted: a parameter, of all cells or of a class.
#[derive(Clone, Debug, PartialEq)]
pub struct Free {
    parameter: Parameter,
    /// The class and its founders.
    class: Option<(String, Vec<usize>)>,
    /// Between which values it is searched; `None` for the usual range.
    range: Option<[f64; 2]>,
}

/// A hypothesis as it is named.
#[derive(Clone, Debug, PartialEq)]
pub struct Named {
    /// Its name: the one before `=`, else the text of its cue.
    pub name: String,
    /// The cue, without the name.
    pub cue: String,
}

/// A hypothesis: a cue in place of the lineage's own, and numbers that are fitted.
#[derive(Clone, Debug)]
pub struct Hypothesis {
    /// Its name.
    pub name: String,
    /// The lineage with its cue.
    pub(crate) lineage: Lineage,
    /// Its cue, where the fit starts.
    pub(crate) template: furrow_cell::Cue,
    pub(crate) unknowns: Vec<Unknown>,
}

/// Written for an empty list.
const NOTHING: &str = "none";

impl Free {
    /// Reads `PARAMETER`, with `@CLASS` for a class of cells, and with `=FROM..TO` for another range than the usual one; errors name the
    /// option `source`.
    ///
    /// # Errors
    /// A name that is no parameter, one that cannot be fitted, an unknown class, and a range with values that are not allowed.
    pub fn read(text: &str, lineage: &Lineage, source: &str) -> Result<Free, InputError> {
        let refused = |value: &str, allowed: String| Err(refused(source, value, allowed));
        let (text, range) = text.split_once('=').map_or((text, None), |(text, range)| (text, Some(range.trim())));
        let (name, class) = text.split_once('@').map_or((text, None), |(name, class)| (name, Some(class.trim())));
        let name = name.trim();
        let Some(parameter) = name.parse().ok().filter(|parameter| *parameter != Parameter::R0) else {
            let listed =
                Parameter::ALL.into_iter().filter(|parameter| *parameter != Parameter::R0).map(Parameter::name);
            let all: Vec<&str> = Parameter::OF_CUES.into_iter().chain(listed).collect();
            let nearest = did_you_mean(name, all.iter().copied());
            return refused(name, format!("none, or a parameter with or without @CLASS: {}{nearest}", all.join(", ")));
        };
        let class = class.map(|class| class_of(class, lineage, source)).transpose()?;
        let Some(written) = range else { return Ok(Free { parameter, class, range: None }) };
        let ends =
            written.split_once("..").and_then(|(from, to)| Some([from.trim().parse().ok()?, to.trim().parse().ok()?]));
        let Some([from, to]) = ends.filter(|[from, to]: &[f64; 2]| from < to) else {
            return refused(written, "a range FROM..TO with FROM below TO, as 0.4..0.9".to_owned());
        };
        match [from, to].into_iter().find_map(|end| parameter.validate(end).err()) {
            Some(allowed) => refused(written, format!("a range of {parameter} with {allowed}")),
            None => Ok(Free { parameter, class, range: Some([from, to]) }),
        }
    }

    /// Reads a list of free numbers; `none` is the empty list.
    ///
    /// # Errors
    /// As [`Free::read`], and a number that two entries free in the same cell.
    pub fn list(texts: &[String], lineage: &Lineage, source: &str) -> Result<Vec<Free>, InputError> {
        if let [only] = texts
            && only.trim() == NOTHING
        {
            return Ok(Vec::new());
        }
        let all: Vec<Free> = texts.iter().map(|text| Free::read(text, lineage, source)).collect::<Result<_, _>>()?;
        for (k, free) in all.iter().enumerate() {
            if all[..k].iter().any(|other| other.parameter == free.parameter && other.meets(free)) {
                let allowed = "each parameter once for a cell: its classes must not overlap";
                return Err(refused(source, texts[k].trim(), allowed.to_owned()));
            }
        }
        Ok(all)
    }

    fn meets(&self, other: &Free) -> bool {
        match (&self.class, &other.class) {
            (Some((_, a)), Some((_, b))) => a.iter().any(|founder| b.contains(founder)),
            _ => true,
        }
    }
}

/// The error for a free number of an option.
fn refused(source: &str, value: &str, allowed: String) -> InputError {
    InputError::not_allowed(source, "free", format!("{value:?}"), allowed)
}

/// A class of cells and its founders.
fn class_of(class: &str, lineage: &Lineage, source: &str) -> Result<(String, Vec<usize>), InputError> {
    Ok((class.to_owned(), founders_of(class, lineage, source, "free")?))
}

impl Named {
    /// Reads `CUE` or `NAME=CUE`.
    ///
    /// # Errors
    /// As [`named_cue`].
    pub fn read(text: &str) -> Result<Named, CueError> {
        let (name, cue) = named_cue(text)?;
        Ok(Named { name: name.unwrap_or(cue).to_owned(), cue: cue.to_owned() })
    }
}

impl Hypothesis {
    /// The hypotheses of some cues, `CUE` or `NAME=CUE`, with these numbers free, by default all numbers of each cue. `cell` has the
    /// parameters of the run; errors name the options of `sources`, of cues and of free numbers.
    ///
    /// # Errors
    /// A cue that cannot be read, two of one name, and a free number that no hypothesis has.
    pub fn all(
        cues: &[String],
        free: Option<&[Free]>,
        lineage: &Lineage,
        cell: &Cell,
        sources: [&str; 2],
    ) -> Result<Vec<Hypothesis>, InputError> {
        let refused = |error: CueError| InputError::not_allowed(sources[0], error.field, error.value, error.allowed);
        let mut all: Vec<Hypothesis> = Vec::new();
        for text in cues {
            let Named { name, cue } = Named::read(text).map_err(refused)?;
            if all.iter().any(|other| other.name == name) {
                let allowed = "names that differ: write NAME=CUE";
                return Err(InputError::not_allowed(sources[0], "cue", format!("{name:?}"), allowed));
            }
            let template = lineage.parse_cue(&cue).map_err(refused)?;
            let lineage = lineage.carrying(text).map_err(refused)?;
            let unknowns = free_of(free, &cell.clone().with_cue(template.clone()));
            all.push(Hypothesis { name, lineage, template, unknowns });
        }
        for Free { parameter, .. } in free.into_iter().flatten() {
            let used = all.iter().any(|hypothesis| hypothesis.unknowns.iter().any(|u| u.parameter == *parameter));
            let allowed = "a number that at least one of the hypotheses has";
            InputError::require(used, sources[1], "free", format!("\"{parameter}\""), allowed)?;
        }
        Ok(all)
    }

    /// How many numbers are fitted.
    pub fn free(&self) -> usize {
        self.unknowns.len()
    }
}

/// The unknowns of a cell with a cue: all numbers of the cue, or those that are free and that it has.
fn free_of(free: Option<&[Free]>, cell: &Cell) -> Vec<Unknown> {
    let of_cue = unknowns(&cell.cue);
    let Some(free) = free else { return of_cue };
    let of = |Free { parameter, class, range }: &Free| {
        let usual = of_cue.iter().find(|unknown| unknown.parameter == *parameter);
        let unknown = match (usual, range) {
            (None, _) if parameter.is_of_cue() => return None,
            (Some(usual), None) => usual.clone(),
            (_, range) => {
                let limits = range.unwrap_or_else(|| default_range(*parameter, cell));
                Unknown { parameter: *parameter, limits, logarithmic: false, sign: 1.0, founders: None }
            }
        };
        Some(Unknown { founders: class.clone(), ..unknown })
    };
    free.iter().filter_map(of).collect()
}
