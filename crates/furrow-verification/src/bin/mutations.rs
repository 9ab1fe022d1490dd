//! Puts one small error after another into a copy of the repository, runs the test that must fail, and reports whether it does.
//!
//! ```sh
//! cargo run -p furrow-verification --bin mutations                 # all mutants of mutants.ron
//! cargo run -p furrow-verification --bin mutations -- friction     # mutants whose name contains a word
//! cargo run -p furrow-verification --bin mutations -- --write      # also writes the table in docs/mutations.md
//! ```
//!
//! The copy and its build are kept in `target/mutations`. The run stops if a mutant does not apply or does not compile, or if
//! a test fails without a mutant.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use furrow_verification::mutants::{Mutant, root, table};

/// A test that takes longer is stopped; its mutant counts as killed.
const PATIENCE: Duration = Duration::from_secs(300);

/// Folders that the build does not need.
const LEFT_OUT: [&str; 5] = ["target", ".git", "docs", "furrow-out", "node_modules"];

/// How a test ended.
enum Ended {
    Passed,
    /// With its output.
    Failed(String),
    Stopped,
}

/// The result for one mutant.
struct Verdict<'a> {
    mutant: &'a Mutant,
    killed: bool,
    /// The value that the test found and the allowed one.
    off: String,
}

fn main() -> ExitCode {
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    let write = words.iter().any(|word| word == "--write");
    words.retain(|word| word != "--write");
    match run(&words, write) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("mutations: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Runs the mutants whose names contain any of `words`, or all if there are none. True if all were killed.
fn run(words: &[String], write: bool) -> Result<bool, String> {
    let root = root().canonicalize().map_err(|e| e.to_string())?;
    let scratch = root.join("target/mutations");
    let tree = scratch.join("tree");
    let all = table(&root)?;
    let chosen: Vec<&Mutant> =
        all.iter().filter(|m| words.is_empty() || words.iter().any(|word| m.name.contains(word))).collect();
    if chosen.is_empty() {
        return Err(format!("no mutant's name contains any of {words:?}"));
    }
    copy(&root, &tree).map_err(|e| format!("copying the repository: {e}"))?;
    for mutant in &all {
        for edit in &mutant.edits {
            edit.applied(&tree).map_err(|e| format!("{}: {e}", mutant.name))?;
        }
    }
    check_unharmed(&tree, &chosen)?;
    let mut verdicts = Vec::new();
    for (k, mutant) in chosen.iter().enumerate() {
        let begun = Instant::now();
        let verdict = verdict(&tree, mutant)?;
        let word = if verdict.killed { "killed" } else { "SURVIVED" };
        println!(
            "{:>3}/{} {word:<8} {:<38} {} ({} s)",
            k + 1,
            chosen.len(),
            mutant.name,
            verdict.off,
            begun.elapsed().as_secs()
        );
        verdicts.push(verdict);
    }
    let killed = verdicts.iter().filter(|verdict| verdict.killed).count();
    println!("{killed} of {} killed", verdicts.len());
    if write {
        let page = root.join("docs/mutations.md");
        write_table(&page, &all, &verdicts).map_err(|e| format!("{}: {e}", page.display()))?;
    }
    Ok(killed == verdicts.len())
}

/// Copies the files that differ, so that little is compiled again.
fn copy(from: &Path, to: &Path) -> io::Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let (name, there) = (entry.file_name(), to.join(entry.file_name()));
        if LEFT_OUT.iter().any(|left_out| name == *left_out) {
            continue;
        }
        if entry.file_type()?.is_dir() {
            copy(&entry.path(), &there)?;
        } else {
            let text = fs::read(entry.path())?;
            if fs::read(&there).ok().as_ref() != Some(&text) {
                fs::write(&there, text)?;
            }
        }
    }
    Ok(())
}

/// Checks that all tests pass without a mutant.
fn check_unharmed(tree: &Path, mutants: &[&Mutant]) -> Result<(), String> {
    let mut tests: Vec<&(String, String)> = mutants.iter().map(|mutant| &mutant.killed_by).collect();
    tests.sort();
    tests.dedup();
    println!("{} tests without a mutant …", tests.len());
    for test in tests {
        match run_test(tree, test)? {
            Ended::Passed => {}
            Ended::Failed(said) => return Err(format!("{}: {} fails without a mutant\n{said}", test.0, test.1)),
            Ended::Stopped => return Err(format!("{}: {} does not end without a mutant", test.0, test.1)),
        }
    }
    Ok(())
}

