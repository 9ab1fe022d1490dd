//! The files of `compare volumes --out` and `compare contour --out`.

use furrow_measured::contour::series::{ContourMatch, Series};
use furrow_measured::events::Division;

use crate::cli::error::CliError;
use crate::cli::interrupt;
use crate::cli::output::records_csv;
use furrow_analysis::compare::volumes_comparison::VolumesComparison;
use furrow_formats::files::FileSet;
use serde_json::{Value, json};
use std::path::Path;

/// The names of the files of `compare volumes`.
pub const NAMES: [&str; 4] = ["chi.csv", "divisions.csv", "bins.csv", "compare.json"];

/// The columns of `chi.csv`, with one row per mother and group.
const CHI: &str = "group,mother,n,chi_mean,chi_sd,chi_signed_mean,chi_signed_sd,model_chi,model_chi_given_first";

/// The columns of `divisions.csv`.
const DIVISION: &str = "group,embryo,mother,first,second,volume_first,volume_second,chi_signed";

/// The columns of `bins.csv`: a bin and its test against the bin of the next larger cells.
const BIN: &str = "from,to,n,chi_mean,chi_sd,u,p,stars";

/// Writes all files or, if one fails, no file. `json` is the output of `--json`.
pub fn write(
    folder: &Path,
    VolumesComparison { groups, bins, tests, .. }: &VolumesComparison,
    divisions: &[Division],
    json: &str,
) -> Result<(), CliError> {
    let each = groups.iter().flat_map(|group| group.events.iter().map(move |event| (group, event)));
    let chi = each.map(|(group, event)| {
        let (m, [model, given]) = (&event.measured, [event.model, event.given_first].map(|m| m.and_then(|m| m.chi)));
        json!([group.group, m.mother, m.n, m.mean, m.sd, m.mean_signed, m.sd_signed, model, given])
    });
    let division = divisions.iter().map(|d| {
        let ([first, second], [v_first, v_second]) = (&d.daughters, d.volumes);
        json!([d.group, d.embryo, d.mother, first, second, v_first, v_second, d.chi_signed])
    });
    let bin = bins.iter().enumerate().map(|(k, bin)| {
        // The first bin contains the largest cells and is not tested.
        let test = k.checked_sub(1).and_then(|k| tests.get(k));
        let [u, p] = [test.map(|test| test.test.u), test.map(|test| test.test.p)];
        json!([bin.from, bin.to, bin.n, bin.mean, bin.sd, u, p, test.map(|test| test.stars)])
    });
    let tables =
        [records_csv(CHI, chi)?, records_csv(DIVISION, division)?, records_csv(BIN, bin)?, json.as_bytes().to_vec()];
    write_all(folder, &NAMES, tables)
}

/// The files of `compare contour`.
pub const CONTOUR_NAMES: [&str; 2] = ["contours.csv", "compare.json"];

/// The columns of `contours.csv`.
const CONTOUR: &str = "file,contour,stage,depth,model_depth,elongation,model_elongation,area,centroid_x,centroid_y,angle,frame,t,similarity,similarity_pixels,jaccard";

fn contour_row(beside: &ContourMatch) -> Value {
    let ContourMatch { file, contour, measured, model, overlap, pixels, centroid: [x, y], angle, frame, t, .. } =
        beside;
    let stage = beside.stage.map(|stage| stage + 1);
    let long = [measured.elongation, model.elongation];
    json!([
        file,
        contour,
        stage,
        measured.depth,
        model.depth,
        long[0],
        long[1],
        measured.area,
        x,
        y,
        angle,
        frame,
        t,
        overlap.similarity,
        pixels.similarity,
        overlap.jaccard
    ])
}

/// Writes all files or, if one fails, no file. `json` is the output of `--json`.
pub fn write_contours(folder: &Path, series: &Series, json: &str) -> Result<(), CliError> {
    let rows = series.contours.iter().map(contour_row);
    write_all(folder, &CONTOUR_NAMES, [records_csv(CONTOUR, rows)?, json.as_bytes().to_vec()])
}

fn write_all<const N: usize>(folder: &Path, names: &[&str; N], tables: [Vec<u8>; N]) -> Result<(), CliError> {
    let mut files = FileSet::new(folder);
    for (name, bytes) in names.iter().zip(tables) {
        files.stage(name, &bytes)?;
    }
    Ok(interrupt::defer(|| files.commit())?)
}
