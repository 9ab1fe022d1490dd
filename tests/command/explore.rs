//! `furrow explore`: the page that computes, without a tree.

use std::path::Path;
use std::process::Output;

use serde_json::Value;

use crate::common::command::furrow;

fn explore(folder: &Path, arguments: &[&str]) -> Output {
    furrow(folder, &[&["explore"], arguments].concat())
}

/// What the scripts of a page are told.
fn told(page: &str) -> Value {
    let (_, behind) = page.split_once("id=\"furrow-data\">").unwrap();
    serde_json::from_str(behind.split("</script>").next().unwrap()).unwrap()
}

#[test]
fn the_page_has_the_parameters_it_was_asked_for_and_no_tree() {
    let folder = tempfile::tempdir().unwrap();
    let output = explore(folder.path(), &["--r0", "3", "--epsilon", "0.8", "--set", "aspect=1.3", "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
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
        assert!(explore(folder.path(), &["--out", name]).status.success());
    }
    let [a, b] = ["a.html", "b.html"].map(|name| std::fs::read(folder.path().join(name)).unwrap());
    assert!(a == b && a.len() > 500_000);
}

#[test]
fn what_cannot_be_written_or_computed_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("file"), "").unwrap();
    for (arguments, said) in [
        (["--out", "file/page.html"], "--out"),
        (["--r0", "-1"], "--r0: r0 = -1: must be a finite number above 0, from 1e-6 to 1e6"),
        (["--epsilon", "1.2"], "--epsilon: epsilon = 1.2: must be above 0 and below 1"),
        (["--xi", "1e9"], "--xi: xi_s = 1000000000"),
    ] {
        let output = explore(folder.path(), &arguments);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {error}");
        assert!(error.contains(said), "{arguments:?}: {error}");
        assert!(output.stdout.is_empty() && !folder.path().join("explore.html").exists());
    }
}
