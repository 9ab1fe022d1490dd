//! The files of `compare volumes --out` and `compare contour --out`.

use std::path::Path;

use measured::contour::series::{Beside, Series};
use measured::events::Division;
use measured::trend::{AdjacentTest, VolumeBin};
use serde::Serialize;

use crate::cli::error::CliError;
use crate::cli::output::csv_of;
use crate::io::files::FileSet;
use crate::study::compare::volumes::GroupBeside;

/// Their names.
pub const NAMES: [&str; 4] = ["chi.csv", "divisions.csv", "bins.csv", "compare.json"];

/// A row of `chi.csv`: a mother in a group.
#[derive(Serialize)]
struct ChiRow<'a> {
    group: &'a str,
    mother: &'a str,
    n: usize,
    chi_mean: f64,
    chi_sd: Option<f64>,
    chi_signed_mean: f64,
    chi_signed_sd: Option<f64>,
    model_chi: Option<f64>,
    model_chi_given_first: Option<f64>,
}

const CHI: &str = "group,mother,n,chi_mean,chi_sd,chi_signed_mean,chi_signed_sd,model_chi,model_chi_given_first";

/// A row of `divisions.csv`.
#[derive(Serialize)]
struct DivisionRow<'a> {
    group: &'a str,
    embryo: &'a str,
    mother: &'a str,
    first: &'a str,
    second: &'a str,
    volume_first: f64,
    volume_second: f64,
    chi_signed: f64,
}

const DIVISION: &str = "group,embryo,mother,first,second,volume_first,volume_second,chi_signed";

/// A row of `bins.csv`: a bin, and its test beside the one of larger cells.
#[derive(Serialize)]
struct BinRow {
    from: f64,
    to: f64,
    n: usize,
    chi_mean: f64,
    chi_sd: Option<f64>,
    u: Option<f64>,
    p: Option<f64>,
    stars: Option<&'static str>,
}

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
    let chi = each.map(|(group, event)| ChiRow {
        group: &group.group,
        mother: &event.measured.mother,
        n: event.measured.n,
        chi_mean: event.measured.mean,
        chi_sd: event.measured.sd,
        chi_signed_mean: event.measured.mean_signed,
        chi_signed_sd: event.measured.sd_signed,
        model_chi: event.model.and_then(|model| model.chi),
        model_chi_given_first: event.given_first.and_then(|model| model.chi),
    });
    let division = divisions.iter().map(|division| DivisionRow {
        group: &division.group,
        embryo: &division.embryo,
        mother: &division.mother,
        first: &division.daughters[0],
        second: &division.daughters[1],
        volume_first: division.volumes[0],
        volume_second: division.volumes[1],
        chi_signed: division.chi_signed,
    });
    let bin = bins.iter().enumerate().map(|(k, bin)| {
        // The first bin, of the largest cells, has none to be held against.
        let test = k.checked_sub(1).and_then(|k| tests.get(k));
        BinRow {
            from: bin.from,
            to: bin.to,
            n: bin.n,
            chi_mean: bin.mean,
            chi_sd: bin.sd,
            u: test.map(|test| test.test.u),
            p: test.map(|test| test.test.p),
            stars: test.map(|test| test.stars),
        }
    });
    let tables = [csv_of(CHI, chi)?, csv_of(DIVISION, division)?, csv_of(BIN, bin)?, json.as_bytes().to_vec()];
    write_all(folder, &NAMES, tables)
}

/// Those of `compare contour`.
pub const CONTOUR_NAMES: [&str; 2] = ["contours.csv", "compare.json"];

/// A row of `contours.csv`.
#[derive(Serialize)]
struct ContourRow<'a> {
    file: &'a str,
    contour: &'a str,
    stage: Option<usize>,
    depth: f64,
    model_depth: f64,
    elongation: f64,
    model_elongation: f64,
    area: f64,
    centroid_x: f64,
    centroid_y: f64,
    angle: f64,
    frame: &'a str,
    t: f64,
    similarity: f64,
    similarity_pixels: f64,
    jaccard: f64,
}

const CONTOUR: &str = "file,contour,stage,depth,model_depth,elongation,model_elongation,area,centroid_x,centroid_y,angle,frame,t,similarity,similarity_pixels,jaccard";

fn contour_row(beside: &Beside) -> ContourRow<'_> {
    let Beside { measured, model, overlap, pixels, centroid, .. } = beside;
    ContourRow {
        file: &beside.file,
        contour: &beside.contour,
        stage: beside.stage.map(|stage| stage + 1),
        depth: measured.depth,
        model_depth: model.depth,
        elongation: measured.elongation,
        model_elongation: model.elongation,
        area: measured.area,
        centroid_x: centroid[0],
        centroid_y: centroid[1],
        angle: beside.angle,
        frame: &beside.frame,
        t: beside.t,
        similarity: overlap.similarity,
        similarity_pixels: pixels.similarity,
        jaccard: overlap.jaccard,
    }
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
