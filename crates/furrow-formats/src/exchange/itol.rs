//! Annotations for iTOL, the Interactive Tree of Life: files that are dropped onto the tree in its page.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::column::{self, BranchLengths, TimedTree};
use super::newick;
use furrow_lineage::{CellId, Tree};

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
pub(super) fn itol(tree: &TimedTree<'_>, lengths: BranchLengths, colours: &[&str]) -> Vec<(&'static str, String)> {
    let texts = [newick::plain(tree, lengths), founders(tree, colours), birth_chi(tree), chi(tree), labels(tree)];
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

fn founders(tree: &Tree, colours: &[&str]) -> String {
    let colour = |founder: usize| colours.get(founder).copied().unwrap_or(GREY);
    // Founders in the tree, in the lineage's order.
    let present: BTreeMap<usize, &str> =
        tree.cells().map(|id| (tree.cell(id).founder, tree.founder_name(id))).collect();
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
        |id: CellId| format!("{}\t{}\t{}", tree.cell(id).name, colour(tree.cell(id).founder), tree.founder_name(id));
    file("DATASET_COLORSTRIP", &settings, tree.cells().map(line))
}

fn birth_chi(tree: &Tree) -> String {
    let settings = [
        ("DATASET_LABEL", "χ of the division it was born from".to_owned()),
        ("COLOR", hex(CHI_COLOURS[1])),
        ("AUTO_LEGEND", "1".to_owned()),
        ("COLOR_MIN", hex(CHI_COLOURS[0])),
        ("COLOR_MAX", hex(CHI_COLOURS[1])),
    ];
    let line = |id: CellId| Some(format!("{}\t{}", tree.cell(id).name, column::birth_chi(tree, id)?));
    file("DATASET_GRADIENT", &settings, tree.cells().filter_map(line))
}

fn chi(tree: &Tree) -> String {
    let settings =
        [("DATASET_LABEL", "χ".to_owned()), ("COLOR", hex(CHI_COLOURS[1])), ("MAXIMUM_SIZE", "8".to_owned())];
    let line = |id: CellId| {
        let chi = tree.cell(id).fate.chi()?;
        let mix = |k: usize| {
            let [light, dark] = CHI_COLOURS.map(|colour| f64::from(colour[k]));
            (light + (dark - light) * chi).round() as u8
        };
        // A disc (2), of size 1, filled, at the end of the cell's branch.
        Some(format!("{}\t2\t1\t{}\t1\t1\t{chi:.3}", tree.cell(id).name, hex([mix(0), mix(1), mix(2)])))
    };
    file("DATASET_SYMBOL", &settings, tree.cells().filter_map(line))
}

fn labels(tree: &Tree) -> String {
    let line = |id: CellId| {
        let cell = tree.cell(id);
        let ended = cell
            .fate
            .terminal_reason()
            .map_or(String::new(), |reason| format!(", {}", reason.name().replace('_', " ")));
        format!("{}\t{} (R0 {:.3}{ended})", cell.name, cell.name, cell.r0)
    };
    file("LABELS", &[], tree.cells().map(line))
}

fn hex([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}