fn verdict<'a>(tree: &Path, mutant: &'a Mutant) -> Result<Verdict<'a>, String> {
    let fits = |error: String| format!("{}: {error}", mutant.name);
    // A file may have several edits: they are undone in reverse order.
    let mut before: Vec<(PathBuf, String)> = Vec::new();
    for edit in &mutant.edits {
        let path = tree.join(&edit.file);
        let changed = edit.applied(tree).map_err(fits)?;
        before.push((path.clone(), fs::read_to_string(&path).map_err(|e| fits(e.to_string()))?));
        fs::write(&path, changed).map_err(|e| fits(e.to_string()))?;
    }
    let ended = run_test(tree, &mutant.killed_by);
    for (path, text) in before.iter().rev() {
        fs::write(path, text).map_err(|e| fits(e.to_string()))?;
    }
    Ok(match ended.map_err(fits)? {
        Ended::Passed => Verdict { mutant, killed: false, off: "passes".to_owned() },
        Ended::Failed(said) => Verdict { mutant, killed: true, off: how_far_off(&said) },
        Ended::Stopped => Verdict { mutant, killed: true, off: "does not end".to_owned() },
    })
}

/// Builds one test program of the copy and returns its path.
fn build(tree: &Path, file: &str) -> Result<PathBuf, String> {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(tree).env("CARGO_TARGET_DIR", tree.with_file_name("target")).env("CARGO_PROFILE_DEV_DEBUG", "0");
    cargo.args(["test", "--locked", "-p", "furrow-verification", "--test", file, "--no-run"]);
    let built = cargo.output().map_err(|e| format!("cargo: {e}"))?;
    let said = String::from_utf8_lossy(&built.stderr);
    if !built.status.success() {
        return Err(format!("does not compile\n{said}"));
    }
    // Executable tests/virtual_power.rs (/…/target/debug/deps/virtual_power-0123456789abcdef)
    let program = said.lines().rev().find(|line| line.contains("Executable"));
    let path = program.and_then(|line| line.split_once('(')?.1.strip_suffix(')'));
    path.map(|path| tree.join(path)).ok_or_else(|| format!("no executable of {file} in\n{said}"))
}

/// Builds and runs one test of the copy.
fn run_test(tree: &Path, (file, name): &(String, String)) -> Result<Ended, String> {
    let program = build(tree, file)?;
    let log = tree.with_file_name("log");
    let said = File::create(&log).map_err(|e| format!("{}: {e}", log.display()))?;
    let wrong = said.try_clone().map_err(|e| e.to_string())?;
    let mut child = Command::new(&program)
        .args(["--exact", name, "--nocapture"])
        .current_dir(tree.join("crates/furrow-verification"))
        .env("RUST_BACKTRACE", "0")
        .stdout(Stdio::from(said))
        .stderr(Stdio::from(wrong))
        .spawn()
        .map_err(|e| format!("{}: {e}", program.display()))?;
    let begun = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().map_err(|e| e.to_string())? {
            break status;
        }
        if begun.elapsed() > PATIENCE {
            child.kill().map_err(|e| e.to_string())?;
            child.wait().map_err(|e| e.to_string())?;
            return Ok(Ended::Stopped);
        }
        sleep(Duration::from_millis(50));
    };
    let said = fs::read(&log).map_err(|e| e.to_string())?;
    let said = String::from_utf8_lossy(&said).into_owned();
    if !said.contains("running 1 test") {
        return Err(format!("there is no test {name} in {file}"));
    }
    Ok(if status.success() { Ended::Passed } else { Ended::Failed(said) })
}

/// The found and the allowed value in the output of a failed test, or its panic message.
fn how_far_off(said: &str) -> String {
    if let Some(line) = said.lines().rev().find(|line| line.contains(", allowed is ")) {
        let numbers = line.rsplit(": ").next().unwrap_or(line);
        return numbers.replace(", allowed is ", ", allowed ");
    }
    let mut lines = said.lines().skip_while(|line| !line.contains("panicked at"));
    let message = lines.nth(1).unwrap_or("fails");
    let short: String = message.chars().take(60).collect();
    if short.len() < message.len() { format!("“{short}…”") } else { format!("“{short}”") }
}

const BEGIN: &str = "<!-- begin: written by `cargo run -p furrow-verification --bin mutations -- --write` -->";
const END: &str = "<!-- end -->";

/// Writes the table between its two marks in a page. Mutants without a verdict keep their old row.
fn write_table(page: &Path, all: &[Mutant], verdicts: &[Verdict<'_>]) -> io::Result<()> {
    let text = fs::read_to_string(page)?;
    let missing = || io::Error::other("the marks of the table are missing");
    let (before, rest) = text.split_once(BEGIN).ok_or_else(missing)?;
    let (old, after) = rest.split_once(END).ok_or_else(missing)?;
    let mut table = String::from("\n| mutant | what it does | test that sees it | how far off |\n|---|---|---|---|\n");
    for mutant in all {
        let begins = format!("| {} | {} |", mutant.name, mutant.means);
        match verdicts.iter().find(|verdict| verdict.mutant.name == mutant.name) {
            Some(Verdict { killed, off, .. }) => {
                let (file, test) = &mutant.killed_by;
                let seen = if *killed { format!("`{file}`: `{test}`") } else { "**none**".to_owned() };
                table += &format!("{begins} {seen} | {} |\n", off.replace('|', "/"));
            }
            None => old.lines().filter(|line| line.starts_with(&begins)).for_each(|line| table += &format!("{line}\n")),
        }
    }
    fs::write(page, format!("{before}{BEGIN}\n{table}\n{END}{after}"))
}
