//! Fingerprints the sources that decide what a division gives, so that a stored result never outlives them.

use std::{
    env, fs, io,
    path::{Path, PathBuf},
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
    Ok(())
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
