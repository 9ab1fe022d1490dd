//! Fingerprints the sources that decide what a division gives, so that a stored result never outlives them, and records
//! the git commit a release binary is built from.

use std::{
    env, fs, io,
    path::{Path, PathBuf},
    process::Command,
};

/// What a division is computed by, and how it is kept: files, and folders with all that is in them.
///
/// A change to the code of any of them gives a new fingerprint, a change to its comments or tests does not. Whatever the
/// files here import must be here too; `tests/project/fingerprint.rs` checks it.
pub const SOLVER_SOURCES: [&str; 10] = [
    "crates/bvp/src",
    "crates/embryo/src/batch/division.rs",
    "crates/mechanics/src/cell",
    "crates/mechanics/src/cortex",
    "crates/mechanics/src/division",
    "crates/mechanics/src/input",
    "crates/mechanics/src/shapes/error.rs",
    "crates/mechanics/src/shapes/passive.rs",
    "crates/mechanics/src/stability.rs",
    "crates/spectra/src",
];

fn main() -> io::Result<()> {
    // The folder of the whole: this crate is in `crates/embryo`.
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default()).join("../..");
    let hash = fingerprint(&root, &SOLVER_SOURCES)?;
    for source in SOLVER_SOURCES {
        println!("cargo::rerun-if-changed={}", root.join(source).display());
    }
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-env=FURROW_SOLVER_FINGERPRINT={hash}");
    record_commit(&root);
    Ok(())
}

/// The fingerprint of the code of some sources: files, and folders with all that is in them.
///
/// # Errors
/// A source that is not there.
pub fn fingerprint(root: &Path, sources: &[&str]) -> io::Result<u64> {
    let mut hash = FNV_OFFSET;
    for file in files_of(root, sources)? {
        let name = file.strip_prefix(root).unwrap_or(&file).to_string_lossy().replace('\\', "/");
        let code = code(&fs::read_to_string(&file)?);
        // With their lengths, so that nothing moves from one file or name to the next unnoticed.
        for part in [name.as_bytes(), code.as_bytes()] {
            hash = fnv1a(hash, &(part.len() as u64).to_le_bytes());
            hash = fnv1a(hash, part);
        }
    }
    Ok(hash)
}

/// The files of [`SOLVER_SOURCES`], in the order of their names.
///
/// # Errors
/// A source that is not there: the list must follow when something is moved.
pub fn solver_files(root: &Path) -> io::Result<Vec<PathBuf>> {
    files_of(root, &SOLVER_SOURCES)
}

/// The files of some sources, in the order of their names.
///
/// # Errors
/// As [`fingerprint`].
pub fn files_of(root: &Path, sources: &[&str]) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for source in sources {
        collect(&root.join(source), &mut files)
            .map_err(|error| io::Error::new(error.kind(), format!("{source}, listed in build.rs: {error}")))?;
    }
    files.sort();
    Ok(files)
}

fn collect(path: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    // Files and folders of tests alone.
    if path.ends_with("tests.rs") || path.ends_with("tests") {
        return Ok(());
    }
    if fs::metadata(path)?.is_dir() {
        for entry in fs::read_dir(path)? {
            collect(&entry?.path(), files)?;
        }
    } else if path.extension().is_some_and(|extension| extension == "rs" || extension == "json") {
        files.push(path.to_owned());
    }
    Ok(())
}

/// A piece of Rust source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Piece<'t> {
    Code(&'t str),
    /// A string, byte string or character, quotes included.
    Literal(&'t str),
    Comment,
}

/// The code of a Rust source: without comments, blank lines, carriage returns and a module of tests at its end.
pub fn code(source: &str) -> String {
    // Line endings differ between checkouts of one commit; what is compiled does not.
    let source = source.replace('\r', "");
    let mut code = String::with_capacity(source.len());
    // Blanks before here are inside a literal, where they mean something.
    let mut kept = 0;
    for piece in pieces(&source) {
        match piece {
            Piece::Code(text) => {
                for line in text.split_inclusive('\n') {
                    code.push_str(line.trim_end());
                    if line.ends_with('\n') {
                        end_line(&mut code, kept);
                    } else {
                        code.push_str(&line[line.trim_end().len()..]);
                    }
                }
            }
            Piece::Literal(text) => {
                code.push_str(text);
                kept = code.len();
            }
            Piece::Comment => {}
        }
    }
    without_tests(&code).to_owned()
}

/// Ends the last line of `code` unless it is blank.
fn end_line(code: &mut String, kept: usize) {
    let end = kept + code[kept..].trim_end_matches(' ').len();
    code.truncate(end);
    if !code.is_empty() && !code[kept..].ends_with('\n') {
        code.push('\n');
    }
}

/// Cuts off a module that is compiled for tests only, if it is the last thing in `code`.
fn without_tests(code: &str) -> &str {
    let Some(start) = code.rfind("\n#[cfg(test)]\nmod ") else { return code };
    let (before, module) = code.split_at(start + 1);
    let mut depth = 0;
    let mut place = 0;
    for piece in pieces(module) {
        let text = match piece {
            Piece::Code(text) => text,
            Piece::Literal(text) => {
                place += text.len();
                continue;
            }
            Piece::Comment => continue,
        };
        for (offset, character) in text.char_indices() {
            depth += match character {
                '{' => 1,
                '}' => -1,
                _ => 0,
            };
            let ends = (character == '}' || character == ';') && depth == 0;
            if ends {
                let rest = &module[place + offset + 1..];
                return if rest.trim().is_empty() { before } else { code };
            }
        }
        place += text.len();
    }
    code
}

/// Takes a source apart.
fn pieces(source: &str) -> Vec<Piece<'_>> {
    let mut pieces = Vec::new();
    // Where the code that is being read began.
    let mut start = 0;
    let mut place = 0;
    while place < source.len() {
        let rest = &source[place..];
        let found = if rest.starts_with("//") {
            Some((rest.find('\n').unwrap_or(rest.len()), false))
        } else if rest.starts_with("/*") {
            Some((block_comment(rest), false))
        } else {
            literal(rest, &source[..place]).map(|length| (length, true))
        };
        match found {
            Some((length, is_literal)) => {
                if start < place {
                    pieces.push(Piece::Code(&source[start..place]));
                }
                pieces.push(if is_literal { Piece::Literal(&rest[..length]) } else { Piece::Comment });
                place += length;
                start = place;
            }
            None => place += rest.chars().next().map_or(1, char::len_utf8),
        }
    }
    if start < place {
        pieces.push(Piece::Code(&source[start..place]));
    }
    pieces
}

