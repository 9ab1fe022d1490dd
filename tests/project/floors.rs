//! The floors of the crate: each imports only from those below it, so that whoever reads one needs to know no other above.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

mod picture;

/// The modules of the library from the lowest floor to the highest.
const FLOORS: [&str; 18] = [
    "input",
    "cell",
    "cortex",
    "stability",
    "shapes",
    "calibration",
    "division",
    "perturbation",
    "batch",
    "lineage",
    "settings",
    "study",
    "io",
    "report",
    "drawing",
    "plot",
    "movie",
    "cli",
];

/// The crates below all floors.
const NUMERICAL: [&str; 2] = ["spectra", "bvp"];

/// Folders of floors, and the names and colours of their crates in the picture.
const CRATES: [(&str, &str, &str); 4] = [
    ("src", "furrow", "#d55e00"),
    ("crates/figures/src", "figures", "#cc79a7"),
    ("crates/embryo/src", "embryo", "#0072b2"),
    ("crates/mechanics/src", "mechanics", "#e69f00"),
];

/// Every source below a folder, in the order of names.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut entries: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found
}

/// The floor a source of the library belongs to: its folder, or itself; none for the roots.
fn floor_of(sources: &Path, file: &Path) -> Option<usize> {
    let inside = file.strip_prefix(sources).unwrap();
    let name = inside.components().next()?.as_os_str().to_str()?.trim_end_matches(".rs");
    (name != "lib" && name != "main").then(|| {
        let floor = FLOORS.iter().position(|floor| *floor == name);
        floor.unwrap_or_else(|| panic!("{}: {name} is on no floor", file.display()))
    })
}

/// A source with all that is no code blanked out: comments, string and character literals, modules of tests. Lines stay
/// where they are.
fn code_in_place(source: &str) -> String {
    let blank = |text: &str| text.chars().map(|c| if c == '\n' { '\n' } else { ' ' }).collect::<String>();
    let (mut out, mut rest) = (String::new(), source);
    while let Some(first) = rest.chars().next() {
        let length = skipped(rest);
        match length {
            0 => out.push(first),
            _ => out.push_str(&blank(&rest[..length])),
        }
        rest = &rest[length.max(first.len_utf8())..];
    }
    without_tests(&out)
}

/// Bytes at the beginning of some source that are a comment or a literal.
fn skipped(text: &str) -> usize {
    let until = |end: &str, from: usize| text[from..].find(end).map_or(text.len(), |at| from + at + end.len());
    match text.as_bytes() {
        [b'/', b'/', ..] => text.find('\n').unwrap_or(text.len()),
        [b'/', b'*', ..] => until("*/", 2),
        [b'r', b'"', ..] => until("\"", 2),
        [b'r', b'#', b'"', ..] => until("\"#", 3),
        [b'"', rest @ ..] => {
            let mut escaped = false;
            let end = rest.iter().position(|&byte| {
                let ends = byte == b'"' && !escaped;
                escaped = byte == b'\\' && !escaped;
                ends
            });
            end.map_or(text.len(), |end| end + 2)
        }
        [b'\'', b'\\', _, ..] => until("'", 3),
        [b'\'', ..] => {
            // A lifetime has no quote behind its first letter.
            let letter = text[1..].chars().next().map_or(0, char::len_utf8);
            if text[1 + letter..].starts_with('\'') { letter + 2 } else { 0 }
        }
        _ => 0,
    }
}

/// Blanks the blocks behind `#[cfg(test)]`.
fn without_tests(code: &str) -> String {
    let mut out = code.to_owned();
    while let Some(at) = out.find("#[cfg(test)]") {
        let end = match out[at..].find(['{', ';']) {
            Some(open) if out[at + open..].starts_with('{') => at + open + block(&out[at + open..]),
            Some(semicolon) => at + semicolon + 1,
            None => out.len(),
        };
        let blank: String = out[at..end].chars().map(|c| if c == '\n' { '\n' } else { ' ' }).collect();
        out.replace_range(at..end, &blank);
    }
    out
}

/// Bytes of the block in braces that the text begins with.
fn block(text: &str) -> usize {
    let mut depth = 0;
    for (at, c) in text.char_indices() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        if depth == 0 {
            return at + 1;
        }
    }
    text.len()
}

/// The modules at the root of the crate that code names, each with its line.
fn imports(code: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let word = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    for (at, path) in code.match_indices("crate::") {
        if code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_') {
            continue;
        }
        let line = |offset: usize| code[..offset].matches('\n').count() + 1;
        let behind = at + path.len();
        if !code[behind..].starts_with('{') {
            found.push((line(at), word(&code[behind..])));
            continue;
        }
        // A list: what stands behind its brace and behind every comma that is not in a list of its own.
        let (mut depth, mut begins) = (0, true);
        for (offset, c) in code[behind..behind + block(&code[behind..])].char_indices() {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 1 => begins = true,
                c if begins && depth == 1 && !c.is_whitespace() => {
                    found.push((line(behind + offset), word(&code[behind + offset..])));
                    begins = false;
                }
                _ => {}
            }
        }
    }
    found
}

