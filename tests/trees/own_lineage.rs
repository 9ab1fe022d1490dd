//! Custom lineages: the template, units, physics of founders, observed counts with gaps.

use std::fs;
use std::path::Path;

use furrow_lineage::TEMPLATE;
use serde_json::Value;

use crate::common::command::{self, refusal};

fn answer(folder: &Path, arguments: &[&str]) -> String {
    command::answer(folder, &[arguments, &["--no-cache"]].concat())
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    command::json(folder, &[arguments, &["--no-cache"]].concat())
}

fn tree(text: &str, arguments: &[&str]) -> (String, Value) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("mine.ron"), text).unwrap();
    let out = answer(folder.path(), &[&["tree", "mine.ron"], arguments].concat());
    let file = fs::read_to_string(folder.path().join("furrow-out/tree.json")).unwrap();
    (out, serde_json::from_str(&file).unwrap())
}

#[test]
fn the_template_grows_as_it_stands_and_is_not_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let said = answer(folder.path(), &["new-lineage", "mine.ron"]);
    assert_eq!(said, "mine.ron written; change it, then: furrow tree mine.ron\n");
    assert_eq!(fs::read_to_string(folder.path().join("mine.ron")).unwrap(), TEMPLATE);
    let answer = json(folder.path(), &["tree", "mine.ron"]);
    assert_eq!(answer["founders"].as_array().unwrap().len(), 5);
    assert!(answer["founders"].as_array().unwrap().iter().all(|founder| founder["r0_um"].as_f64().unwrap() > 1.0));
    fs::write(folder.path().join("mine.ron"), "precious").unwrap();
    let err = refusal(folder.path(), &["new-lineage", "mine.ron"]);
    assert!(err.contains("\"mine.ron\": must be a file that does not exist yet"), "{err}");
    assert_eq!(fs::read_to_string(folder.path().join("mine.ron")).unwrap(), "precious");
}

#[test]
fn another_animal_grows() {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("lineages/sea_urchin.ron")).unwrap();
    let (table, file) = tree(&text, &[]);
    assert!(table.contains("40.00"), "{table}");
    let founders = file["founders"].as_array().unwrap();
    let of = |name: &str| founders.iter().find(|founder| founder["name"] == name).unwrap();
    // Small micromeres exist and are the smaller: with the activity that the file gives them.
    assert!(of("SM1")["r0"].as_f64().unwrap() < of("LM1")["r0"].as_f64().unwrap());
    assert_eq!(of("SM1")["sulston"]["terminal"], 2);
    // u = 0 is the vegetal pole: of Vg's daughters the macromere is the animal, the first one.
    let cells = file["cells"].as_array().unwrap();
    let side = |name: &str| cells.iter().find(|cell| cell["name"] == name).unwrap()["daughter"].clone();
    assert_eq!((side("Ma1"), side("Mi1")), ("anterior".into(), "posterior".into()));
}

const UNITS: &str = "Lineage(name: \"x\", units: (length_um: 4.0, time_min: 2.0), limits: (max_depth: 1), \
                     founders: [(name: \"Q\", r0: \"12um\")])";

#[test]
fn lengths_in_micrometres_need_a_unit() {
    let (table, file) = tree(UNITS, &[]);
    assert!(table.contains("grown from R0 = 3 (12.00 µm)"), "{table}");
    assert_eq!(file["cells"][0]["r0"], 3.0);
    let (_, file) = tree(UNITS, &["--r0", "10um"]);
    assert_eq!(file["cells"][0]["r0"], 2.5);
    let (_, file) = tree(UNITS, &["--r0", "2.5"]);
    assert_eq!(file["cells"][0]["r0"], 2.5);
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("mine.ron"), UNITS).unwrap();
    let found = json(folder.path(), &["divide", "--r0", "10um", "--lineage", "mine.ron"]);
    assert_eq!((&found["r0"], &found["r0_um"]), (&2.5.into(), &10.0.into()));
    assert_eq!(found["t_end_min"].as_f64().unwrap(), 2.0 * found["t_end"].as_f64().unwrap());
    let out = answer(folder.path(), &["divide", "--r0", "10um", "--lineage", "mine.ron"]);
    assert!(out.contains("R0 = 2.5 (10.00 µm)") && out.contains(" min)"), "{out}");
}

