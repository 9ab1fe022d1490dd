//! What is known of a cell, as columns of a table: one list for all formats.

use std::borrow::Cow;

use crate::lineage::{CellId, Place, Side, Tree};

/// What kind of values a column has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Words.
    Text,
    /// Whole numbers.
    Count,
    /// Numbers.
    Number,
}

/// One value of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Value<'a> {
    /// A word, or a sentence.
    Text(Cow<'a, str>),
    /// A whole number.
    Count(u32),
    /// A number.
    Number(f64),
}

impl std::fmt::Display for Value<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Value::Text(text) => f.write_str(text),
            Value::Count(count) => write!(f, "{count}"),
            Value::Number(number) => write!(f, "{number}"),
        }
    }
}

/// Something that is known of cells. The name of a cell is no column: every format has a place of its own for it.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Name of the column.
    pub name: &'static str,
    /// What kind of values it has.
    pub kind: Kind,
    /// Whether it stands in the comments of Newick and Nexus too. What the brackets tell already does not, nor do sentences.
    pub note: bool,
    /// Its value for a cell, if there is one.
    pub of: for<'a> fn(&'a Tree, CellId) -> Option<Value<'a>>,
}

/// All columns, in the order in which they are written.
pub const COLUMNS: [Column; 17] = [
    Column { name: "mother", kind: Kind::Text, note: false, of: |tree, id| text(&tree.cell(tree.mother(id)?).name) },
    Column { name: "daughter", kind: Kind::Text, note: false, of: daughter },
    Column { name: "founder", kind: Kind::Text, note: true, of: |tree, id| text(tree.founder_name(id)) },
    Column { name: "generation", kind: Kind::Count, note: true, of: |tree, id| count(tree.cell(id).generation) },
    Column { name: "r0", kind: Kind::Number, note: true, of: |tree, id| number(tree.cell(id).r0) },
    Column {
        name: "volume_fraction",
        kind: Kind::Number,
        note: true,
        of: |tree, id| number(tree.cell(id).volume_fraction),
    },
    Column { name: "cue", kind: Kind::Text, note: true, of: |tree, id| text(cue_name(tree, id)) },
    Column {
        name: "cue_terms",
        kind: Kind::Text,
        note: false,
        of: |tree, id| Some(Value::Text(tree.cell(id).cue.to_string().into())),
    },
    Column { name: "outcome", kind: Kind::Text, note: true, of: |tree, id| text(tree.cell(id).fate.outcome()?.name()) },
    Column { name: "chi", kind: Kind::Number, note: true, of: |tree, id| number(tree.cell(id).fate.chi()?) },
    Column {
        name: "chi_signed",
        kind: Kind::Number,
        note: true,
        of: |tree, id| number(tree.cell(id).fate.division.as_ref()?.chi_signed?),
    },
    Column {
        name: "u_furrow",
        kind: Kind::Number,
        note: true,
        of: |tree, id| number(tree.cell(id).fate.division.as_ref()?.u_furrow?),
    },
    Column { name: "t_end", kind: Kind::Number, note: true, of: |tree, id| number(tree.cell(id).fate.t_end()?) },
    Column {
        name: "slow_growth_rate",
        kind: Kind::Number,
        note: true,
        of: |tree, id| number(tree.cell(id).fate.division.as_ref()?.slow_growth_rate?),
    },
    Column {
        name: "ended",
        kind: Kind::Text,
        note: true,
        of: |tree, id| text(tree.cell(id).fate.ended.as_ref()?.name()),
    },
    Column { name: "ended_why", kind: Kind::Text, note: false, of: ended_why },
    Column { name: "birth_chi", kind: Kind::Number, note: false, of: birth_chi },
];

fn text(text: &str) -> Option<Value<'_>> {
    Some(Value::Text(Cow::Borrowed(text)))
}

fn count<'a>(count: u32) -> Option<Value<'a>> {
    Some(Value::Count(count))
}

fn number<'a>(number: f64) -> Option<Value<'a>> {
    Some(Value::Number(number))
}

fn daughter(tree: &Tree, id: CellId) -> Option<Value<'_>> {
    text(match tree.side(id)? {
        Side::Anterior => "anterior",
        Side::Posterior => "posterior",
    })
}

/// The name that the lineage gives a cell's cue.
fn cue_name(tree: &Tree, id: CellId) -> &str {
    let cell = tree.cell(id);
    let born = tree.founder_cell(cell.founder).map_or(cell.generation, |born| tree.cell(born).generation);
    let round = cell.generation.saturating_sub(born);
    tree.lineage.cue_name_at(Place { founder: cell.founder, round, generation: cell.generation, r0: cell.r0 })
}

/// Why a cell has no daughters, in one line: what a file says of an undecided cell may hold anything.
fn ended_why(tree: &Tree, id: CellId) -> Option<Value<'_>> {
    let why = tree.cell(id).fate.ended.as_ref()?.to_string();
    Some(Value::Text(why.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()))
}

/// χ of the division that a cell was born from.
fn birth_chi(tree: &Tree, id: CellId) -> Option<Value<'_>> {
    number(tree.cell(tree.mother(id)?).fate.chi()?)
}