#[test]
fn no_floor_imports_from_above() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (mut offenders, mut seen) = (Vec::new(), 0);
    // What decides a division, what is built on divisions, pictures, and the command line.
    let folders =
        ["crates/mechanics/src", "crates/embryo/src", "crates/figures/src", "src"].map(|folder| root.join(folder));
    for (folder, file) in folders.iter().flat_map(|folder| sources(folder).into_iter().map(move |file| (folder, file)))
    {
        let Some(own) = floor_of(folder, &file) else { continue };
        // Files of tests alone, which `#[cfg(test)] mod` names, are part of no floor.
        if ["tests.rs", "fake.rs"].iter().any(|name| file.ends_with(name)) {
            continue;
        }
        for (line, module) in imports(&code_in_place(&fs::read_to_string(&file).unwrap())) {
            let place = format!("{}:{line}", file.strip_prefix(root).unwrap().display());
            match FLOORS.iter().position(|floor| *floor == module) {
                Some(floor) if floor <= own => seen += 1,
                Some(_) => offenders.push(format!("{place}: {} imports {module}, which is above it", FLOORS[own])),
                None => offenders.push(format!("{place}: {module} is on no floor")),
            }
        }
    }
    assert!(offenders.is_empty(), "{}", offenders.join("\n"));
    assert!(seen > 100, "only {seen} imports seen");
}

/// Which floors the code of each floor names, the numerical crates among them.
fn imports_of_floors(root: &Path) -> BTreeSet<(&'static str, &'static str)> {
    let mut found = BTreeSet::new();
    for folder in ["crates/mechanics/src", "crates/embryo/src", "crates/figures/src", "src"] {
        let folder = root.join(folder);
        for file in sources(&folder) {
            if ["tests.rs", "fake.rs"].iter().any(|name| file.ends_with(name)) {
                continue;
            }
            let Some(own) = floor_of(&folder, &file) else { continue };
            let code = code_in_place(&fs::read_to_string(&file).unwrap());
            for (_, module) in imports(&code) {
                found.extend(FLOORS.iter().find(|floor| **floor == module).map(|below| (FLOORS[own], *below)));
            }
            for numerical in NUMERICAL {
                let named = code
                    .match_indices(&format!("{numerical}::"))
                    .any(|(at, _)| !code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_'));
                found.extend(named.then_some((FLOORS[own], numerical)));
            }
        }
    }
    found
}

/// The picture in the documentation is drawn from the sources. `FURROW_DRAW=1 cargo test --test project floors` draws it anew.
#[test]
fn the_picture_of_the_floors_is_that_of_the_code() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut groups: Vec<picture::Group> = Vec::new();
    for floor in FLOORS.iter().rev().chain(&NUMERICAL) {
        let (name, colour) = CRATES
            .iter()
            .find_map(|(folder, name, colour)| {
                let path = root.join(folder);
                (path.join(floor).is_dir() || path.join(format!("{floor}.rs")).is_file()).then_some((*name, *colour))
            })
            .unwrap_or(("numerics", "#009e73"));
        match groups.last_mut() {
            Some(last) if last.0 == name => last.2.push(floor),
            _ => groups.push((name, colour, vec![floor])),
        }
    }
    assert_eq!(groups.len(), 5, "floors of one crate stand together: {groups:?}");
    let (file, drawn) = (root.join("docs/floors.svg"), picture::picture(&groups, &imports_of_floors(root)));
    if std::env::var_os("FURROW_DRAW").is_some() {
        fs::write(&file, &drawn).unwrap();
    }
    let kept = fs::read_to_string(&file).unwrap_or_default().replace('\r', "");
    assert!(
        kept == drawn,
        "docs/floors.svg is not that of the code: FURROW_DRAW=1 cargo test --test project floors draws it anew"
    );
}

#[test]
fn the_numerical_crates_know_no_cell() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut offenders = Vec::new();
    let folders = ["bvp", "spectra"].map(|name| root.join("crates").join(name));
    let mut files: Vec<PathBuf> = folders.iter().flat_map(|folder| sources(folder)).collect();
    files.extend(folders.map(|folder| folder.join("Cargo.toml")));
    assert!(files.len() > 20);
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        // The standard library has a `Cell` too.
        let own = text.contains("std::cell::Cell");
        for (k, line) in text.lines().enumerate() {
            // Their names on the registry begin with the name of the program.
            let line =
                ["furrow-bvp", "furrow_bvp", "furrow-spectra"].iter().fold(line.to_owned(), |l, n| l.replace(n, ""));
            let words = line.split(|c: char| !c.is_alphanumeric() && c != '_');
            let foreign =
                |word: &&str| ["furrow", "cortex"].contains(&word.to_lowercase().as_str()) || *word == "Cell" && !own;
            for word in words.filter(foreign) {
                let place = file.strip_prefix(root).unwrap().display();
                offenders.push(format!("{place}:{}: {word}", k + 1));
            }
        }
    }
    assert!(offenders.is_empty(), "{}", offenders.join("\n"));
}

#[test]
fn imports_are_found_in_lists_and_not_in_comments_and_tests() {
    let source = "//! crate::cli\nuse crate::{\n    cell::{Cell, Cue},\n    io,\n};\nfn f() { let x = \"crate::report\"; crate::batch::g('{', x) }\n\
                  #[cfg(test)]\nmod tests {\n    use crate::cli;\n}\nuse bvp_crate::y;\n/* crate::cli */ use crate::lineage::{io, A};\n";
    let found = imports(&code_in_place(source));
    let expected = [(3, "cell"), (4, "io"), (6, "batch"), (12, "lineage")];
    assert_eq!(found, expected.map(|(line, module)| (line, module.to_owned())));
}
