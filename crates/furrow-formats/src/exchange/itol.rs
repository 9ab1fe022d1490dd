//! Annotations for iTOL, the Interactive Tree of Life: files that are dropped onto the tree in its page.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::column::BranchLengths;
use super::newick;
use super::sheet::Sheet;

/// Colours of χ = 0 and of χ = 1, from light to dark, so that they differ in print and for colour-blind readers.
const CHI_COLOURS: [[u8; 3]; 2] = [[0xff, 0xe8, 0xa3], [0x27, 0x1c, 0x6b]];

/// Colour of founders without a given colour.
const GREY: &str = "#808080";

/// The files of a folder for iTOL:
///
/// | file | |
/// |---|---|
/// | `tree.nwk` | the tree, to be uploaded first |
/// | `founders.txt` | a strip in the colour of each cell's founder, branches in the same colours |
/// | `birth_chi.txt` | a gradient: χ of the division that each cell was born from |
/// | `chi.txt` | a disc at each cell that divides, as dark as its χ |
/// | `labels.txt` | labels with the cell's radius and, of a leaf, why it is one |
pub const ITOL_FILES: [&str; 5] = ["tree.nwk", "founders.txt", "birth_chi.txt", "chi.txt", "labels.txt"];

/// The text of each of [`ITOL_FILES`].
pub(super) fn itol(sheet: &Sheet<'_>, lengths: BranchLengths, colours: &[&str]) -> Vec<(&'static str, String)> {
    let texts = [newick::plain(sheet, lengths), founders(sheet, colours), birth_chi(sheet), chi(sheet), labels(sheet)];
    ITOL_FILES.into_iter().zip(texts).collect()
}

/// The lines of a file: kind, settings, then data, with tabs between: no name contains one.
fn file(kind: &str, settings: &[(&str, String)], data: impl Iterator<Item = String>) -> String {
    let mut out = format!("{kind}\nSEPARATOR TAB\n");
    for (name, value) in settings {
        let _ = writeln!(out, "{name}\t{value}");
    }
    out.push_str("DATA\n");
    for line in data {
        out.push_str(&line);
        out.push('\n');
    }
    out
}

fn founders(sheet: &Sheet<'_>, colours: &[&str]) -> String {
    let colour = |founder: usize| colours.get(founder).copied().unwrap_or(GREY);
    // Founders in the tree, in the lineage's order.
    let present: BTreeMap<usize, &str> =
        (0..sheet.len()).map(|id| (sheet.cells[id].founder, sheet.founder(id))).collect();
    let joined = |words: Vec<&str>| words.join("\t");
    let settings = [
        ("DATASET_LABEL", "founder".to_owned()),
        ("COLOR", "#404040".to_owned()),
        ("COLOR_BRANCHES", "1".to_owned()),
        ("LEGEND_TITLE", "founder".to_owned()),
        ("LEGEND_SHAPES", joined(present.keys().map(|_| "1").collect())),
        ("LEGEND_COLORS", joined(present.keys().map(|founder| colour(*founder)).collect())),
        ("LEGEND_LABELS", joined(present.values().copied().collect())),
    ];
    let line =
        |id: usize| format!("{}\t{}\t{}", sheet.cells[id].name, colour(sheet.cells[id].founder), sheet.founder(id));
    file("DATASET_COLORSTRIP", &settings, (0..sheet.len()).map(line))
}

fn birth_chi(sheet: &Sheet<'_>) -> String {
    let settings = [
        ("DATASET_LABEL", "χ of the division it was born from".to_owned()),
        ("COLOR", hex(CHI_COLOURS[1])),
        ("AUTO_LEGEND", "1".to_owned()),
        ("COLOR_MIN", hex(CHI_COLOURS[0])),
        ("COLOR_MAX", hex(CHI_COLOURS[1])),
    ];
    let line = |id: usize| Some(format!("{}\t{}", sheet.cells[id].name, (sheet.chi)(sheet.cells[id].mother?)?));
    file("DATASET_GRADIENT", &settings, (0..sheet.len()).filter_map(line))
}

fn chi(sheet: &Sheet<'_>) -> String {
    let settings =
        [("DATASET_LABEL", "χ".to_owned()), ("COLOR", hex(CHI_COLOURS[1])), ("MAXIMUM_SIZE", "8".to_owned())];
    let line = |id: usize| {
        let chi = (sheet.chi)(id)?;
        let mix = |k: usize| {
            let [light, dark] = CHI_COLOURS.map(|colour| f64::from(colour[k]));
            (light + (dark - light) * chi).round() as u8
        };
        // A disc (2), of size 1, filled, at the end of the cell's branch.
        Some(format!("{}\t2\t1\t{}\t1\t1\t{chi:.3}", sheet.cells[id].name, hex([mix(0), mix(1), mix(2)])))
    };
    file("DATASET_SYMBOL", &settings, (0..sheet.len()).filter_map(line))
}

fn labels(sheet: &Sheet<'_>) -> String {
    let line = |id: usize| {
        let (name, remark) = (sheet.cells[id].name, (sheet.remark)(id));
        if remark.is_empty() { format!("{name}\t{name}") } else { format!("{name}\t{name} ({remark})") }
    };
    file("LABELS", &[], (0..sheet.len()).map(line))
}

fn hex([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}
