//! `furrow compare volumes`: size asymmetries beside the measured ones.

use furrow_measured::events::{Division, Divisions, GroupSummary, divisions, summaries};
use furrow_measured::published::{SOURCE, jankele2021};
use furrow_measured::statistics::Line;
use furrow_measured::trend::{AdjacentTest, VolumeBin, adjacent_tests, volume_bins};
use furrow_measured::volumes::{ReadOptions, Skipped, Unit, Volumes};

use super::{files, trees_of};
use crate::cli::interrupt;
use crate::cli::output::{print, to_json, writable_folder};
use crate::cli::prelude::*;
use crate::cli::progress::ProgressLine;
use furrow_analysis::compare::volumes::{
    Band, Beside, GroupBeside, Modelled, Regression, Scale, ScaleFrom, SizeCurve, add_bands, beside, model, regression,
    scale, size_curves,
};
use furrow_analysis::{Range, read_constants, tree_settings};
use furrow_figures::plot::comparison::{self, Comparison};
use furrow_input::{open_file, read_text};
use furrow_lineage::{Lineage, TreeSettings};

/// Compares size asymmetries of measured divisions with the model's
///
/// A table is long, with columns embryo, cell and volume (or volume_um3, volume_voxels, relative_volume) and optionally group, frame
/// and n, or a grid of frames by cells of one embryo in voxels, such as SampleNN_Volume.csv. Without a table the model is compared
/// with published means. The model's χ is computed twice: grown from its zygote, and with the measured sizes of AB and P1.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow compare volumes
  furrow compare volumes --preset sulston1983 --plot chi.svg --json")]
pub struct VolumesArgs {
    /// Tables of cell volumes, CSV
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Tables of a second condition, for a regression
    #[arg(help_heading = "Tables", long, value_name = "FILE", requires = "files")]
    against: Vec<PathBuf>,
    /// Edge of a voxel in µm, which converts voxels to µm³
    #[arg(help_heading = "Tables", long, value_name = "UM", value_parser = number)]
    voxel: Option<f64>,
    /// Two groups to regress on each other, such as wt,ctrl
    #[arg(help_heading = "Statistics", long, value_name = "X,Y")]
    regress: Option<String>,
    /// Edges of the bins of the mother's volume, ascending, such as 100,1000,10000; default decades
    #[arg(help_heading = "Statistics", long, value_name = "V,V,..", value_delimiter = ',', value_parser = number)]
    bins: Option<Vec<f64>>,
    /// One L_h, in the cube root of the tables' unit (µm of µm³), or fit: by all mothers; default such that P0 is as large as
    /// measured, and by all mothers where P0 is not
    #[arg(help_heading = "Statistics", long, value_name = "LENGTH|fit", allow_negative_numbers = true, value_parser = wanted_scale)]
    length_scale: Option<WantedScale>,
    /// Sets of constants from calibrate --ensemble, which give the model's χ a range
    #[arg(help_heading = "Model", long, value_name = "FILE.csv")]
    constants: Option<PathBuf>,
    /// Lineage that the model grows; default the built-in C. elegans founders
    #[arg(help_heading = "Model", long, value_name = "LINEAGE.ron")]
    lineage: Option<PathBuf>,
    /// Output folder for chi.csv, divisions.csv, bins.csv and compare.json
    #[arg(help_heading = "Output", long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    plot: PlotArgs,
}

/// The value of --length-scale.
#[derive(Clone, Copy, Debug)]
enum WantedScale {
    Length(f64),
    Fitted,
}

fn wanted_scale(text: &str) -> Result<WantedScale, String> {
    match text {
        "fit" => Ok(WantedScale::Fitted),
        _ => Ok(WantedScale::Length(number(text)?)),
    }
}

/// Skipped values that are listed.
const MOST_SKIPPED: usize = 10;

/// What `compare volumes --json` prints.
#[derive(Serialize)]
struct Answer<'a> {
    source: Option<&'static str>,
    groups: &'a [GroupBeside],
    used: u64,
    skipped: &'a [Skipped],
    skipped_count: u64,
    divisions: usize,
    half_seen: &'a [furrow_measured::events::HalfSeen],
    unit: Option<Unit>,
    length_scale: Option<Scale>,
    length_scale_um: Option<f64>,
    /// Sets of constants over which the model's χ have ranges.
    members: Option<usize>,
    bins: Vec<VolumeBin>,
    tests: Vec<AdjacentTest>,
    regressions: Vec<Regression>,
}

