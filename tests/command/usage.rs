//! What the command line says of itself, and its warnings.

use crate::common::command;

/// The program tells clap of one command where one is named; clap must say the same of it as among all.
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
