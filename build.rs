//! Fingerprints the sources that decide what a division gives, so that a stored result never outlives them, and records
//! the git commit a release binary is built from.

use std::{
    env, fs, io,
    path::{Path, PathBuf},
    process::Command,
};

/// The floors a division is computed by. A change to any file below them gives a new fingerprint.
const SOLVER_FOLDERS: [&str; 4] = ["src/numerics", "src/cortex", "src/steady", "src/division"];

fn main() -> io::Result<()> {
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let mut files = Vec::new();
    for folder in SOLVER_FOLDERS {
        let folder = root.join(folder);
        if folder.is_dir() {
            println!("cargo::rerun-if-changed={}", folder.display());
            collect(&folder, &mut files)?;
        }
    }
    files.sort();
    let mut hash = FNV_OFFSET;
    for file in &files {
        let name = file.strip_prefix(&root).unwrap_or(file).to_string_lossy().replace('\\', "/");
        hash = fnv1a(hash, name.as_bytes());
        // Line endings differ between checkouts of one commit; what is compiled does not.
        let text: Vec<u8> = fs::read(file)?.into_iter().filter(|&byte| byte != b'\r').collect();
        hash = fnv1a(hash, &(text.len() as u64).to_le_bytes());
        hash = fnv1a(hash, &text);
    }
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-env=FURROW_SOLVER_FINGERPRINT={hash}");
    record_commit(&root);
    Ok(())
}

/// Sets `FURROW_COMMIT` where the crate is a git checkout of its own; a copy without git builds without it.
fn record_commit(root: &Path) {
    // Debug builds skip it: they would be rebuilt after every commit.
    if env::var("PROFILE").as_deref() != Ok("release") {
        return;
    }
    // A crate unpacked inside some other repository must not take that repository's commit for its own.
    let top = git(&["rev-parse", "--show-toplevel"]).and_then(|top| Path::new(&top).canonicalize().ok());
    if top.is_none() || top != root.canonicalize().ok() {
        return;
    }
    println!("cargo::rerun-if-changed=src");
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

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    Ok(())
}

const FNV_OFFSET: u64 = 0xcbf2_9ce4_8422_2325;

/// The 64-bit FNV-1a hash continued over `bytes`.
fn fnv1a(hash: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(hash, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}
