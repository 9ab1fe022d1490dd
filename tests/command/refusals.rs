//! Errors: exit code 2 for bad input, 1 for a failed computation, the message, nothing on stdout, no files.

use std::fs::{self, File};

use crate::common::cases::check_cases;
use crate::common::command::failed;

/// Runs the cases of a file of `tests/command/refusals/` in a folder with a few files that cases name.
fn check(name: &str) {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for (name, content) in [
        ("file", &b""[..]),
        ("shallow.ron", b"(base: \"c_elegans\", limits: (max_depth: 2, max_cells: 100))"),
        ("sweep.ron", b"Sweep(kind: division, axes: [(parameter: \"r0\", list: [1.5, 1.8])])"),
        ("t.csv", b"cell,group,embryo,volume_um3\nAB,wt,e0,11700\nP1,wt,e0,8300\n"),
        ("x.csv", b"a,b\n1,2\n"),
        ("page.md", b"# furrow\n"),
        ("a.nwk", b"(a,b)c;\n"),
        ("latin.json", b"{\n \"schema\": \"\xe9\"}"),
        ("empty.json", b"\xef\xbb\xbf \r\n"),
        ("cut.json", b"{\n  \"schema\": \"furrow.tree\",\n  \"sche"),
        ("other.json", b"{\"schema\": \"furrow.run\", \"schema_version\": 1}"),
    ] {
        fs::write(path(name), content).unwrap();
    }
    fs::copy("data/thresholds.ron", path("thresholds.ron")).unwrap();
    File::create(path("long.json")).unwrap().set_len(600 << 20).unwrap();
    check_cases(&format!("command/refusals/{name}.txt"), |case| failed(folder.path(), case));
}

#[test]
fn what_cannot_be_computed_or_read_is_named() {
    ["parameters", "shapes", "files", "pictures", "scenarios", "sweeps"].into_iter().for_each(check);
}
