//! What furrow depends on: licences, sources and versions of Rust, held to `deny.toml` and `Cargo.toml` without any tool. What
//! needs one, known vulnerabilities, `.ci/run` asks `cargo deny` where it is installed.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// All packages of the workspace and what they depend on, with all features and on all platforms.
fn packages() -> Vec<Value> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let arguments = ["metadata", "--format-version", "1", "--all-features", "--locked"];
    let ask = |more: &[&str]| {
        Command::new(&cargo).args(arguments).args(more).current_dir(env!("CARGO_MANIFEST_DIR")).output().unwrap()
    };
    // What the program is built from is here; what other members of the workspace need, that for Python, may have to be fetched.
    let here = ask(&["--offline"]);
    let output = if here.status.success() { here } else { ask(&[]) };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    metadata["packages"].as_array().unwrap().clone()
}

fn text<'p>(package: &'p Value, field: &str) -> &'p str {
    package[field].as_str().unwrap_or("")
}

/// The licences that `deny.toml` allows.
fn allowed() -> Vec<String> {
    let file = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("deny.toml")).unwrap();
    let (_, behind) = file.split_once("allow = [").expect("deny.toml has a list of licences");
    let (list, _) = behind.split_once(']').unwrap();
    list.split('"').skip(1).step_by(2).map(str::to_owned).collect()
}

/// Whether a licence expression can be met by licences that are allowed: all of what `AND` joins, one of what `OR` does.
/// Parentheses, and the older `/` for `OR`, are understood.
fn is_allowed(expression: &str, allowed: &[String]) -> bool {
    let expression = expression.replace('/', " OR ");
    let expression = expression.trim();
    let split = |word: &str| {
        let (mut depth, mut parts, mut from) = (0, Vec::new(), 0);
        for (at, c) in expression.char_indices() {
            depth += i32::from(c == '(') - i32::from(c == ')');
            if depth == 0 && expression[at..].starts_with(word) {
                parts.push(expression[from..at].to_owned());
                from = at + word.len();
            }
        }
        parts.push(expression[from..].to_owned());
        parts
    };
    let (either, both) = (split(" OR "), split(" AND "));
    if either.len() > 1 {
        either.iter().any(|part| is_allowed(part, allowed))
    } else if both.len() > 1 {
        both.iter().all(|part| is_allowed(part, allowed))
    } else if let Some(inside) = expression.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')) {
        is_allowed(inside, allowed)
    } else {
        allowed.iter().any(|licence| licence == expression)
    }
}

#[test]
fn licences_are_those_that_deny_toml_allows() {
    let allowed = allowed();
    assert!(allowed.iter().any(|licence| licence == "MIT"), "{allowed:?}");
    let packages = packages();
    assert!(packages.len() > 100, "{}", packages.len());
    for package in &packages {
        let licence = text(package, "license");
        assert!(is_allowed(licence, &allowed), "{} {}: {licence}", text(package, "name"), text(package, "version"));
    }
}

#[test]
fn expressions_of_licences_are_understood() {
    let allowed = ["MIT", "Zlib"].map(str::to_owned);
    for (expression, may) in [
        ("MIT", true),
        ("GPL-3.0", false),
        ("GPL-3.0 OR MIT", true),
        ("GPL-3.0/MIT", true),
        ("MIT AND GPL-3.0", false),
        ("(MIT OR GPL-3.0) AND Zlib", true),
        ("(MIT OR GPL-3.0) AND (GPL-3.0 OR BSL-1.0)", false),
        ("", false),
    ] {
        assert_eq!(is_allowed(expression, &allowed), may, "{expression}");
    }
}

/// Everything is from here or from the registry of crates, where no version ever changes.
#[test]
fn sources_are_this_folder_and_the_registry() {
    for package in packages() {
        let source = text(&package, "source");
        let known = source.is_empty() || source == "registry+https://github.com/rust-lang/crates.io-index";
        assert!(known, "{}: {source}", text(&package, "name"));
    }
}

/// The oldest compiler that furrow is said to need is one that its dependencies are content with.
#[test]
fn no_dependency_needs_a_later_rust_than_furrow() {
    let number = |version: &str| {
        let parts: Vec<u32> = version.split('.').map(|part| part.parse().unwrap()).collect();
        [parts[0], parts[1], parts.get(2).copied().unwrap_or(0)]
    };
    let own = number(env!("CARGO_PKG_RUST_VERSION"));
    for package in packages() {
        let needs = text(&package, "rust_version");
        assert!(needs.is_empty() || number(needs) <= own, "{} needs Rust {needs}", text(&package, "name"));
    }
}
