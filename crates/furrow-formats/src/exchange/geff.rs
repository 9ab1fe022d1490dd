//! GEFF, a graph in arrays of Zarr version 2, not compressed.
//!
//! # References
//! <https://live-image-tracking-tools.github.io/geff>, <https://zarr-specs.readthedocs.io>.

use serde_json::{Value, json};

use super::column::Kind;
use super::sheet::{GRAPH_COLUMNS, Sheet};

/// The version of GEFF.
const VERSION: &str = "1.3";

/// The values of a property.
enum Values {
    Whole(Vec<u64>),
    Numbers(Vec<Option<f64>>),
    Texts(Vec<Option<String>>),
}

/// A property of nodes.
struct Property {
    name: &'static str,
    description: &'static str,
    values: Values,
    /// Whether some cells may lack it. The file that says so is written for every tree, so that no file of an earlier tree is left in a
    /// folder.
    may_miss: bool,
}

/// The files of a folder: a node per cell, an edge from each mother to each daughter. `t` is the birth where it is wanted
/// (`with_times`) and known, else the generation.
pub(super) fn geff(sheet: &Sheet<'_>, with_times: bool) -> Vec<(String, Vec<u8>)> {
    let births = || sheet.cells.iter().map(|cell| Some(cell.times?.0)).collect::<Option<Vec<_>>>();
    let (times, unit) = match with_times.then(births).flatten() {
        Some(times) => (times, Some(sheet.time)),
        None => (sheet.cells.iter().map(|cell| f64::from(cell.generation)).collect(), None),
    };
    let range = times.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], t| [a.min(*t), b.max(*t)]);
    let properties = properties(sheet, times);
    let mut files = vec![(".zattrs".to_owned(), pretty(&metadata(&properties, range, unit)))];
    for group in ["", "nodes/", "nodes/props/", "edges/", "edges/props/"] {
        files.push((format!("{group}.zgroup"), pretty(&json!({ "zarr_format": 2 }))));
    }
    let ids = (0..sheet.len() as u64).collect();
    array(&mut files, "nodes/ids", "<u8", &[sheet.len()], &Values::Whole(ids));
    for Property { name, values, may_miss, .. } in &properties {
        let folder = format!("nodes/props/{name}");
        files.push((format!("{folder}/.zgroup"), pretty(&json!({ "zarr_format": 2 }))));
        let (kind, missing) = match values {
            Values::Whole(_) => ("<u8".to_owned(), None),
            Values::Numbers(of) => ("<f8".to_owned(), Some(of.iter().map(Option::is_none).collect())),
            Values::Texts(of) => (format!("<U{}", longest(of)), Some(of.iter().map(Option::is_none).collect())),
        };
        array(&mut files, &format!("{folder}/values"), &kind, &[sheet.len()], values);
        if let Some(missing) = missing.filter(|_: &Vec<bool>| *may_miss) {
            let missing = Values::Whole(missing.into_iter().map(u64::from).collect());
            array(&mut files, &format!("{folder}/missing"), "|b1", &[sheet.len()], &missing);
        }
    }
    let edge = |id: usize| Some([sheet.cells[id].mother? as u64, id as u64]);
    let edges: Vec<u64> = (0..sheet.len()).filter_map(edge).flatten().collect();
    array(&mut files, "edges/ids", "<u8", &[edges.len() / 2, 2], &Values::Whole(edges));
    files
}

/// The properties of all cells.
fn properties(sheet: &Sheet<'_>, times: Vec<f64>) -> Vec<Property> {
    let names = sheet.cells.iter().map(|cell| Some(cell.name.to_owned())).collect();
    let complete = |name, description, values| Property { name, description, values, may_miss: false };
    let mut found = vec![
        complete("t", "birth", Values::Numbers(times.into_iter().map(Some).collect())),
        complete("name", "name of the cell", Values::Texts(names)),
    ];
    for (column, name, description) in GRAPH_COLUMNS {
        let Some(column) = sheet.columns.iter().find(|other| other.name == column) else { continue };
        let texts: Vec<Option<String>> = (0..sheet.len()).map(|cell| (column.of)(cell)).collect();
        let values = match column.kind {
            Kind::Text => Values::Texts(texts),
            Kind::Number => Values::Numbers(texts.iter().map(|text| text.as_ref()?.parse().ok()).collect()),
            Kind::Count => Values::Whole(texts.iter().flatten().filter_map(|text| text.parse().ok()).collect()),
        };
        found.push(Property { name, description, values, may_miss: column.may_miss });
    }
    found
}

fn metadata(properties: &[Property], [min, max]: [f64; 2], unit: Option<&str>) -> Value {
    let of = |Property { name, description, values, .. }: &Property| {
        let kind = match values {
            Values::Whole(_) => "uint64",
            Values::Numbers(_) => "float64",
            Values::Texts(_) => "str",
        };
        let unit = unit.filter(|_| *name == "t");
        let known =
            json!({ "identifier": name, "dtype": kind, "varlength": false, "unit": unit, "description": description });
        ((*name).to_owned(), known)
    };
    let known: serde_json::Map<String, Value> = properties.iter().map(of).collect();
    json!({ "geff": {
        "geff_version": VERSION,
        "directed": true,
        "axes": [{ "name": "t", "type": "time", "unit": unit, "min": min, "max": max }],
        "node_props_metadata": known,
        "edge_props_metadata": {},
        // Not `sphere`: its radii have a unit of space, which L_h is not.
        "extra": { "software": format!("furrow {}", env!("CARGO_PKG_VERSION")) },
    } })
}

/// Characters of the longest text, at least one.
fn longest(texts: &[Option<String>]) -> usize {
    texts.iter().flatten().map(|text| text.chars().count()).fold(1, usize::max)
}

/// Adds an array in one chunk.
fn array(files: &mut Vec<(String, Vec<u8>)>, name: &str, kind: &str, shape: &[usize], values: &Values) {
    let fill = if kind.starts_with("<U") { json!("") } else { json!(0) };
    let fill = if kind == "|b1" { json!(false) } else { fill };
    let chunks: Vec<usize> = shape.iter().map(|length| (*length).max(1)).collect();
    let document = json!({ "zarr_format": 2, "shape": shape, "chunks": chunks, "dtype": kind, "compressor": null,
        "fill_value": fill, "order": "C", "filters": null, "dimension_separator": "." });
    files.push((format!("{name}/.zarray"), pretty(&document)));
    let bytes: Vec<u8> = match values {
        Values::Whole(of) if kind == "|b1" => of.iter().map(|number| *number as u8).collect(),
        Values::Whole(of) => of.iter().flat_map(|number| number.to_le_bytes()).collect(),
        // A missing number is written as 0, which readers ignore.
        Values::Numbers(of) => of.iter().flat_map(|number| number.unwrap_or(0.0).to_le_bytes()).collect(),
        Values::Texts(of) => {
            let width = longest(of);
            let points = |text: &Option<String>| {
                let text = text.as_deref().unwrap_or_default().chars().map(u32::from);
                text.chain(std::iter::repeat(0)).take(width).flat_map(u32::to_le_bytes).collect::<Vec<u8>>()
            };
            of.iter().flat_map(points).collect()
        }
    };
    // A chunk of no rows has no file.
    if shape[0] > 0 {
        files.push((format!("{name}/{}", if shape.len() > 1 { "0.0" } else { "0" }), bytes));
    }
}

fn pretty(document: &Value) -> Vec<u8> {
    format!("{document:#}\n").into_bytes()
}