/// The measured side of a comparison.
struct Measured {
    source: Option<&'static str>,
    volumes: Volumes,
    found: Divisions,
    groups: Vec<GroupSummary>,
}

pub fn run(args: &VolumesArgs, context: &Context) -> Result<(), CliError> {
    check(args)?;
    let picture = args.plot.file()?;
    writable_folder("--out", args.out.as_deref(), &files::NAMES)?;
    let sets = match &args.constants {
        Some(file) => read_constants(&read_text(file)?, &file.display().to_string())?,
        None => Vec::new(),
    };
    let measured = read(args)?;
    let lineage = Lineage::load(args.lineage.as_deref())?;
    let settings: TreeSettings = tree_settings(context.settings.clone(), &lineage, 0, context.quantisation);
    let grow = |lineages| trees_of(lineages, context);
    let (free, firsts) = model(&lineage, settings.cell.r0, &measured.groups, grow)?;
    let all = &measured.found.divisions;
    let mut groups = beside(measured.groups.clone(), all, &free, &firsts, args.bins.as_deref());
    let flag = Some(interrupt::flag());
    add_bands(&mut groups, &free, &lineage, &settings, &sets, context.threads, flag)?;
    let bins = volume_bins(all, args.bins.as_deref());
    let length_scale = match args.length_scale {
        Some(WantedScale::Length(length)) => Some(Scale { length, from: ScaleFrom::Given }),
        Some(WantedScale::Fitted) => scale(all, &free, false),
        None => scale(all, &free, true),
    };
    let unit = measured.volumes.unit;
    let answer_of = Answer {
        source: measured.source,
        used: measured.volumes.used,
        skipped: &measured.volumes.skipped,
        skipped_count: measured.volumes.skipped_count,
        divisions: all.len(),
        half_seen: &measured.found.half_seen,
        unit,
        length_scale,
        length_scale_um: length_scale.filter(|_| unit == Some(Unit::CubicMicrometres)).map(|scale| scale.length),
        members: (!sets.is_empty()).then_some(sets.len()),
        tests: adjacent_tests(&bins),
        bins,
        regressions: regressions(args, &groups)?,
        groups: &groups,
    };
    let json = to_json(&answer_of)?;
    if let Some(out) = &args.out {
        files::write(out, &groups, all, (&answer_of.bins, &answer_of.tests), &json)?;
    }
    if picture.is_wanted() {
        let unit = unit.map_or(String::new(), |unit| format!("({})", unit.symbol()));
        let (groups, bins, length) = (&groups, &answer_of.bins, length_scale.map(|scale| scale.length));
        let curves = curves(&lineage, &settings, all, length, context)?;
        picture.write(|| comparison::draw(&Comparison { groups, divisions: all, bins, unit, length, curves }))?;
    }
    print(&if context.json { json } else { volumes_text(&answer_of) })
}

/// The model's χ over the sizes of the measured mothers, for the picture; empty without a length scale.
fn curves(
    lineage: &Lineage,
    settings: &TreeSettings,
    divisions: &[Division],
    length: Option<f64>,
    context: &Context,
) -> Result<Vec<SizeCurve>, CliError> {
    let Some(length) = length else { return Ok(Vec::new()) };
    let radii = divisions.iter().map(|d| (0.75 / std::f64::consts::PI * d.mother_volume()).cbrt() / length);
    let [least, most] = radii.fold([f64::INFINITY, 0.0], |[a, b], r| [f64::min(a, r), f64::max(b, r)]);
    // From a cell at rest to one slightly larger than the zygote.
    let [from, to] = [least.clamp(SMALLEST, settings.cell.r0), most.clamp(SMALLEST, 1.2 * settings.cell.r0)];
    if from >= to {
        return Ok(Vec::new());
    }
    let line = ProgressLine::new(context.progress);
    let show = |progress| line.show(progress);
    Ok(size_curves(lineage, settings, [from, to], &context.memo()?, &context.scheduling(&show))?)
}

