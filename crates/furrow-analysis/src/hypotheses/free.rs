//! Hypotheses, and the numbers that are fitted.

use std::path::Path;

use furrow_cell::{Cell, CueError, Parameter};
use furrow_input::{InputError, did_you_mean, parse_document, read_text, shown};
use serde::Deserialize;

use crate::constants::{ConstantKind, EMBRYO, GROWTH, founders_of};
use furrow_lineage::{Lineage, named_cue};

use crate::fit::unknowns::{Unknown, unknowns};
use crate::solve::default_range;

/// A number that is fitted: a parameter, of all cells or of a class.
#[derive(Clone, Debug, PartialEq)]
pub struct Free {
    kind: ConstantKind,
    /// The class and its founders.
    class: Option<(String, Vec<usize>)>,
    /// Between which values it is searched; `None` for the usual range.
    range: Option<[f64; 2]>,
    /// Whether it differs between embryos.
    by_embryo: bool,
}

/// A hypothesis as it is asked for.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Named {
    /// Its name: the one before `=`, else the text of its cue.
    pub name: String,
    /// The cue, without the name.
    pub cue: String,
    /// Its free numbers; `None` for those that all hypotheses share.
    #[serde(default)]
    pub free: Option<Vec<String>>,
}

/// A file of hypotheses.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Hypotheses")]
struct File {
    hypotheses: Vec<Named>,
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
    /// The one of them that differs between embryos, in the posterior.
    pub(crate) by_embryo: Option<usize>,
}

/// Between which values growth is searched.
const USUAL_GROWTH: [f64; 2] = [0.5, 2.0];

