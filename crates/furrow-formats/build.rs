//! Sets `FURROW_COMMIT` where the crate is in furrow's own git checkout. Elsewhere it is not set.

use std::{env, path::Path, process::Command};

/// This crate's folder in the checkout.
const FOLDER: &str = "crates/furrow-formats/";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // Debug builds skip it: they would be rebuilt after every commit. So does the module of the page, which is committed and
    // cannot know its own commit.
    let in_page = env::var("CARGO_CFG_TARGET_FAMILY").as_deref() == Ok("wasm");
    if env::var("PROFILE").as_deref() != Ok("release") || in_page {
        return;
    }
    // A copy inside another repository (packaged, vendored, in a registry) must not take that repository's commit for its own.
    if git(&["rev-parse", "--show-prefix"]).as_deref() != Some(FOLDER) {
        return;
    }
    for folder in ["../../src", ".."] {
        println!("cargo::rerun-if-changed={folder}");
    }
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
