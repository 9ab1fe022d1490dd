//! Names of temporary files, and removal of files that killed runs left behind.

use std::fs::{self, DirEntry};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;
use std::time::{Duration, SystemTime};

/// How all names begin and end. Between them are the machine, the process and random letters.
const PREFIX: &str = ".furrow-";
pub(crate) const SUFFIX: &str = ".tmp";

/// Age from which any temporary file is stale, whichever process made it: a run renames its files within seconds.
const STALE: Duration = Duration::from_secs(24 * 3600);

/// How the names of this process begin.
pub(crate) fn prefix() -> String {
    format!("{PREFIX}{:08x}-{}-", machine(), std::process::id())
}

/// A number of the running system and of the process numbers in it, which differ between containers; 0 where it is not known.
fn machine() -> u32 {
    let boot = fs::read_to_string("/proc/sys/kernel/random/boot_id").ok();
    let numbers = fs::read_link("/proc/self/ns/pid").ok();
    let Some(both) = boot.zip(numbers) else { return 0 };
    let mut hasher = DefaultHasher::new();
    both.hash(&mut hasher);
    // Never 0, which means unknown.
    (hasher.finish() as u32).max(1)
}

/// Removes temporary files of a folder if their process has ended or they are a day old. A live process keeps its files. Files that
/// cannot be removed stay.
pub(crate) fn remove_stale(folder: &Path) {
    let (entries, machine) = (fs::read_dir(folder).into_iter().flatten(), machine());
    for entry in entries.flatten().filter(|entry| is_stale(entry, machine)) {
        let _ = fs::remove_file(entry.path());
    }
}

fn is_stale(entry: &DirEntry, machine: u32) -> bool {
    let name = entry.file_name();
    let Some(middle) = name.to_str().and_then(|name| name.strip_prefix(PREFIX)?.strip_suffix(SUFFIX)) else {
        return false;
    };
    let Ok(there) = entry.metadata() else { return false };
    let age = there.modified().ok().and_then(|time| SystemTime::now().duration_since(time).ok());
    let old = there.is_file() && age.is_some_and(|age| age > STALE);
    let mut parts = middle.split('-');
    let of_machine = parts.next().and_then(|text| u32::from_str_radix(text, 16).ok());
    let process = parts.next().and_then(|text| text.parse::<u32>().ok());
    match process.filter(|_| machine != 0 && of_machine == Some(machine)) {
        Some(process) => there.is_file() && !Path::new(&format!("/proc/{process}")).exists(),
        None => old,
    }
}