/// Written for an empty list, and for no cue.
pub(super) const NOTHING: &str = "none";

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
        let Ok(kind) = name.parse::<ConstantKind>() else {
            let listed = Parameter::ALL.into_iter().map(Parameter::name).chain([GROWTH]);
            let all: Vec<&str> = Parameter::OF_CUES.into_iter().chain(listed).collect();
            let nearest = did_you_mean(name, all.iter().copied());
            return refused(name, format!("none, or a parameter with or without @CLASS: {}{nearest}", all.join(", ")));
        };
        if let Some(class) = class.filter(|_| kind == ConstantKind::Parameter(Parameter::R0)) {
            return refused(class, "left out: r0 is the first cell's, and all other radii change with it".to_owned());
        }
        let by_embryo = class == Some(EMBRYO);
        let class = class.filter(|_| !by_embryo).map(|class| class_of(class, lineage, source)).transpose()?;
        let Some(written) = range else { return Ok(Free { kind, class, range: None, by_embryo }) };
        let ends =
            written.split_once("..").and_then(|(from, to)| Some([from.trim().parse().ok()?, to.trim().parse().ok()?]));
        let Some([from, to]) = ends.filter(|[from, to]: &[f64; 2]| from < to) else {
            return refused(written, "a range FROM..TO with FROM below TO, as 0.4..0.9".to_owned());
        };
        match [from, to].into_iter().find_map(|end| kind.validate(end).err()) {
            Some(allowed) => refused(written, format!("a range of {kind} with {allowed}")),
            None => Ok(Free { kind, class, range: Some([from, to]), by_embryo }),
        }
    }

    /// Reads a list of free numbers; `none` is the empty list.
    ///
    /// # Errors
    /// As [`Free::read`], and for two entries with the same parameter and class, or a class in which every founder has a smaller class.
    pub fn list(texts: &[String], lineage: &Lineage, source: &str) -> Result<Vec<Free>, InputError> {
        if let [only] = texts
            && only.trim() == NOTHING
        {
            return Ok(Vec::new());
        }
        let all: Vec<Free> = texts.iter().map(|text| Free::read(text, lineage, source)).collect::<Result<_, _>>()?;
        if let Some((k, _)) = all.iter().enumerate().filter(|(_, free)| free.by_embryo).nth(1) {
            return Err(refused(source, texts[k].trim(), "one number that differs between embryos".to_owned()));
        }
        for (k, free) in all.iter().enumerate() {
            if all[..k].iter().any(|other| other.kind == free.kind && other.is_of_the_cells_of(free)) {
                let is_range =
                    free.by_embryo || all[..k].iter().any(|other| other.by_embryo && other.kind == free.kind);
                let allowed = match is_range {
                    true => format!(
                        "each parameter once: {0}@{EMBRYO} has the common value too, in the range of {0}@{EMBRYO}=FROM..TO",
                        free.kind
                    ),
                    false => "each parameter once for a class of cells".to_owned(),
                };
                return Err(refused(source, texts[k].trim(), allowed));
            }
            if (0..lineage.founders.len()).all(|founder| !free.is_of(founder) || free.except(&all).contains(&founder)) {
                let allowed = "a class with cells that have no number of their own";
                return Err(refused(source, texts[k].trim(), allowed.to_owned()));
            }
        }
        Ok(all)
    }

    /// Refuses constants that the law of a cell does not have; errors name the option or the file `source`.
    fn check_law(all: &[Free], cell: &Cell, source: &str) -> Result<(), InputError> {
        for Free { kind, .. } in all {
            if let Some(parameter @ Parameter::Law(name)) = kind.parameter()
                && !parameter.is_of(cell)
            {
                return Err(refused(source, name.whole(), Parameter::allowed_of_law(cell, name)));
            }
        }
        Ok(())
    }

    fn is_of(&self, founder: usize) -> bool {
        self.class.as_ref().is_none_or(|(_, founders)| founders.contains(&founder))
    }

    fn is_of_the_cells_of(&self, other: &Free) -> bool {
        match (&self.class, &other.class) {
            (Some((_, a)), Some((_, b))) => a == b,
            (a, b) => a.is_none() && b.is_none(),
        }
    }

    /// The founders of smaller classes, which replace this number by a separate one.
    fn except(&self, all: &[Free]) -> Vec<usize> {
        let is_part = |founders: &Vec<usize>| {
            self.class.as_ref().is_none_or(|(_, own)| founders.len() < own.len() && own.contains(&founders[0]))
        };
        let parts = all.iter().filter(|other| other.kind == self.kind).filter_map(|other| other.class.as_ref());
        parts.filter(|(_, founders)| is_part(founders)).flat_map(|(_, founders)| founders.iter().copied()).collect()
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
        Ok(Named { name: name.unwrap_or(cue).to_owned(), cue: cue.to_owned(), free: None })
    }

    /// Reads several `CUE` or `NAME=CUE`; errors name the option `source`.
    ///
    /// # Errors
    /// As [`named_cue`].
    pub fn list(texts: &[String], source: &str) -> Result<Vec<Named>, InputError> {
        texts.iter().map(|text| Named::read(text).map_err(|error| of_cue(error, source, "cue"))).collect()
    }

    /// Reads a file, `Hypotheses(hypotheses: [(name: "a", cue: "germline", free: ["epsilon"])])`.
    ///
    /// # Errors
    /// A file that cannot be read or has no hypothesis, and a hypothesis without a name.
    pub fn file(file: &Path) -> Result<Vec<Named>, InputError> {
        let source = file.display().to_string();
        let File { hypotheses } = parse_document(&read_text(file)?, &source, "a file of hypotheses", "Hypotheses")?;
        InputError::require(!hypotheses.is_empty(), &source, "hypotheses", "[]", "at least one hypothesis")?;
        for (k, Named { name, .. }) in hypotheses.iter().enumerate() {
            let (field, allowed) = (format!("hypotheses[{k}].name"), "a name");
            InputError::require(!name.trim().is_empty(), &source, field, shown(name), allowed)?;
        }
        Ok(hypotheses)
    }
}

/// The error for a cue.
fn of_cue(error: CueError, source: &str, field: &str) -> InputError {
    let field = if error.field == "cue" { field.to_owned() } else { error.field };
    InputError::not_allowed(source, field, error.value, error.allowed)
}

