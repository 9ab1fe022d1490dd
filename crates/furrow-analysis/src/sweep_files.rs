//! The files of a sweep: its table and its definition. Merges the files of shards.

use std::fs::File;
use std::io::{BufRead, BufReader};

use crate::table::{csv_text, json_lines, read_line};
use crate::{Axis, Journal, Kind, Row, Shard, Sweep};
use furrow_formats::files::{FileSet, WriteError};
use furrow_formats::provenance::Provenance;
use furrow_input::{InputError, listed};
use furrow_lineage::batch::{Quantisation, SOLVER_VERSION};
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Name of the format.
const SCHEMA: &str = "furrow.sweep";

/// Version of the format; it is raised when a field changes its meaning or goes.
const SCHEMA_VERSION: u32 = 1;

const CSV: &str = "results.csv";
const LINES: &str = "results.jsonl";
const HEAD: &str = "sweep.json";

/// The files of a sweep, in the order they are written: where the last exists, all do.
pub const SWEEP_FILES: [&str; 3] = [CSV, LINES, HEAD];

#[derive(Clone, Copy, Serialize, serde::Deserialize)]
struct HeadShard {
    #[serde(flatten)]
    shard: Shard,
    rows: usize,
}

/// A table and its definition.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepTable {
    head: Value,
    columns: Vec<String>,
    /// The rows, in the order of the points.
    pub rows: Vec<Row>,
}

impl SweepTable {
    /// The table of a sweep, or of a part of it. Its definition has exactly the inputs that the results depend on.
    pub fn new(sweep: &Sweep, quantisation: Quantisation, shard: Option<Shard>, rows: Vec<Row>) -> SweepTable {
        let axis = |axis: &Axis| {
            let mut head = json!({ "parameter": axis.name, "values": axis.values });
            if !axis.cues.is_empty() {
                let cues = axis.values.iter().zip(&axis.cues).map(|(v, cue)| (v.text().into_owned(), cue.to_string()));
                head["cues"] = json!(cues.collect::<BTreeMap<_, _>>());
            }
            head["sampled"] = axis.sampled.into();
            head
        };
        let columns = sweep.columns();
        let mut head = json!({
            "schema": SCHEMA,
            "schema_version": SCHEMA_VERSION,
            "provenance": Provenance::current(),
            // Version of the solver of divisions.
            "solver": SOLVER_VERSION,
            "kind": sweep.kind,
            // Values of parameters without an axis.
            "cell": sweep.settings.cell,
            "numerics": sweep.settings.numerics,
            // The default cue; null keeps a tree's own cues.
            "cue": sweep.cue.as_ref().map(ToString::to_string),
            "axes": sweep.axes.0.iter().map(axis).collect::<Vec<_>>(),
            "replicates": sweep.replicates,
            "seed": sweep.seed,
            // Relative step to which R0 is rounded.
            "r0_step": quantisation.relative_step(),
            "lineage": (sweep.kind == Kind::Tree).then_some(&sweep.lineage),
            "columns": columns,
            "points": sweep.points(),
        });
        if let Some(shard) = shard {
            head["shard"] = json!(HeadShard { shard, rows: rows.len() });
        }
        SweepTable { head, columns, rows }
    }

    /// Opens the journal of the sweep, or of this part of it, in the folder of its files.
    ///
    /// # Errors
    /// [`WriteError`].
    pub fn open_journal(self, folder: &Path) -> Result<Journal, WriteError> {
        Journal::open(folder, &self.head, self.columns)
    }

    /// Writes the files into a folder. Files of another sweep there are overwritten.
    ///
    /// # Errors
    /// [`WriteError`].
    pub fn write(&self, folder: &Path) -> Result<(), WriteError> {
        let mut files = FileSet::new(folder);
        files.stage(CSV, csv_text(&self.columns, &self.rows).as_bytes())?;
        files.stage(LINES, json_lines(&self.columns, &self.rows).as_bytes())?;
        files.stage(HEAD, format!("{:#}\n", self.head).as_bytes())?;
        files.commit()
    }

    /// Reads the files of a folder.
    ///
    /// # Errors
    /// Names the file and the error in it.
    fn read(folder: &Path) -> Result<SweepTable, InputError> {
        let head = read_head(folder)?;
        let file = folder.join(LINES);
        let name = file.display().to_string();
        let unreadable =
            |error: std::io::Error| InputError::Unreadable { file: name.clone(), reason: error.to_string() };
        let columns: Vec<String> = serde_json::from_value(head["columns"].clone())
            .map_err(|_| not_ours(&folder.join(HEAD), "it names no columns"))?;
        let mut rows = Vec::new();
        for (k, line) in BufReader::new(File::open(&file).map_err(unreadable)?).lines().enumerate() {
            let row = read_line(&columns, &line.map_err(unreadable)?);
            rows.push(row.ok_or_else(|| InputError::Malformed {
                file: name.clone(),
                line: k + 1,
                column: 1,
                message: format!("this is no row of the columns that {HEAD} names"),
            })?);
        }
        Ok(SweepTable { head, columns, rows })
    }