/// Smallest radius of the curve, in L_h: smaller cells stay at rest.
const SMALLEST: f64 = 1.0;

fn check(args: &VolumesArgs) -> Result<(), InputError> {
    if let Some(voxel) = args.voxel.filter(|voxel| *voxel <= 0.0) {
        return Err(InputError::not_allowed("--voxel", "voxel", voxel, "a length above 0, in µm"));
    }
    if let Some(WantedScale::Length(length)) = args.length_scale
        && length <= 0.0
    {
        let allowed = "a length above 0, in the cube root of the tables' unit, or fit";
        return Err(InputError::not_allowed("--length-scale", "length_scale", length, allowed));
    }
    if let Some(edges) = &args.bins
        && (edges.len() < 2 || edges.windows(2).any(|pair| pair[0] >= pair[1]))
    {
        let given = edges.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        return Err(InputError::not_allowed("--bins", "bins", given, "two numbers or more, rising"));
    }
    Ok(())
}

fn read(args: &VolumesArgs) -> Result<Measured, CliError> {
    let mut volumes = Volumes::default();
    if args.files.is_empty() {
        let groups = jankele2021()?;
        return Ok(Measured { source: Some(SOURCE), volumes, found: Divisions::default(), groups });
    }
    // Two conditions are two groups, if their tables name none.
    let names = |name: &str| (!args.against.is_empty()).then(|| name.to_owned());
    for (files, group) in [(&args.files, names("measured")), (&args.against, names("against"))] {
        let options = ReadOptions { voxel: args.voxel, group };
        for file in files {
            volumes.read(open_file(file)?, &file.display().to_string(), &options)?;
        }
    }
    let found = divisions(&volumes);
    let groups = summaries(&found.divisions);
    Ok(Measured { source: None, volumes, found, groups })
}

/// The regressions asked for: of named groups, or of two conditions.
fn regressions(args: &VolumesArgs, groups: &[GroupBeside]) -> Result<Vec<Regression>, InputError> {
    let names = match &args.regress {
        Some(text) => text.split_once(',').map(|(x, y)| (x.trim().to_owned(), y.trim().to_owned())),
        None if !args.against.is_empty() => Some(("measured".to_owned(), "against".to_owned())),
        None => return Ok(Vec::new()),
    };
    let known: Vec<&str> = groups.iter().map(|group| group.group.as_str()).collect();
    let allowed = format!("two groups of the tables, as X,Y; groups are {}", known.join(", "));
    let find = |name: &str| groups.iter().find(|group| group.group == name);
    let given = || args.regress.clone().unwrap_or_default();
    let refused = || InputError::not_allowed("--regress", "regress", given(), &allowed);
    let (x, y) = names.ok_or_else(refused)?;
    match (find(&x), find(&y)) {
        (Some(x), Some(y)) => Ok(vec![regression(x, y)]),
        // Tables with their own groups lack those of the two conditions.
        _ if args.regress.is_none() => Ok(Vec::new()),
        _ => Err(refused()),
    }
}

fn volumes_text(found: &Answer<'_>) -> String {
    let mut out = String::new();
    if let Some(source) = found.source {
        let _ = writeln!(out, "measured: means published by {source}\n");
    }
    for group in found.groups {
        group_text(&mut out, group);
    }
    if !found.bins.is_empty() {
        let unit = found.unit.map_or("", Unit::symbol);
        let _ = writeln!(out, "χ by the mother's volume ({unit}), of all groups:");
        bins_text(&mut out, &found.bins, &found.tests);
    }
    for regression in &found.regressions {
        regression_text(&mut out, regression);
    }
    if let Some(scale) = found.length_scale {
        let unit = match found.unit {
            Some(Unit::CubicMicrometres) => "µm",
            Some(Unit::Voxels) => "edges of a voxel",
            _ => "in the cube root of the unit",
        };
        let from = match scale.from {
            ScaleFrom::Given => "as given",
            ScaleFrom::P0 => "by P0",
            ScaleFrom::Fitted => "by all mothers that the model has",
        };
        let _ = writeln!(out, "one L_h is {:.4} {unit}, {from}", scale.length);
    }
    if found.source.is_none() {
        let (Answer { used, skipped_count, divisions, .. }, one) = (found, found.half_seen.len());
        out += &format!(
            "{used} volumes used, {skipped_count} skipped; {divisions} divisions with both daughters, {one} with one\n"
        );
    }
    for skipped in found.skipped.iter().take(MOST_SKIPPED) {
        let Skipped { file, line, column, value, why } = skipped;
        let _ = writeln!(out, "  skipped {file}:{line}, column {column}: {value:?}: {why}");
    }
    if found.skipped_count as usize > MOST_SKIPPED {
        let _ = writeln!(out, "  and {} more (--json gives their places)", found.skipped_count as usize - MOST_SKIPPED);
    }
    out
}