/// A founder's physics are its own and its descendants' up to the next founder.
#[test]
fn founders_change_the_physics_for_their_part() {
    let text = |physics: &str| {
        format!(
            "Lineage(name: \"x\", limits: (max_depth: 3), founders: [(name: \"Q\", r0: 4.0),
            (name: \"A\", mother: \"Q\", daughter: larger{physics}), (name: \"B\", mother: \"Q\", daughter: smaller)])"
        )
    };
    let outcomes = |file: &Value| -> Vec<(String, Value)> {
        let cells = file["cells"].as_array().unwrap();
        cells.iter().map(|c| (c["name"].as_str().unwrap().to_owned(), c["outcome"].clone())).collect()
    };
    let plain = outcomes(&tree(&text(""), &[]).1);
    let (table, file) = tree(&text(", physics: (xi_s: 12.0)"), &[]);
    assert!(table.contains("A and its descendants up to the next founder: xi_s = 12"), "{table}");
    let weak = outcomes(&file);
    // At this activity A stays at rest; B, of the same size, divides as before.
    assert!(plain.contains(&("A".to_owned(), "symmetric".into())), "{plain:?}");
    assert!(weak.contains(&("A".to_owned(), "failed".into())), "{weak:?}");
    assert!(weak.contains(&("B".to_owned(), "symmetric".into())), "{weak:?}");
}

#[test]
fn observed_counts_may_have_gaps_and_leave_no_empty_columns() {
    let text = |observed: &str| {
        format!("Lineage(name: \"x\", limits: (max_depth: 1), founders: [(name: \"Q\", r0: 3.0{observed})])")
    };
    assert!(!tree(&text(""), &[]).0.contains("observed"));
    let (table, file) = tree(&text(", observed: (max: 9, terminal: 40)"), &[]);
    let head = table.lines().find(|line| line.starts_with("founder")).unwrap();
    assert!(head.ends_with("| max cells"), "{head}");
    assert!(table.contains("|   9    40\n"), "{table}");
    let counts = serde_json::json!({"max": 9, "terminal": 40});
    assert_eq!((&file["founders"][0]["observed"], &file["founders"][0]["sulston"]), (&counts, &counts));
    // The older word is still read.
    let (older, _) = tree(&text(", sulston: (max: 9, terminal: 40)"), &[]);
    // The last line has the time it took.
    let counts = |table: &str| table[..table.find("divisions solved").unwrap()].to_owned();
    assert_eq!(counts(&older), counts(&table));
}

/// The germline is posterior and right of its sisters: in the file, in Newick, and in the drawing.
#[test]
fn the_germline_is_posterior_everywhere() {
    let folder = tempfile::tempdir().unwrap();
    let answer = json(folder.path(), &["tree"]);
    assert_eq!(answer["cells"], 285);
    let read = |name: &str| fs::read_to_string(folder.path().join("furrow-out").join(name)).unwrap();
    let file: Value = serde_json::from_str(&read("tree.json")).unwrap();
    let cells = file["cells"].as_array().unwrap();
    let place = |name: &str| cells.iter().position(|cell| cell["name"] == name).unwrap();
    let (newick, drawing) = (read("tree.nwk"), read("tree.svg"));
    let inner = |name: &str| newick.find(&format!("){name}:")).or(newick.find(&format!(",{name})"))).unwrap();
    let left = |name: &str| -> f64 {
        let disc = &drawing[drawing.find(&format!("<title>{name}: ")).unwrap()..];
        let at = disc.find("cx=\"").unwrap() + 4;
        disc[at..at + disc[at..].find('"').unwrap()].parse().unwrap()
    };
    for (anterior, posterior) in [("AB", "P1"), ("EMS", "P2"), ("C", "P3"), ("D", "P4")] {
        assert_eq!(cells[place(anterior)]["daughter"], "anterior");
        assert_eq!(cells[place(posterior)]["daughter"], "posterior");
        assert_eq!(place(posterior), place(anterior) + 1);
        assert!(inner(anterior) < inner(posterior), "{anterior} {posterior}");
        assert!(left(anterior) < left(posterior), "{anterior} {posterior}");
    }
    // Chance has no side: of the many unequal divisions without a cue both kinds are frequent.
    let unequal = cells.iter().filter(|cell| cell["outcome"] == "asymmetric" && cell["cue"] == "none");
    let signs: Vec<bool> = unequal.map(|cell| cell["chi_signed"].as_f64().unwrap() > 0.0).collect();
    let posterior = signs.iter().filter(|smaller| **smaller).count();
    println!("{posterior} of {} smaller daughters are posterior", signs.len());
    assert!(signs.len() > 100 && posterior > signs.len() / 3 && posterior < 2 * signs.len() / 3);
}
