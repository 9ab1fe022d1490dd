//! `furrow explore`: the interactive page without a tree.

use serde_json::Value;

use crate::common::command::{answer, json};

/// The data of a page's scripts.
fn told(page: &str) -> Value {
    let (_, behind) = page.split_once("id=\"furrow-data\">").unwrap();
    serde_json::from_str(behind.split("</script>").next().unwrap()).unwrap()
}

#[test]
fn the_page_has_the_parameters_it_was_asked_for_and_no_tree() {
    let folder = tempfile::tempdir().unwrap();
    let answer = json(folder.path(), &["explore", "--r0", "3", "--epsilon", "0.8", "--set", "aspect=1.3"]);
    let page = std::fs::read_to_string(folder.path().join(answer["out"].as_str().unwrap())).unwrap();
    assert_eq!(answer["bytes"].as_u64(), Some(page.len() as u64));
    let told = told(&page);
    let cell = &told["head"]["cell"];
    assert_eq!([&cell["r0"], &cell["epsilon"], &cell["shell"]["aspect"]].map(Value::as_f64), [3.0, 0.8, 1.3].map(Some));
    // The stored edge is that of other constants.
    assert!(told["tree"].is_null() && told["edge"].is_null());
    assert!(page.contains("physics.aspect = 1.3"));
}

#[test]
fn equal_options_give_equal_bytes() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.html", "b.html"] {
        answer(folder.path(), &["explore", "--out", name]);
    }
    let [a, b] = ["a.html", "b.html"].map(|name| std::fs::read(folder.path().join(name)).unwrap());
    assert!(a == b && a.len() > 500_000);
}
