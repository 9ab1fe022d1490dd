//! Reading `tree.json`: any file gives a complete tree or one error message.

use crate::common::stand_in::small_tree_file;
use crate::complaints::changed;
use furrow_formats::{tree_from_json, tree_to_json};
use proptest::prelude::*;
use serde_json::Value;

fn complaint(text: &str) -> String {
    tree_from_json(text).unwrap_err().to_string()
}

#[test]
fn the_last_cell_needs_a_reason_and_mothers_their_order() {
    let tree: Value = serde_json::from_str(&small_tree_file()).unwrap();
    let mut without = tree.clone();
    let last = without["cells"].as_array_mut().unwrap().last_mut().unwrap();
    last["ended"] = Value::Null;
    let expected = format!("{}: ended = null: must be the reason why it has no daughters", last["name"]);
    assert!(complaint(&without.to_string()).ends_with(&expected));
    // Sisters, and cousins, that have changed places.
    for [one, other] in [["AB", "P1"], ["ABa", "EMS"]] {
        let mut swapped = tree.clone();
        let cells = swapped["cells"].as_array_mut().unwrap();
        let [a, b] = [one, other].map(|name| cells.iter().position(|cell| cell["name"] == name).unwrap());
        cells.swap(a, b);
        let said = complaint(&swapped.to_string());
        assert!(said.contains("it is out of order: cells stand in the order of their mothers"), "{said}");
    }
}

#[test]
fn complaints_about_long_values_are_short() {
    let tree: Value = serde_json::from_str(&small_tree_file()).unwrap();
    for (place, expected) in [("/schema", "xx\"…, version 3: must be"), ("/cells/7/r0", "xx\", expected a number")] {
        let said = complaint(&changed(&tree, &format!("{place} \"{}\"", "x".repeat(1 << 20))).to_string());
        assert!(said.contains(expected) && said.len() < 400, "{said}");
    }
}

#[test]
fn a_tree_of_version_2_has_cues_by_field_and_is_read() {
    let text = small_tree_file();
    let by_field = r#"{"kappa":{"profile":"band","u0":0.465,"omega":0.0577,"amplitude":0.1}}"#;
    let old = text.replace(r#""kappa:band,u0=0.465,omega=0.0577,amplitude=0.1""#, by_field);
    let old = old.replace("\"schema_version\": 3", "\"schema_version\": 2");
    assert!(old.matches(by_field).count() > 2 && old.contains("\"schema_version\": 2"));
    assert_eq!(tree_to_json(&tree_from_json(&old).unwrap()).unwrap(), text);
}

#[test]
fn what_is_no_json_is_told_with_its_place() {
    let text = small_tree_file();
    let with = |from: &str, to: &str| complaint(&text.replacen(from, to, 1));
    assert!(complaint(&text[..text.len() / 2]).contains("EOF while parsing"));
    assert_eq!(complaint(""), "line 1, column 0: EOF while parsing a value");
    assert_eq!(with("\"seed\": 0", "\"seed\": NaN"), "line 8, column 11: expected value");
    assert_eq!(with("\"seed\": 0", "\"seed\": 0,\n  \"seed\": 1"), "line 9, column 8: duplicate field `seed`");
    assert_eq!(with("\"r0\": 5.4", "\"r0\": 1e999"), "line 11, column 15: cell.r0: number out of range");
    assert!(with("\"outcome\":\"asymmetric\"", "\"outcome\":\"both\"").contains("unknown variant `both`"));
    // Another version is called that though it may lack what this one has.
    assert!(
        complaint("{\"schema\": \"furrow.tree\", \"schema_version\": 1}")
            .starts_with("schema = \"furrow.tree\", version 1: must be")
    );
    // What some editors do to a file.
    let windows = format!("\u{feff}{}", text.replace('\n', "\r\n"));
    assert_eq!(tree_to_json(&tree_from_json(&windows).unwrap()).unwrap(), text);
}

/// Deep brackets, where something else is expected and where anything is passed over.
#[test]
fn deep_json_is_refused_or_passed_over() {
    const DEPTH: usize = 1_000_000;
    let text = small_tree_file();
    let brackets = |open: &str, close: &str| format!("{}{}", open.repeat(DEPTH), close.repeat(DEPTH));
    for (at, deep) in [
        ("\"seed\": 0", format!("\"seed\": {}", brackets("[", "]"))),
        ("\"seed\": 0", format!("\"seed\": {}", "[".repeat(DEPTH))),
        ("\"cue\": \"none\"", format!("\"cue\": {}\"none\"{}", "{\"sum\":[".repeat(DEPTH), "]}".repeat(DEPTH))),
        ("\"seed\": 0", format!("\"seed\": 0, \"more\": {}", "{\"a\":".repeat(DEPTH))),
    ] {
        let said = complaint(&text.replacen(at, &deep, 1));
        assert!(said.starts_with("line ") && said.len() < 200, "{said}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    /// A tree with bytes changed, left out or cut off is read or refused. A file that is read gives a tree, which is written and read again.
    #[test]
    fn slips_are_read_or_refused(at in any::<prop::sample::Index>(), with in "[ -~]{0,3}", length in 0_usize..4, cut in any::<bool>()) {
        thread_local! { static TEXT: String = small_tree_file(); }
        let text = TEXT.with(String::clone);
        let at = at.index(text.len());
        let rest = if cut { "" } else { text.get(at + length..).unwrap_or("") };
        let slip = format!("{}{with}{rest}", &text[..at]);
        if let Ok(tree) = tree_from_json(&slip) {
            let written = tree_to_json(&tree).unwrap();
            prop_assert_eq!(tree_to_json(&tree_from_json(&written).unwrap()).unwrap(), written);
        }
    }
}
