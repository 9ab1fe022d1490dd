//! The command line's descriptions of itself, and its warnings.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::common::command;

/// The program builds clap's description of one command if that command is named. It must equal the description among all commands.
#[test]
fn help_of_each_command_is_that_among_all() {
    let whole = furrow::cli::command().term_width(100);
    let names: Vec<String> = whole.get_subcommands().map(|command| command.get_name().to_owned()).collect();
    assert!(names.len() > 15, "{names:?}");
    for name in &names {
        for last in ["--help", "-h", "--version", "--no-such-option"] {
            let words = ["furrow", name, last];
            let expected = whole.clone().try_get_matches_from(words).unwrap_err().to_string();
            let output = command::command(command::HERE, &words[1..]).env("COLUMNS", "100").output().unwrap();
            let said = [output.stdout, output.stderr].concat();
            assert_eq!(String::from_utf8(said).unwrap(), expected, "{words:?}");
        }
    }
}

/// The words in `text` that look like options, without their dashes.
fn options(text: &str) -> impl Iterator<Item = &str> {
    let words = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '-');
    words.filter_map(|word| word.strip_prefix("--")).filter(|name| name.starts_with(|c: char| c.is_ascii_lowercase()))
}

/// The long options of a command and of those below it.
fn all_options(command: &clap::Command, found: &mut BTreeSet<String>) {
    found.extend(
        command
            .get_arguments()
            .flat_map(|arg| arg.get_long_and_visible_aliases().unwrap_or_default())
            .map(str::to_owned),
    );
    command.get_subcommands().for_each(|command| all_options(command, found));
}

/// Messages and help name options; `--features` and `--example` are cargo's.
#[test]
fn options_that_sources_name_exist() {
    // `--of` is a variable of the page's style.
    let mut known: BTreeSet<String> =
        ["help", "version", "features", "example", "no-such-option", "of"].into_iter().map(str::to_owned).collect();
    all_options(&furrow::cli::command(), &mut known);
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let sources = ["src", "crates"].into_iter().flat_map(|folder| sources_below(&root.join(folder)));
    let mut seen = 0;
    for file in sources {
        let text = std::fs::read_to_string(&file).unwrap();
        for name in options(&text).filter(|name| name.len() > 1) {
            assert!(known.contains(name), "{}: --{name}", file.display());
            seen += 1;
        }
    }
    assert!(seen > 200, "{seen}");
}

fn sources_below(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let (folders, files): (Vec<PathBuf>, Vec<PathBuf>) = entries.partition(|path| path.is_dir());
    // A build script runs other programs.
    let is_source =
        |path: &PathBuf| path.extension().is_some_and(|extension| extension == "rs") && !path.ends_with("build.rs");
    let files = files.into_iter().filter(is_source);
    files.chain(folders.iter().flat_map(|folder| sources_below(folder))).collect()
}

/// A command's error does not advise an option of another command.
#[test]
fn advice_names_options_of_the_command() {
    let said = |arguments: &[&str]| {
        let output = command::command(command::HERE, arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        String::from_utf8(output.stderr).unwrap()
    };
    let of_pitchfork = said(&["pitchfork", "--r0", "2", "--xi-max", "5", "--set", "intervals=32"]);
    assert!(of_pitchfork.contains("raise --xi-max"), "{of_pitchfork}");
    let range = ["--vary", "r0", "--from", "0.2", "--to", "0.25", "--no-folds", "--set", "intervals=32"];
    let of_boundary = said(&[&["boundary"][..], &range].concat());
    assert!(of_boundary.contains("pitchfork") && !of_boundary.contains("--xi-max"), "{of_boundary}");
}

/// A command's own options come before the options of all commands.
#[test]
fn help_lists_own_options_first() {
    for words in [&["divide"][..], &["tree"], &["fit", "cue"], &["compare", "volumes"], &["sweep"]] {
        let output = command::command(command::HERE, &[words, &["--help"]].concat()).output().unwrap();
        let help = String::from_utf8(output.stdout).unwrap();
        let place = |option: &str| help.find(option).unwrap_or_else(|| panic!("{words:?}: no {option}: {help}"));
        let own =
            ["--r0 <", "--cue <", "--published", "<DIR>"].iter().filter_map(|option| help.find(option)).min().unwrap();
        assert!(own < place("--preset <") && own < place("--threads <"), "{help}");
    }
}

/// Warnings quote paths, which may hold what moves a terminal's cursor or clears its screen.
#[cfg(unix)]
#[test]
fn warnings_show_control_characters_escaped() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("file"), "").unwrap();
    let cache = folder.path().join("file/a\u{1b}[2Jb");
    let output =
        command::command(folder.path(), &["divide", "--r0", "2"]).env("XDG_CACHE_HOME", &cache).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && said.starts_with(" WARN ") && said.ends_with('\n'), "{said:?}");
    assert!(said.contains("a\\u{1b}[2Jb") && !said.contains('\u{1b}'), "{said:?}");
}

/// Most threads that a command has at once, as Linux counts them.
#[cfg(target_os = "linux")]
fn most_threads(arguments: &[&str]) -> usize {
    let mut child = command::command(command::HERE, arguments).stdout(std::process::Stdio::null()).spawn().unwrap();
    let tasks = format!("/proc/{}/task", child.id());
    let mut most = 0;
    while child.try_wait().unwrap().is_none() {
        most = most.max(std::fs::read_dir(&tasks).map_or(0, Iterator::count));
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    most
}

/// Curves are followed on the global pool, divisions on one of their own.
#[cfg(target_os = "linux")]
#[test]
fn threads_bound_what_is_no_division_too() {
    let with = |threads| most_threads(&["polarity", "--r0", "17.28um", "--threads", threads]);
    let [one, four] = ["1", "4"].map(with);
    assert_eq!(four - one, 3, "{one} {four}");
}
