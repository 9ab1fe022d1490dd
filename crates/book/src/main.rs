//! Puts the book together in `target/book` and has mdBook build it there, if it is installed.

use std::path::Path;
use std::process::{Command, ExitCode};

fn main() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let out = root.join("target/book");
    match book::stage::stage(&root, &out) {
        Ok(chapters) => println!("{chapters} chapters in target/book/src"),
        Err(error) => {
            eprintln!("furrow-book: {error}");
            return ExitCode::FAILURE;
        }
    }
    match Command::new("mdbook").arg("build").arg(&out).status() {
        Ok(status) if status.success() => {
            println!("the book is target/book/html/index.html");
            ExitCode::SUCCESS
        }
        Ok(_) => ExitCode::FAILURE,
        Err(_) => {
            println!("mdbook is not installed, so that no HTML was made: cargo install mdbook --locked");
            ExitCode::SUCCESS
        }
    }
}