impl Hypothesis {
    /// The hypotheses that are asked for. Those without free numbers of their own have these, by default all numbers of each cue. `cell`
    /// has the parameters of the run; errors name the options of `sources`, of cues and of free numbers, or a file.
    ///
    /// # Errors
    /// A cue that cannot be read, two hypotheses of one name, a free number that no hypothesis has, and a constant that the law lacks.
    pub fn all(
        asked: &[Named],
        free: Option<&[Free]>,
        lineage: &Lineage,
        cell: &Cell,
        sources: [&str; 2],
    ) -> Result<Vec<Hypothesis>, InputError> {
        let refused = |error: CueError| of_cue(error, sources[0], "cue");
        let mut all: Vec<Hypothesis> = Vec::new();
        Free::check_law(free.unwrap_or_default(), cell, sources[1])?;
        for Named { name, cue, free: own } in asked {
            let (is_new, allowed) = (all.iter().all(|other| other.name != *name), "names that differ: write NAME=CUE");
            InputError::require(is_new, sources[0], "cue", format!("{name:?}"), allowed)?;
            let template = lineage.parse_cue(cue).map_err(refused)?;
            let carrying = lineage.carrying(cue, cell).map_err(refused)?;
            let own = own.as_ref().map(|texts| Free::list(texts, lineage, sources[0])).transpose()?;
            Free::check_law(own.as_deref().unwrap_or_default(), cell, sources[0])?;
            let r0 = lineage.given_r0(lineage.first()).unwrap_or(cell.r0);
            let cell = Cell { r0, ..cell.clone() }.with_cue(template.clone());
            let unknowns = free_of(own.as_deref().or(free), &cell);
            for Free { kind, .. } in own.iter().flatten() {
                let has = unknowns.iter().any(|unknown| unknown.kind == *kind);
                let allowed = format!("a number that the hypothesis {name} has");
                InputError::require(has, sources[0], "free", format!("\"{kind}\""), allowed)?;
            }
            let differs = own.as_deref().or(free).into_iter().flatten().find(|free| free.by_embryo);
            let by_embryo =
                differs.and_then(|free| unknowns.iter().position(|u| u.kind == free.kind && u.founders.is_none()));
            all.push(Hypothesis { name: name.clone(), lineage: carrying, template, unknowns, by_embryo });
        }
        for Free { kind, .. } in free.into_iter().flatten() {
            let used = all.iter().any(|hypothesis| hypothesis.unknowns.iter().any(|u| u.kind == *kind));
            let allowed = "a number that at least one of the hypotheses has";
            InputError::require(used, sources[1], "free", format!("\"{kind}\""), allowed)?;
        }
        Ok(all)
    }

    /// Whether a number differs between embryos.
    pub fn is_by_embryo(&self) -> bool {
        self.by_embryo.is_some()
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
    let of = |one: &Free| {
        let Free { kind, class, range, .. } = one;
        let usual = of_cue.iter().find(|unknown| unknown.kind == *kind);
        let unknown = match (usual, range) {
            (Some(usual), None) => usual.clone(),
            (_, range) => {
                let usual = usual_range(*kind, cell)?;
                let (limits, logarithmic) = (range.unwrap_or(usual), *kind == ConstantKind::Growth && range.is_none());
                Unknown { kind: *kind, limits, logarithmic, sign: 1.0, founders: None, except: Vec::new() }
            }
        };
        Some(Unknown { founders: class.clone(), except: one.except(free), ..unknown })
    };
    free.iter().filter_map(of).collect()
}

/// The usual range of a parameter or of growth; `None` for a number of another cue.
fn usual_range(kind: ConstantKind, cell: &Cell) -> Option<[f64; 2]> {
    match kind {
        ConstantKind::Growth => Some(USUAL_GROWTH),
        // The lineage says about how large its cells are.
        ConstantKind::Parameter(Parameter::R0) => Some([0.5, 2.0].map(|factor| factor * cell.r0)),
        ConstantKind::Parameter(parameter) => {
            let is_missing = parameter.is_of_cue() && !parameter.is_of(cell);
            (!is_missing).then(|| default_range(parameter, cell))
        }
    }
}