/// Length of the block comment at the start of `text`; they nest.
fn block_comment(text: &str) -> usize {
    let mut depth = 0;
    let mut place = 0;
    while place < text.len() {
        let rest = &text[place..];
        let step = if rest.starts_with("/*") {
            depth += 1;
            2
        } else if rest.starts_with("*/") {
            depth -= 1;
            2
        } else {
            rest.chars().next().map_or(1, char::len_utf8)
        };
        place += step;
        if depth == 0 {
            break;
        }
    }
    place
}

/// Length of the string or character at the start of `text`, if there is one; `before` is what stands before it.
fn literal(text: &str, before: &str) -> Option<usize> {
    if let Some(inside) = text.strip_prefix('"') {
        // What follows r, br or cr, with or without #, is raw: a backslash in it is a backslash.
        let hashes = before.len() - before.trim_end_matches('#').len();
        let prefix = before[..before.len() - hashes].trim_end_matches(|c: char| c.is_alphanumeric() || c == '_');
        if ["r", "br", "cr"].contains(&&before[prefix.len()..before.len() - hashes]) {
            let end = format!("\"{}", "#".repeat(hashes));
            return Some(inside.find(&end).map_or(text.len(), |at| 1 + at + end.len()));
        }
        return Some(escaped_until('"', text));
    }
    // Other quotes begin a lifetime.
    let mut characters = text.strip_prefix('\'')?.chars();
    let is_character = characters.next()? == '\\' || characters.next()? == '\'';
    is_character.then(|| escaped_until('\'', text))
}

/// Length of `text` up to and with the second `quote` that no backslash stands before.
fn escaped_until(quote: char, text: &str) -> usize {
    let mut escaped = false;
    for (place, character) in text.char_indices().skip(1) {
        match character {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            _ if character == quote => return place + 1,
            _ => {}
        }
    }
    text.len()
}

const FNV_OFFSET: u64 = 0xcbf2_9ce4_8422_2325;

/// The 64-bit FNV-1a hash continued over `bytes`.
fn fnv1a(hash: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(hash, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

/// Sets `FURROW_COMMIT` where the crate is a git checkout of its own; a copy without git builds without it.
fn record_commit(root: &Path) {
    // Debug builds skip it: they would be rebuilt after every commit. So does what runs in a page, which is kept in the
    // repository and cannot know the commit that it will be part of.
    let in_page = env::var("CARGO_CFG_TARGET_FAMILY").as_deref() == Ok("wasm");
    if env::var("PROFILE").as_deref() != Ok("release") || in_page {
        return;
    }
    // A crate unpacked inside some other repository must not take that repository's commit for its own.
    let top = git(&["rev-parse", "--show-toplevel"]).and_then(|top| Path::new(&top).canonicalize().ok());
    if top.is_none() || top != root.canonicalize().ok() {
        return;
    }
    println!("cargo::rerun-if-changed={}", root.join("src").display());
    println!("cargo::rerun-if-changed={}", root.join("crates").display());
    for name in ["HEAD", "logs/HEAD"] {
        if let Some(path) = git(&["rev-parse", "--git-path", name]).filter(|path| Path::new(path).exists()) {
            println!("cargo::rerun-if-changed={path}");
        }
    }
    if let Some(commit) = git(&["rev-parse", "HEAD"]) {
        let modified = git(&["status", "--porcelain", "--untracked-files=no"]).is_some_and(|list| !list.is_empty());
        println!("cargo::rustc-env=FURROW_COMMIT={commit}{}", if modified { "-modified" } else { "" });
    }
}

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}
