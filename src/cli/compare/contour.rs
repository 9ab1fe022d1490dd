//! `furrow compare contour`: outlines of cells compared with a simulated division.

use std::io::Read;

use furrow_measured::contour::Contour;
use furrow_measured::contour::polygons::{Contours, LeftOut};
use furrow_measured::contour::series::{ContourMatch, ModelContour, Series, series};

use super::files;
use crate::cli::context::Context;
use crate::cli::error::CliError;
use crate::cli::output::{merged, number, print, to_json, writable_folder};
use crate::cli::picture::PlotArgs;
use clap::Args;
use furrow_figures::plot;
use furrow_formats::frames::read_frames;
use furrow_input::{InputError, open_file};
use serde_json::json;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Compares measured outlines of a dividing cell with a simulated division
///
/// Contours are tables of points (CSV with columns x and y, and contour if there are several) or masks (PNG with the cell in one colour,
/// or with --label a label image), all for sections through the axis of one cell. Each contour is aligned by centroid and long axis with
/// the frame of equal furrow depth. The similarity index is |A∩B|/|A|, where A is the measured area.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow compare contour outlines.csv --frames contours --plot overlay.svg
  furrow compare contour mask_1.png mask_2.png --frames contours --json")]
pub struct ContourArgs {
    /// Measured contours: CSV tables of points, PNG masks
    #[arg(value_name = "MEASURED", required = true)]
    measured: Vec<PathBuf>,
    /// Folder of frames, written by furrow divide --frames
    #[arg(help_heading = "Model", long, value_name = "DIR")]
    frames: PathBuf,
    /// Length of L_h in the unit of the contours (pixels for masks); by default the total areas of the contours agree
    #[arg(help_heading = "Model", long, value_name = "LENGTH", value_parser = number)]
    length_scale: Option<f64>,
    /// The cell's label, for masks that are label images
    #[arg(help_heading = "Contours", long, value_name = "N")]
    label: Option<u16>,
    /// Output folder for contours.csv and compare.json
    #[arg(help_heading = "Output", long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    plot: PlotArgs,
}

pub fn run(args: &ContourArgs, context: &Context) -> Result<(), CliError> {
    let length = args.length_scale.unwrap_or(1.0);
    let allowed = "a length from 1e-6 to 1e6, in the unit of the contours";
    InputError::require((1e-6..=1e6).contains(&length), "--length-scale", "length_scale", length, allowed)?;
    let picture = args.plot.file()?;
    writable_folder("--out", args.out.as_deref(), &files::CONTOUR_NAMES)?;
    let model = model_contours(&args.frames)?;
    let found = read(args)?;
    let Some(series) = series(&found.traced, &model, args.length_scale) else {
        return Err(nothing_to_compare(args, &found, model.is_empty()).into());
    };
    let rest = json!({ "used": found.traced.len(), "skipped": found.left_out });
    let json = to_json(&merged(json!(series), rest))?;
    if let Some(out) = &args.out {
        files::write_contours(out, &series, &json)?;
    }
    picture.write(|| plot::contours::draw(&series))?;
    print(&if context.json { json } else { text(&series, &found.left_out) })
}

/// The contours of a simulated division, on both sides of the axis.
fn model_contours(folder: &Path) -> Result<Vec<ModelContour>, CliError> {
    let mut out = Vec::new();
    for frame in read_frames(folder)? {
        let other = frame.points.iter().rev().map(|[r, z]| [-r, *z]);
        let ring = frame.points.iter().copied().chain(other).collect();
        let file = folder.join(&frame.file);
        let no_contour = |why| InputError::other_file(file.display(), "a contour from pole to pole", why);
        let (contour, _) = Contour::new(ring).map_err(no_contour)?;
        out.push(ModelContour { frame: frame.file, t: frame.t, contour });
    }
    Ok(out)
}

