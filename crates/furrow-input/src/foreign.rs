//! Files of other kinds that users give in place of a table or of an embryo that was followed. Errors name the kind of file and
//! the remedy.

use std::path::Path;

use crate::InputError;

/// Tables and tracked embryos.
pub const WANTED: &str = "a table or an embryo that was followed";

/// The kind of file and the remedy, for a project of Mastodon.
const MASTODON: &str = "a project of Mastodon: in Mastodon export spots and links to CSV, and give the table of spots";

/// Refuses a file of another kind than is `wanted` by the bytes at its start.
///
/// # Errors
/// It is of one of the kinds that are known.
pub fn refuse(file: &str, head: &[u8], wanted: &str) -> Result<(), InputError> {
    match kind(head) {
        Some(kind) => Err(InputError::other_file(file, wanted, format!("it is {kind}"))),
        None => Ok(()),
    }
}

/// Names the kind of a file and the remedy; `None` if it may be a table.
fn kind(head: &[u8]) -> Option<&'static str> {
    let text = String::from_utf8_lossy(head);
    let text = text.trim_start_matches('\u{feff}').trim_start();
    let has = |word: &str| text.contains(word);
    if text.starts_with('<') {
        return Some(match () {
            () if has("<TrackMate") => {
                "a file of TrackMate or MaMuT (XML), which is an embryo that was followed and no table"
            }
            () if has("<embryo") || has("<nuclei") => {
                "AceTree's configuration (XML): give the archive of nuclei (zip) that it names"
            }
            () if has("phyloxml") || has("nexml") => "a tree in XML: furrow writes such files and reads tree.json",
            () => "XML or HTML: save the table as CSV",
        });
    }
    if text.starts_with('{') || text.starts_with('[') {
        return Some(match has("\"furrow.tree\"") || has("\"cells\"") || has("\"format\"") {
            true => {
                "JSON, as furrow's tree.json is: that is a model's tree (option --tree, or the first file of compare counts)"
            }
            false => "JSON: save the table as CSV",
        });
    }
    if text.starts_with("#NEXUS") || is_newick(text) {
        return Some(
            "a tree (Newick or Nexus), which has no sizes and times of measured cells: a table as CSV is read",
        );
    }
    if head.starts_with(b"\x1f\x8b") {
        return Some("packed by gzip: unpack it");
    }
    if head.starts_with(b"\x89HDF") {
        return Some("a file of HDF5: export the table as CSV, or tracks as GEFF");
    }
    if head.starts_with(b"\xd0\xcf\x11\xe0") {
        return Some("a workbook of Excel: save the sheet as CSV");
    }
    if [&b"II*\0"[..], b"MM\0*", b"\x89PNG", b"\xff\xd8\xff", b"%PDF"].iter().any(|magic| head.starts_with(magic)) {
        return Some("an image or a document: a table as CSV is read");
    }
    if text.starts_with("Lineage(") || text.starts_with("#![enable") {
        return Some("a lineage file (RON), which describes the model: options --lineage and --tree take it");
    }
    let ctc = "tracks of the Cell Tracking Challenge, which are an embryo that was followed and no table";
    is_ctc(text).then_some(ctc)
}

/// Whether a text begins as a tree: its first pair of brackets has several entries, lengths or brackets of its own, unlike a heading
/// such as (frame).
fn is_newick(text: &str) -> bool {
    text.strip_prefix('(')
        .is_some_and(|rest| rest.split(')').next().is_some_and(|first| first.contains(['(', ',', ':'])))
}

/// Whether these are tracks of the Cell Tracking Challenge: lines of four whole numbers with blanks, tabs or commas between them, perhaps
/// below the heading `L B E P`. NumPy may write numbers as `1.0e+00`.
pub fn is_ctc(text: &str) -> bool {
    let mut lines = lines_below(text).peekable();
    let whole = |word: &str| word.parse().is_ok_and(|number: f64| number >= 0.0 && number.fract() == 0.0);
    let mut count = 0;
    while let Some(line) = lines.next() {
        let words: Vec<&str> = ctc_words(line).collect();
        // The last line may be cut off.
        let is_cut = lines.peek().is_none() && count > 0;
        let of_number = |c: char| c.is_ascii_digit() || c.is_whitespace() || ".,;eE+-".contains(c);
        let is_fine =
            if is_cut { line.chars().all(of_number) } else { words.len() == 4 && words.into_iter().all(whole) };
        if !is_fine {
            return false;
        }
        count += 1;
    }
    count > 0
}

/// Whether all fields are numbers, apart from a heading `L B E P`.
pub fn has_only_numbers(text: &str) -> bool {
    let mut lines = lines_below(text).peekable();
    let is_number = |word: &str| word.parse::<f64>().is_ok();
    lines.peek().is_some() && lines.all(|line| ctc_words(line).all(is_number))
}

/// The words of a line of tracks of the Cell Tracking Challenge.
pub fn ctc_words(line: &str) -> impl Iterator<Item = &str> {
    line.split(|c: char| c.is_whitespace() || c == ',' || c == ';').filter(|word| !word.is_empty())
}

/// Whether a line is the heading `L B E P` of tracks of the Cell Tracking Challenge.
pub fn is_ctc_heading(line: &str) -> bool {
    ctc_words(line.trim_start_matches('#')).map(str::to_lowercase).eq(["l", "b", "e", "p"])
}

/// The lines that are not empty, below a heading of tracks of the Cell Tracking Challenge.
fn lines_below(text: &str) -> impl Iterator<Item = &str> {
    let lines = text.split(['\n', '\r']).filter(|line| !line.trim().is_empty());
    lines.skip_while(|line| is_ctc_heading(line))
}

/// Refuses an archive without files of nuclei, by the names in it.
///
/// # Errors
/// It is of one of the kinds that are known.
pub fn refuse_archive(path: &Path, names: &[String]) -> Result<(), InputError> {
    let has = |word: &str| names.iter().any(|name| name.ends_with(word));
    let kind = if has("project.xml") || has("model.raw") {
        MASTODON
    } else if has("xl/workbook.xml") {
        "a workbook of Excel: save the sheet as CSV"
    } else if has("content.xml") {
        "a document of LibreOffice: save the sheet as CSV"
    } else if has(".zattrs") || has("zarr.json") {
        "a Zarr container in an archive: unpack it and give the folder"
    } else {
        return Ok(());
    };
    Err(InputError::other_file(path.display(), WANTED, format!("it is {kind}")))
}

/// Names the kind of a folder without nuclei and GEFF, and the remedy; `None` if it is not known.
pub fn folder(folder: &Path) -> Option<String> {
    let has = |name: &str| folder.join(name).exists();
    has("project.xml").then(|| format!("it has {MASTODON}"))
}