    /// Which part of a sweep it is.
    fn shard(&self, folder: &Path) -> Result<HeadShard, InputError> {
        let file = folder.join(HEAD);
        let shard = self.head.get("shard").ok_or_else(|| not_ours(&file, "it is a whole sweep"))?;
        let shard: HeadShard = serde_json::from_value(shard.clone()).map_err(|e| not_ours(&file, &e.to_string()))?;
        let (name, allowed) =
            (folder.join(LINES).display().to_string(), format!("{}, as {HEAD} beside it says", shard.rows));
        InputError::require(shard.rows == self.rows.len(), name, "rows", self.rows.len(), allowed)?;
        Ok(shard)
    }

    /// The definition without the shard, which is the same for all parts of a sweep.
    fn definition(&self) -> Value {
        let mut head = self.head.clone();
        head.as_object_mut().map(|fields| fields.remove("shard"));
        head
    }
}

fn not_ours(file: &Path, reason: &str) -> InputError {
    InputError::other_file(file.display(), "the record of a part of a sweep", reason)
}

fn read_head(folder: &Path) -> Result<Value, InputError> {
    let file = folder.join(HEAD);
    let unreadable = |reason: String| InputError::Unreadable { file: file.display().to_string(), reason };
    let opened = File::open(&file).map_err(|error| unreadable(error.to_string()))?;
    let head: Value = serde_json::from_reader(BufReader::new(opened)).map_err(|e| not_ours(&file, &e.to_string()))?;
    if head["schema"] == SCHEMA && head["schema_version"] == SCHEMA_VERSION {
        return Ok(head);
    }
    Err(not_ours(&file, &format!("it is not {SCHEMA}, version {SCHEMA_VERSION}")))
}

fn what_differs(there: &Value, now: &Value) -> String {
    const NAMED: usize = 3;
    let mut found = Vec::new();
    differences("sweep", there, now, &mut found);
    let more = if found.len() > NAMED { format!("; and {} more", found.len() - NAMED) } else { String::new() };
    found.truncate(NAMED);
    format!("{}{more}", found.join("; "))
}

/// Lists the fields in which two values differ, with both values of a field if they are short.
fn differences(name: &str, there: &Value, now: &Value, found: &mut Vec<String>) {
    match (there, now) {
        _ if there == now => {}
        (Value::Object(a), Value::Object(b)) => {
            let added = b.keys().filter(|key| !a.contains_key(*key));
            for key in a.keys().chain(added) {
                let of = |map: &serde_json::Map<String, Value>| map.get(key).cloned().unwrap_or_default();
                differences(&format!("{name}.{key}"), &of(a), &of(b), found);
            }
        }
        _ if there.is_array() || there.is_object() || now.is_array() || now.is_object() => {
            found.push(format!("another {name}"));
        }
        _ => found.push(format!("{name} = {there} there, {now} now")),
    }
}

/// Merges the parts of a sweep: the same table as of the whole sweep, byte for byte.
///
/// # Errors
/// Names the folder and the error: parts of different sweeps or versions, a part that is missing or incomplete, two different
/// rows of one point.
pub fn merge(folders: &[PathBuf]) -> Result<SweepTable, InputError> {
    let mut definition: Option<(Value, Vec<String>)> = None;
    let mut rows: BTreeMap<usize, (Row, usize)> = BTreeMap::new();
    let mut seen = std::collections::BTreeSet::new();
    let mut of = 0;
    for (number, folder) in folders.iter().enumerate() {
        let table = SweepTable::read(folder)?;
        let shard = table.shard(folder)?.shard;
        let own = table.definition();
        let name = folder.display().to_string();
        match &definition {
            Some((first, _)) if *first != own => {
                let allowed = format!("that of {}: they differ ({})", folders[0].display(), what_differs(first, &own));
                return Err(InputError::not_allowed(name, "definition", "another one", allowed));
            }
            Some(_) if shard.of != of => {
                let allowed = format!("one of {of} parts, as {} is", folders[0].display());
                return Err(InputError::not_allowed(name, "shard", shard, allowed));
            }
            Some(_) => {}
            None => (definition, of) = (Some((own, table.columns)), shard.of),
        }
        seen.insert(shard.number);
        for row in table.rows {
            if let Some((other, from)) = rows.get(&row.index).filter(|(other, _)| *other != row) {
                let allowed = format!("the same as in {}", folders[*from].display());
                return Err(InputError::not_allowed(name, "row of point", other.index, allowed));
            }
            rows.insert(row.index, (row, number));
        }
    }
    let Some((head, columns)) = definition else {
        return Err(InputError::not_allowed("merge", "folders", "none", "the folders of all parts of a sweep"));
    };
    let missing: Vec<String> = (1..=of).filter(|k| !seen.contains(k)).map(|k| format!("{k}/{of}")).collect();
    let allowed = format!("all {of} of them; missing: {}", listed(missing.iter().map(String::as_str), ", "));
    InputError::require(missing.is_empty(), "merge", "parts", seen.len(), allowed)?;
    let points = head["points"].as_u64().unwrap_or(0);
    let whole = rows.len() as u64 == points && rows.keys().next_back().is_none_or(|last| (*last as u64) < points);
    InputError::require(whole, "merge", "rows", rows.len(), format!("those of all {points} points, each once"))?;
    Ok(SweepTable { head, columns, rows: rows.into_values().map(|(row, _)| row).collect() })
}
