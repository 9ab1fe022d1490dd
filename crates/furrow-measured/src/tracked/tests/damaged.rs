//! Files of every format with bytes changed at random: read, or refused, but no panic.

use proptest::prelude::*;

use super::graphs::{geff, written};
use super::*;

fn changed(content: &[u8], changes: &[(usize, u8)]) -> Vec<u8> {
    let mut content = content.to_vec();
    for (at, byte) in changes {
        let at = at % content.len().max(1);
        match byte % 4 {
            // Cut short, or with a byte removed, added or replaced.
            0 if content.len() > 1 && *byte < 16 => content.truncate(at),
            1 if !content.is_empty() => drop(content.remove(at)),
            2 => content.insert(at.min(content.len()), *byte),
            _ if !content.is_empty() => content[at] = *byte,
            _ => {}
        }
    }
    content
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn damaged_files_are_read_or_refused(changes in prop::collection::vec((0..10_000_usize, any::<u8>()), 1..6), which in 0..4_usize) {
        let (content, name) = match which {
            0 => (zipped(&NUCLEI), "embryo.zip"),
            1 => (cd_table().into_bytes(), "CD.csv"),
            2 => (NUCLEI[4].as_bytes().to_vec(), "t001-nuclei"),
            _ => (Vec::new(), ""),
        };
        if which < 3 {
            let (folder, path) = file(name, changed(&content, &changes));
            let path = if which == 2 { folder.path().to_owned() } else { path };
            let _ = read_tracked(&path, &TrackOptions::default());
            return Ok(());
        }
        for version in [2, 3] {
            let mut files = geff(version, 4);
            for change in &changes {
                let which = change.0 % files.len();
                files[which].1 = changed(&files[which].1, &[*change]);
            }
            let folder = written(&files);
            let _ = read_tracked(&folder.path().join("embryo.geff"), &TrackOptions::default());
        }
    }
}
