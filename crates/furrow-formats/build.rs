//! Sets `FURROW_COMMIT` where the crate is in a git checkout of its own. A copy without git builds without it.

use std::{
    env,
    path::{Path, PathBuf},
    process::Command,
};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // The root of the workspace.
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default()).join("../..");
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
