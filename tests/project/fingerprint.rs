//! The fingerprint that stored results are kept under changes with the code they come from and with nothing else.

use std::{fs, path::Path};

// The page's, in page_artefact.rs, has it too.
#[path = "../../crates/embryo/build.rs"]
#[allow(dead_code, clippy::duplicate_mod)]
mod build_script;

use build_script::{SOLVER_SOURCES, code, solver_files};

#[test]
fn comments_blank_lines_and_tests_are_no_code() {
    let source = r##"//! A module.

/// A function // with two comments.
fn f(x: f64) -> f64 { // the identity

    /* not /* a */
       sum */ x
}

#[cfg(test)]
mod tests {
    /// "}
    #[test]
    fn g() {
        assert!('}' != '{', "}} // {}", r#""}"#);
    }
}
"##;
    assert_eq!(code(source), "fn f(x: f64) -> f64 {\n     x\n}\n");
    assert_eq!(code(&source.replace('\n', "\r\n")), code(source));
    assert_eq!(code("fn f() {}\n\n#[cfg(test)]\nmod tests;\n"), "fn f() {}\n");
}

#[test]
fn literals_are_code_to_the_last_blank() {
    for source in [
        "const A: &str = \"http://a  \n\n  // b \";\n",
        "const A: &str = \"\\\" // a\";\n",
        "const A: &str = r\"\\\"; const B: &str = \" // b\";\n",
        "const A: &[u8] = br##\"\"# // \"##;\n",
        "const A: [char; 3] = ['\"', '\\'', '/'];\n",
        "fn f<'a>(a: &'a str) -> &'a str { a }\n",
    ] {
        assert_eq!(code(source), source);
        assert_eq!(code(&format!("{}// \"a\"\n", source)), source);
    }
}

#[test]
fn tests_that_code_follows_are_kept() {
    let source = "fn f() {}\n#[cfg(test)]\nmod tests {\n}\nfn g() {}\n";
    assert_eq!(code(source), source);
}

#[test]
fn the_code_of_every_source_is_found_and_shorter_than_its_file() {
    let files = solver_files(Path::new(env!("CARGO_MANIFEST_DIR"))).unwrap();
    assert!(files.len() > 10);
    for file in files {
        let source = fs::read_to_string(&file).unwrap();
        let code = code(&source);
        assert!(!code.is_empty() && code.len() < source.len(), "{}", file.display());
        assert!(!code.contains("#[test]") && !code.contains("//!"), "{}", file.display());
    }
}

/// Were a division to depend on a file that is not fingerprinted, a change to it would leave stale results in a store.
#[test]
fn sources_import_nothing_that_is_not_listed() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let inside = |source: &'static str| source.split_once("/src/").map_or(source, |(_, inside)| inside);
    let listed = SOLVER_SOURCES.map(|source| inside(source).trim_end_matches(".rs"));
    for file in solver_files(root).unwrap() {
        // The numerical crates are listed as a whole, and know no other.
        if ["bvp", "spectra"].iter().any(|name| file.starts_with(root.join("crates").join(name))) {
            continue;
        }
        let code = code(&fs::read_to_string(&file).unwrap());
        // A list in braces after `crate::` gives an empty path, which is refused too: one `use` for each floor.
        for import in code.split("crate::").skip(1) {
            let path: String = import.chars().take_while(|c| c.is_alphanumeric() || "_:".contains(*c)).collect();
            // `crate::shapes::passive` is the folder's name for what is in `shapes/passive.rs`.
            let path = path.replace("::", "/").to_lowercase();
            assert!(
                listed.iter().any(|source| path == *source || path.starts_with(&format!("{source}/"))),
                "{} imports crate::{path}, which build.rs does not list",
                file.display()
            );
        }
        // A file listed without its folder reaches its neighbours by `super`. How a division is kept depends on them;
        // what it gives does not.
        let alone = SOLVER_SOURCES.iter().any(|source| root.join(source) == file);
        if alone && !file.ends_with("batch/division.rs") {
            assert!(!code.contains("super::"), "{} imports a neighbour, which build.rs does not list", file.display());
        }
    }
}
