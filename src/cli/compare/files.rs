//! The files of `compare volumes --out` and `compare contour --out`.

use std::path::Path;

use furrow_measured::contour::series::{ContourMatch, Series};
use furrow_measured::events::Division;
use furrow_measured::trend::{AdjacentTest, VolumeBin};
use serde_json::{Value, json};

use crate::cli::error::CliError;
use crate::cli::output::csv_of;
use furrow_analysis::compare::volumes::GroupBeside;
use furrow_formats::files::FileSet;

/// Their names.
pub const NAMES: [&str; 4] = ["chi.csv", "divisions.csv", "bins.csv", "compare.json"];

/// The columns of `chi.csv`, a row per mother in a group.
const CHI: &str = "group,mother,n,chi_mean,chi_sd,chi_signed_mean,chi_signed_sd,model_chi,model_chi_given_first";

/// The columns of `divisions.csv`.
const DIVISION: &str = "group,embryo,mother,first,second,volume_first,volume_second,chi_signed";

/// The columns of `bins.csv`: a bin and its test against the next larger cells.
const BIN: &str = "from,to,n,chi_mean,chi_sd,u,p,stars";

/// Writes all of them, or none. `json` is what `--json` prints.
pub fn write(
    folder: &Path,
    groups: &[GroupBeside],
    divisions: &[Division],
    (bins, tests): (&[VolumeBin], &[AdjacentTest]),
    json: &str,
) -> Result<(), CliError> {
    let each = groups.iter().flat_map(|group| group.events.iter().map(move |event| (group, event)));
    let chi = each.map(|(group, event)| {
        json!({
            "group": &group.group,
            "mother": &event.measured.mother,
            "n": event.measured.n,
            "chi_mean": event.measured.mean,
            "chi_sd": event.measured.sd,
            "chi_signed_mean": event.measured.mean_signed,
            "chi_signed_sd": event.measured.sd_signed,
            "model_chi": event.model.and_then(|model| model.chi),
            "model_chi_given_first": event.given_first.and_then(|model| model.chi),
        })
    });
    let division = divisions.iter().map(|division| {
        json!({
            "group": &division.group,
            "embryo": &division.embryo,
            "mother": &division.mother,
            "first": &division.daughters[0],
            "second": &division.daughters[1],
            "volume_first": division.volumes[0],
            "volume_second": division.volumes[1],
            "chi_signed": division.chi_signed,
        })
    });
    let bin = bins.iter().enumerate().map(|(k, bin)| {
        // The first bin, of the largest cells, has none to be held against.
        let test = k.checked_sub(1).and_then(|k| tests.get(k));
        json!({
            "from": bin.from,
            "to": bin.to,
            "n": bin.n,
            "chi_mean": bin.mean,
            "chi_sd": bin.sd,
            "u": test.map(|test| test.test.u),
            "p": test.map(|test| test.test.p),
            "stars": test.map(|test| test.stars),
        })
    });
    let tables = [csv_of(CHI, chi)?, csv_of(DIVISION, division)?, csv_of(BIN, bin)?, json.as_bytes().to_vec()];
    write_all(folder, &NAMES, tables)
}

/// Those of `compare contour`.
pub const CONTOUR_NAMES: [&str; 2] = ["contours.csv", "compare.json"];

/// The columns of `contours.csv`.
const CONTOUR: &str = "file,contour,stage,depth,model_depth,elongation,model_elongation,area,centroid_x,centroid_y,angle,frame,t,similarity,similarity_pixels,jaccard";

fn contour_row(beside: &ContourMatch) -> Value {
    let ContourMatch { measured, model, overlap, pixels, centroid, .. } = beside;
    json!({
        "file": &beside.file,
        "contour": &beside.contour,
        "stage": beside.stage.map(|stage| stage + 1),
        "depth": measured.depth,
        "model_depth": model.depth,
        "elongation": measured.elongation,
        "model_elongation": model.elongation,
        "area": measured.area,
        "centroid_x": centroid[0],
        "centroid_y": centroid[1],
        "angle": beside.angle,
        "frame": &beside.frame,
        "t": beside.t,
        "similarity": overlap.similarity,
        "similarity_pixels": pixels.similarity,
        "jaccard": overlap.jaccard,
    })
}

/// Writes them, or none. `json` is what `--json` prints.
pub fn write_contours(folder: &Path, series: &Series, json: &str) -> Result<(), CliError> {
    let rows = series.contours.iter().map(contour_row);
    write_all(folder, &CONTOUR_NAMES, [csv_of(CONTOUR, rows)?, json.as_bytes().to_vec()])
}

fn write_all<const N: usize>(folder: &Path, names: &[&str; N], tables: [Vec<u8>; N]) -> Result<(), CliError> {
    let mut files = FileSet::new(folder);
    for (name, bytes) in names.iter().zip(tables) {
        files.stage(name, &bytes)?;
    }
    files.commit()?;
    Ok(())
}
