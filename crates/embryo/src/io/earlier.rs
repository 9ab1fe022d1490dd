//! What an earlier run left in the folder of a tree or of several scenarios.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use serde::Deserialize;
use serde_json::Value;

use crate::lineage::{Lineage, Scenario, TreeSettings};

/// The files of a tree, in the order in which they are put in place.
pub const TREE_FILES: [&str; 5] = ["tree.nwk", "tree.json", "tree.svg", "report.html", "run.json"];

/// The files beside the folders of scenarios, in the order in which they are put in place.
pub const SCENARIOS_FILES: [&str; 3] = ["scenarios.csv", "report.html", "run.json"];

/// The files in the folder of each scenario.
pub const SCENARIO_FILES: [&str; 3] = ["tree.nwk", "tree.json", "tree.svg"];

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

/// The part of `run.json` that says how trees were grown where `tree.json` does not.
#[derive(Deserialize)]
struct Manner {
    dynamics: bool,
    /// Names of the scenarios, where it was several.
    #[serde(default)]
    scenarios: Vec<String>,
}

/// What would be lost if a run were to write into a folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Replaced {
    /// The files that are there, relative to the folder.
    pub files: Vec<String>,
    /// From what other inputs they were made.
    pub why: String,
}

/// What would be lost if a tree were written into `folder`. `None` where there are no files of ours, or they are those of the
/// same tree, which are replaced by the like.
pub fn other_tree(folder: &Path, lineage: &Lineage, settings: &TreeSettings, dynamics: bool) -> Option<Replaced> {
    let manner: Option<Manner> = read(&folder.join("run.json"));
    let files = ours(folder, manner.as_ref(), &[]);
    if files.is_empty() {
        return None;
    }
    let why = match &manner {
        Some(Manner { scenarios, .. }) if !scenarios.is_empty() => Some(several(scenarios)),
        manner => match read::<Inputs>(&folder.join("tree.json")) {
            None => Some(format!("{}, without a tree.json that says what they were grown from", files.join(", "))),
            Some(inputs) => {
                let mut found = unlike("", &inputs, lineage, settings);
                found.extend(other_manner(manner.as_ref(), dynamics));
                told(found)
            }
        },
    };
    why.map(|why| Replaced { files, why })
}

/// What would be lost if scenarios were written into `folder`, each into a folder of its name there.
pub fn other_scenarios(folder: &Path, scenarios: &[Scenario], dynamics: bool) -> Option<Replaced> {
    let manner: Option<Manner> = read(&folder.join("run.json"));
    let files = ours(folder, manner.as_ref(), scenarios);
    if files.is_empty() {
        return None;
    }
    let alike = |there: &[String]| there.iter().eq(scenarios.iter().map(|scenario| &scenario.name));
    let why = match &manner {
        Some(manner) if alike(&manner.scenarios) => {
            let mut found = Vec::new();
            for Scenario { name, lineage, settings, .. } in scenarios {
                match read::<Inputs>(&folder.join(name).join("tree.json")) {
                    Some(inputs) => found.extend(unlike(&format!("{name}: "), &inputs, lineage, settings)),
                    None => found.push(format!("{name}: no tree.json there")),
                }
            }
            found.extend(other_manner(Some(manner), dynamics));
            told(found)
        }
        Some(manner) if !manner.scenarios.is_empty() => Some(several(&manner.scenarios)),
        _ => Some(format!("{}, which are not those of these scenarios", some_of(&files))),
    };
    why.map(|why| Replaced { files, why })
}

/// The files in a folder that a run of `furrow tree` wrote, or that one of these scenarios would write over.
fn ours(folder: &Path, manner: Option<&Manner>, scenarios: &[Scenario]) -> Vec<String> {
    let earlier = manner.map_or(&[][..], |manner| &manner.scenarios);
    // A record of ours names plain folders; whatever else it says names nothing that is ours to move.
    let plain = |name: &&String| !name.contains(['/', '\\', ':']) && !name.starts_with('.');
    let mut names: Vec<String> =
        TREE_FILES.iter().chain(&SCENARIOS_FILES[..1]).map(|name| (*name).to_owned()).collect();
    for scenario in earlier.iter().filter(plain).chain(scenarios.iter().map(|scenario| &scenario.name)) {
        let inside = SCENARIO_FILES.map(|file| format!("{scenario}/{file}"));
        names.extend(inside.into_iter().filter(|name| !names.contains(name)).collect::<Vec<_>>());
    }
    names.retain(|name| folder.join(name).symlink_metadata().is_ok());
    names
}

fn several(scenarios: &[String]) -> String {
    format!("they are those of the scenarios {}", some_of(scenarios))
}

fn some_of(names: &[String]) -> String {
    let more = if names.len() > NAMED { format!(" and {} more", names.len() - NAMED) } else { String::new() };
    format!("{}{more}", names[..names.len().min(NAMED)].join(", "))
}

/// How the inputs of an earlier tree differ from these, each difference with `prefix` before it.
fn unlike(prefix: &str, earlier: &Inputs, lineage: &Lineage, settings: &TreeSettings) -> Vec<String> {
    let mut found = Vec::new();
    let asked = [
        ("seed", &earlier.seed, serde_json::to_value(settings.seed)),
        ("r0_step", &earlier.r0_step, serde_json::to_value(settings.r0_step)),
        ("cell", &earlier.cell, serde_json::to_value(&settings.cell)),
        ("numerics", &earlier.numerics, serde_json::to_value(settings.numerics)),
        ("lineage", &earlier.lineage, serde_json::to_value(lineage)),
    ];
    for (name, earlier, now) in asked {
        differences(&format!("{prefix}{name}"), earlier, &now.unwrap_or_default(), &mut found);
    }
    found
}

/// Runs that were recorded before the manner was, and those whose record is gone, are taken to be alike in it.
fn other_manner(manner: Option<&Manner>, dynamics: bool) -> Option<String> {
    let manner = manner.filter(|manner| manner.dynamics != dynamics)?;
    Some(format!("dynamics = {} there, {dynamics} now", manner.dynamics))
}

fn told(found: Vec<String>) -> Option<String> {
    (!found.is_empty()).then(|| format!("it was grown from other inputs ({})", first_few(found)))
}

fn first_few(mut found: Vec<String>) -> String {
    let others = if found.len() > NAMED { format!("; and {} more", found.len() - NAMED) } else { String::new() };
    found.truncate(NAMED);
    format!("{}{others}", found.join("; "))
}

/// The first few fields in which two values differ; `name` is what the text calls the values.
pub fn differences_in_words(name: &str, there: &Value, now: &Value) -> String {
    let mut found = Vec::new();
    differences(name, there, now, &mut found);
    first_few(found)
}

fn read<T: for<'a> Deserialize<'a>>(path: &Path) -> Option<T> {
    serde_json::from_reader(BufReader::new(File::open(path).ok()?)).ok()
}

/// Names the fields in which two values differ, each with both of its values where they are short.
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
