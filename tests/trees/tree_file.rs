//! `tree.json` read back: whatever a file holds is a whole tree, or refused in one message.

use crate::common::stand_in::small_tree_file;
use furrow::lineage::Tree;
use proptest::prelude::*;
use serde_json::{Value, json};

/// The text with one field of one cell given another value.
fn with(text: &str, cell: &str, field: &str, value: Value) -> String {
    let mut document: Value = serde_json::from_str(text).unwrap();
    let cells = document["cells"].as_array_mut().unwrap();
    cells.iter_mut().find(|one| one["name"] == cell).unwrap()[field] = value;
    document.to_string()
}

#[test]
fn cells_that_form_no_tree_are_refused() {
    let text = small_tree_file();
    let complaint = |text: &str| Tree::from_json(text).unwrap_err().to_string();
    for (cell, field, value, expected) in [
        ("AB", "name", json!(""), "cells[1] \"\": name: must not be empty, nor have control characters"),
        ("AB", "name", json!("A\nB"), "cells[1] \"A\\nB\": name: must not be empty, nor have control characters"),
        (
            "AB",
            "name",
            json!("A B"),
            "cells[1] \"A B\": name: must be free of blanks, brackets, quotes and of : ; , = (tree files reserve them)",
        ),
        (
            "P1",
            "name",
            json!("AB"),
            "cells[2] \"AB\": founder \"P1\" is not what a daughter of \"P0\" belongs to in the lineage",
        ),
        ("ABp", "name", json!("ABa"), "cells[4] \"ABa\": its name appears twice"),
        (
            "AB",
            "mother",
            json!(null),
            "cells[1] \"AB\": the first cell, and no other, has neither mother nor daughter side",
        ),
        (
            "AB",
            "daughter",
            json!(null),
            "cells[1] \"AB\": the first cell, and no other, has neither mother nor daughter side",
        ),
        (
            "P0",
            "mother",
            json!("AB"),
            "cells[0] \"P0\": the first cell, and no other, has neither mother nor daughter side",
        ),
        // Its own mother, and one that comes later: cycles cannot be said in a list whose mothers come first.
        ("ABa", "mother", json!("ABa"), "cells[3] \"ABa\": mother \"ABa\" is not among the cells before it"),
        ("AB", "mother", json!("ABa"), "cells[1] \"AB\": mother \"ABa\" is not among the cells before it"),
        (
            "ABa",
            "founder",
            json!("P1"),
            "cells[3] \"ABa\": founder \"P1\" is not what a daughter of \"AB\" belongs to in the lineage",
        ),
        ("ABa", "founder", json!("Z"), "cells[3] \"ABa\": founder \"Z\" is not in the lineage"),
        (
            "P0",
            "founder",
            json!("AB"),
            "cells[0] \"P0\": the first cell must be the first founder of the lineage, \"P0\"",
        ),
        ("P0", "generation", json!(3), "cells[0] \"P0\": generation = 3: must be 0 for the first cell"),
        (
            "AB",
            "generation",
            json!(4294967295_u32),
            "cells[1] \"AB\": generation 4294967295 does not follow the mother's",
        ),
        ("AB", "r0", json!(0.0), "cells[1] \"AB\": r0 = 0.0: must be a finite number above 0"),
        ("AB", "r0", json!(-1e300), "cells[1] \"AB\": r0 = -1e300: must be a finite number above 0"),
        (
            "AB",
            "volume_fraction",
            json!(-0.5),
            "cells[1] \"AB\": volume_fraction = -0.5: must be a finite number above 0",
        ),
        ("AB", "chi", json!(1.01), "cells[1] \"AB\": chi = 1.01: must be from 0 to 1"),
        ("AB", "chi_signed", json!(-2), "cells[1] \"AB\": chi_signed = -2.0: must be from -1 to 1"),
        ("AB", "u_furrow", json!(7), "cells[1] \"AB\": u_furrow = 7.0: must be from 0 to 1"),
        ("AB", "t_end", json!(-1), "cells[1] \"AB\": t_end = -1.0: must be a finite number of at least 0"),
        (
            "AB",
            "t_end",
            json!(null),
            "cells[1] \"AB\": outcome: must be symmetric or asymmetric, with t_end, where there are daughters",
        ),
        (
            "AB",
            "outcome",
            json!("failed"),
            "cells[1] \"AB\": outcome: must be symmetric or asymmetric, with t_end, where there are daughters",
        ),
        (
            "AB",
            "ended",
            json!({"reason": "at_rest", "growth_rate": null}),
            "cells[1] \"AB\": ended = \"at_rest\": must be null where there are daughters",
        ),
    ] {
        assert_eq!(complaint(&with(&text, cell, field, value)), expected);
    }
    let last = |text: &str| {
        let document: Value = serde_json::from_str(text).unwrap();
        document["cells"].as_array().unwrap().last().unwrap()["name"].as_str().unwrap().to_owned()
    };
    let end = last(&text);
    let said = complaint(&with(&text, &end, "ended", json!(null)));
    assert!(said.ends_with(&format!("{end:?}: ended = null: must be the reason why it has no daughters")), "{said}");
    // Sisters, and cousins, that have changed places.
    for [one, other] in [["AB", "P1"], ["ABa", "EMS"]] {
        let mut document: Value = serde_json::from_str(&text).unwrap();
        let cells = document["cells"].as_array_mut().unwrap();
        let place = |name: &str| cells.iter().position(|cell| cell["name"] == name).unwrap();
        let (a, b) = (place(one), place(other));
        cells.swap(a, b);
        let said = complaint(&document.to_string());
        assert!(said.contains("it is out of order: cells stand in the order of their mothers"), "{said}");
    }
}