fn read(args: &ContourArgs) -> Result<Contours, InputError> {
    let (mut found, mut masks) = (Contours::default(), 0);
    for path in &args.measured {
        let mut opened = open_file(path)?;
        let file = path.display().to_string();
        let unreadable = |e: std::io::Error| InputError::Unreadable { file: file.clone(), reason: e.to_string() };
        // The signature determines the type, since extensions of pictures may be wrong.
        let mut first = Vec::new();
        (&mut opened).take(SIGNATURE.len() as u64).read_to_end(&mut first).map_err(unreadable)?;
        let is_mask = first == SIGNATURE;
        let whole = first.chain(opened);
        masks += usize::from(is_mask);
        match is_mask {
            true => found.read_mask(whole, &file, args.label)?,
            false => found.read_table(whole, &file)?,
        }
    }
    let label = args.label.unwrap_or(0);
    let fine = args.label.is_none() || masks > 0;
    InputError::require(fine, "--label", "label", label, "absent: none of the contours is a mask (PNG)")?;
    Ok(found)
}

/// The signature of PNG files.
const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

fn nothing_to_compare(args: &ContourArgs, found: &Contours, no_frames: bool) -> InputError {
    if no_frames {
        let folder = format!("{:?}", args.frames);
        return InputError::not_allowed("--frames", "frames", folder, "a folder with at least one frame");
    }
    let left = &found.left_out[0];
    let names = args.measured.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
    InputError::OtherFile { file: names, wanted: "any contour that could be used".to_owned(), reason: place(left) }
}

/// The file, line and name of an omitted contour, and the reason.
fn place(left: &LeftOut) -> String {
    let LeftOut { file, contour, line, why } = left;
    let line = line.map_or(String::new(), |line| format!(":{line}"));
    let name = if contour.is_empty() { String::new() } else { format!(", contour {contour}") };
    format!("{file}{line}{name}: {why}")
}

fn text(series: &Series, left_out: &[LeftOut]) -> String {
    let mut out = String::new();
    let names: Vec<String> = series.contours.iter().map(name).collect();
    let width = names.iter().map(|name| name.chars().count()).max().unwrap_or(0).max(8);
    let _ = writeln!(
        out,
        "{:<width$} stage  depth (model)   long (model)         t   |A∩B|/|A|    pixels |A∩B|/|A∪B|",
        "contour"
    );
    for (beside, name) in series.contours.iter().zip(&names) {
        let ContourMatch { measured, model, overlap, pixels, t, .. } = beside;
        let stage = beside.stage.map_or("-".to_owned(), |stage| (stage + 1).to_string());
        let pair = |a: f64, b: f64| format!("{a:.3} ({b:.3})");
        let (depth, long) = (pair(measured.depth, model.depth), pair(measured.elongation, model.elongation));
        let [a, b, c] = [overlap.similarity, pixels.similarity, overlap.jaccard];
        let _ = writeln!(out, "{name:<width$} {stage:>5} {depth:>14} {long:>14} {t:>9.3} {a:>11.4} {b:>9.4} {c:>9.4}");
        for note in &beside.notes {
            let _ = writeln!(out, "  {note}");
        }
    }
    let sd = series.similarity_sd.map_or(String::new(), |sd| format!(" ± {sd:.4}"));
    let _ = writeln!(
        out,
        "\nsimilarity {:.4}{sd} of {} contours, {:.4} of the stages; one L_h is {:.4} in the unit of the contours",
        series.similarity, series.n, series.similarity_of_stages, series.length_scale
    );
    for left in left_out {
        let _ = writeln!(out, "  skipped {}", place(left));
    }
    out
}

/// The label of a contour: its file, and its name within the file.
fn name(beside: &ContourMatch) -> String {
    let file =
        Path::new(&beside.file).file_name().map_or(beside.file.clone(), |file| file.to_string_lossy().into_owned());
    if beside.contour.is_empty() { file } else { format!("{file} {}", beside.contour) }
}