fn group_text(out: &mut String, group: &GroupBeside) {
    let name = if group.group.is_empty() { "measured".to_owned() } else { format!("group {}", group.group) };
    let _ = writeln!(out, "{name}, {} embryos", group.embryos);
    let with_bands = group.events.iter().any(|event| event.band.is_some());
    let _ = writeln!(
        out,
        "{:<10}{:>4} {:>16} {:>8} {:>16} {:>22}{}",
        "mother",
        "n",
        "χ measured",
        "signed",
        "model (sd off)",
        "AB, P1 as measured",
        if with_bands { "  over the constants: median, 90 %" } else { "" }
    );
    for event in &group.events {
        let Beside { measured, model, given_first, band, .. } = event;
        let sd = measured.sd.map_or("".to_owned(), |sd| format!(" ± {sd:.3}"));
        let of = |modelled: &Option<Modelled>| match modelled {
            Some(Modelled { chi: Some(chi), .. }) => {
                let off = event.off(*chi).map_or(String::new(), |off| format!(" ({off:+.1})"));
                format!("{chi:.3}{off}")
            }
            Some(Modelled { outcome: Some(outcome), .. }) => outcome.name().to_owned(),
            _ => "-".to_owned(),
        };
        let _ = writeln!(
            out,
            "{:<10}{:>4} {:>16} {:>+8.3} {:>16} {:>22}{}",
            measured.mother,
            measured.n,
            format!("{:.3}{sd}", measured.mean),
            measured.mean_signed,
            of(model),
            of(given_first),
            band.map_or(String::new(), band_text)
        );
    }
    out.push('\n');
}

/// The range of χ over sets of constants, and the share of sets with which the cell divides.
fn band_text(band: Band) -> String {
    let divides =
        if band.divides < 1.0 { format!(", divides with {:.0} %", 100.0 * band.divides) } else { String::new() };
    match band.chi {
        Some(Range { p5, p50, p95 }) => format!("  {p50:.3} [{p5:.3}, {p95:.3}]{divides}"),
        None => "  divides with none".to_owned(),
    }
}

fn bins_text(out: &mut String, bins: &[VolumeBin], tests: &[AdjacentTest]) {
    for (k, bin) in bins.iter().enumerate() {
        let sd = bin.sd.map_or(String::new(), |sd| format!(" ± {sd:.3}"));
        let test = k.checked_sub(1).and_then(|k| tests.get(k)).map_or(String::new(), |test| {
            format!("  larger than above: U = {}, p = {:.3e} {}", test.test.u, test.test.p, test.stars)
        });
        let _ = writeln!(out, "  {:<16} n = {:<5} χ = {:.3}{sd}{test}", bin.name(), bin.n, bin.mean);
    }
    out.push('\n');
}

fn regression_text(out: &mut String, regression: &Regression) {
    let _ = writeln!(out, "χ of {} over χ of {}, {} mothers:", regression.y, regression.x, regression.mothers.len());
    let lines = [("through the origin", &regression.through_origin), ("with an intercept", &regression.with_intercept)];
    for (k, (name, line)) in lines.into_iter().enumerate() {
        let Some(Line { slope, slope_error, intercept, r_squared, .. }) = line else { continue };
        let intercept = if k == 1 { format!(", intercept {intercept:+.4}") } else { String::new() };
        let _ = writeln!(out, "  {name}: slope {slope:.4} ± {slope_error:.4}{intercept}, R² = {r_squared:.4}");
    }
    out.push('\n');
}
