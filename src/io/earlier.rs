//! What an earlier run left in the folder of a tree.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use serde::Deserialize;
use serde_json::Value;

use crate::lineage::{Lineage, TreeSettings};

/// The files of a tree, in the order in which they are put in place.
pub const TREE_FILES: [&str; 5] = ["tree.nwk", "tree.json", "tree.svg", "report.html", "run.json"];

/// Differences that are named in full; of more there are many, and one sees that it is another tree.
const NAMED: usize = 3;

/// What a tree depends on, as `tree.json` has it before the list of cells.
#[derive(Deserialize)]
struct Inputs {
    seed: Value,
    r0_step: Value,
    cell: Value,
    numerics: Value,
    lineage: Value,
}

/// The part of `run.json` that says how a tree was grown where `tree.json` does not.
#[derive(Deserialize)]
struct Manner {
    dynamics: bool,
}

/// What would be lost if a tree were written into `folder`: says which files are there and from what other inputs they were made.
/// `None` where there are none of ours, or they are those of the same tree, which are replaced by the like.
pub fn other_tree(folder: &Path, lineage: &Lineage, settings: &TreeSettings, dynamics: bool) -> Option<String> {
    let there: Vec<&str> = TREE_FILES.into_iter().filter(|name| folder.join(name).symlink_metadata().is_ok()).collect();
    if there.is_empty() {
        return None;
    }
    let Some(earlier) = read::<Inputs>(&folder.join("tree.json")) else {
        return Some(format!("{}, without a tree.json that says what they were grown from", there.join(", ")));
    };
    let mut found = Vec::new();
    let asked = [
        ("seed", &earlier.seed, serde_json::to_value(settings.seed)),
        ("r0_step", &earlier.r0_step, serde_json::to_value(settings.r0_step)),
        ("cell", &earlier.cell, serde_json::to_value(&settings.cell)),
        ("numerics", &earlier.numerics, serde_json::to_value(settings.numerics)),
        ("lineage", &earlier.lineage, serde_json::to_value(lineage)),
    ];
    for (name, earlier, now) in asked {
        differences(name, earlier, &now.unwrap_or_default(), &mut found);
    }
    // Runs that were recorded before it was, and those whose record is gone, are taken to be alike in it.
    let manner: Option<Manner> = read(&folder.join("run.json"));
    if let Some(manner) = manner.filter(|manner| manner.dynamics != dynamics) {
        found.push(format!("dynamics = {} there, {dynamics} now", manner.dynamics));
    }
    if found.is_empty() {
        return None;
    }
    let others = if found.len() > NAMED { format!("; and {} more", found.len() - NAMED) } else { String::new() };
    found.truncate(NAMED);
    Some(format!("it was grown from other inputs ({}{others})", found.join("; ")))
}

fn read<T: for<'a> Deserialize<'a>>(path: &Path) -> Option<T> {
    serde_json::from_reader(BufReader::new(File::open(path).ok()?)).ok()
}

/// Names the fields in which two values differ, each with both of its values where they are short.
pub(super) fn differences(name: &str, there: &Value, now: &Value, found: &mut Vec<String>) {
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