#[test]
fn inputs_that_nothing_is_grown_from_are_refused() {
    let text = small_tree_file();
    let complaint = |place: &str, value: Value| {
        let mut document: Value = serde_json::from_str(&text).unwrap();
        match document.pointer_mut(place) {
            Some(there) => *there = value,
            None => {
                let (above, field) = place.rsplit_once('/').unwrap();
                document.pointer_mut(above).unwrap()[field] = value;
            }
        }
        Tree::from_json(&document.to_string()).unwrap_err().to_string()
    };
    for (place, value, expected) in [
        ("/schema", json!("furrow.run"), "schema = \"furrow.run\", version 2: must be \"furrow.tree\", version 2"),
        ("/schema", json!("x".repeat(1 << 20)), "xx\"…, version 2: must be"),
        ("/lineage/founders/0/mother", json!("P4"), "daughter = (not given)"),
        ("/lineage/founders/1/mother", json!("AB"), "the founders' mothers form a cycle"),
        ("/lineage/founders/1/name", json!("A\u{0}B"), "control characters"),
        ("/lineage/founders/1/name", json!("P0"), "must be unique in the file"),
        (
            "/lineage/founders/0/cue",
            json!("nowhere"),
            "founder \"P0\": cue = \"nowhere\": must be one of none, germline",
        ),
        ("/lineage/founders", json!([]), "founders = []: must be a list of at least one founder"),
        ("/lineage/limits/max_depth", json!(0), "limits.max_depth = 0: must be from 1 to 100000"),
        ("/lineage/name", json!("\u{1b}[2J"), "control characters"),
        ("/cell/epsilon", json!(1.5), "cell and numerics: physics.epsilon = 1.5: must be above 0 and below 1"),
        ("/cell/r0", json!(-5.4), "cell and numerics: physics.r0 = -5.4"),
        ("/numerics/intervals", json!(u64::MAX), "cell and numerics: numerics.intervals = 18446744073709551615"),
        ("/r0_step", json!(-1.0), "tree: r0_step = -1: must be from 0 to 0.5"),
        ("/seed", json!(-1), "seed: invalid value: integer `-1`, expected a whole number, 0 or above"),
        ("/seed", json!(1e30), "invalid type: floating point"),
        ("/cells", json!([]), "there are no cells"),
        ("/cells", json!({}), "cells: invalid type: map"),
        ("/cells/7/r0", json!("x".repeat(1 << 20)), "xx\", expected a number"),
        ("/cells/7/r0", json!("big"), "cells[7].r0: invalid type: string \"big\", expected a number"),
        ("/cells/7/outcome", json!("\u{1b}[2J"), "cells[7].outcome: unknown variant `\\u{1b}[2J`, expected one of"),
        (
            "/lineage/founders/1/letters/0",
            json!("ap"),
            "lineage.founders[1].letters[0]: invalid type: string \"ap\", expected a list of two",
        ),
        ("/lineage/cues/germline/kappa/omga", json!(1), "lineage.cues.germline.kappa: unknown field `omga`"),
        ("/cell/material", json!({}), "cell.material: missing field `kappa`"),
    ] {
        let said = complaint(place, value);
        assert!(said.contains(expected), "{place}: {said}");
        assert!(said.len() < 400, "{said}");
    }
}

#[test]
fn what_is_no_json_is_told_with_its_place() {
    let text = small_tree_file();
    let complaint = |text: &str| Tree::from_json(text).unwrap_err().to_string();
    let with = |from: &str, to: &str| complaint(&text.replacen(from, to, 1));
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
    assert_eq!(Tree::from_json(&windows).unwrap().to_json().unwrap(), text);
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
        let said = Tree::from_json(&text.replacen(at, &deep, 1)).unwrap_err().to_string();
        assert!(said.starts_with("line ") && said.len() < 200, "{said}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    /// A tree with bytes changed, left out or cut off is read or refused. What is read is a tree: it is written and read again.
    #[test]
    fn slips_are_read_or_refused(at in any::<prop::sample::Index>(), with in "[ -~]{0,3}", length in 0_usize..4, cut in any::<bool>()) {
        thread_local! { static TEXT: String = small_tree_file(); }
        let text = TEXT.with(String::clone);
        let at = at.index(text.len());
        let rest = if cut { "" } else { text.get(at + length..).unwrap_or("") };
        let slip = format!("{}{with}{rest}", &text[..at]);
        if let Ok(tree) = Tree::from_json(&slip) {
            let written = tree.to_json().unwrap();
            prop_assert_eq!(Tree::from_json(&written).unwrap().to_json().unwrap(), written);
        }
    }
}
