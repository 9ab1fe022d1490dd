//! `furrow compare volumes`: size asymmetries compared with measured ones.

use super::super::messages;
use furrow_measured::events::Division;
use furrow_measured::names::Names;
use furrow_measured::published::{SEA_URCHIN_SOURCE, SOURCE, jankele2021, villoutreix2016};
use furrow_measured::statistics::Line;
use furrow_measured::tracked::TableKind;
use furrow_measured::volumes::{ReadOptions, Unit, Volumes};

use super::by_size::{bins_text, noise_text, trend_text};
use super::{MOST_SKIPPED, check_bins, ended, files, plus_minus, share, significance, skipped_text, trees_of};
use crate::cli::cell::load_lineage;
use crate::cli::context::Context;
use crate::cli::embryos::{MatchArgs, OfEmbryo, files_of, matched_text, of_embryo, sizes_text, voxels, warn_of_sizes};
use crate::cli::error::CliError;
use crate::cli::interrupt;
use crate::cli::output::{number, print, to_json, writable_folder};
use crate::cli::picture::PlotArgs;
use clap::{Args, ValueEnum};
use furrow_analysis::compare::volumes::{
    Band, GroupComparison, ModelDivision, MotherComparison, Regression, Scale, ScaleFrom, SizeCurve, regression_of,
    size_curves,
};
use furrow_analysis::compare::volumes_comparison::{LengthScale, MeasuredVolumes, VolumesComparison, VolumesModel};
use furrow_analysis::{Range, tree_settings};
use furrow_figures::plot;
use furrow_input::InputError;
use furrow_lineage::batch::Memo;
use furrow_lineage::{Lineage, TreeSettings};
use plot::comparison::{self, Comparison};
use std::fmt::Write;
use std::path::PathBuf;

/// Compares size asymmetries of measured divisions with the model's
///
/// A table has one of four layouts. Long: columns embryo, cell and volume (or volume_um3, volume_voxels, relative_volume) and optionally
/// group, frame and n (the number of frames in a mean, without effect). Grid: frames by cells of one embryo, in voxels, such as
/// SampleNN_Volume.csv. Divisions: columns embryo, mother, larger_um3, smaller_um3 and optionally mother_um3, population and
/// generation. χ: columns mother, chi (or chi_signed) and optionally embryo and group. Embryos tracked by other programs can be read too: nuclei (zip) or CD tables of
/// AceTree, spots of TrackMate or Mastodon as CSV with their links in the same folder, GEFF. Without a table the model is compared with
/// published means. The model's χ is computed twice: from the model's zygote, and from the measured sizes of AB and P1.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow compare volumes
  furrow compare volumes --preset sulston1983 --plot chi.svg --json
  furrow compare volumes --published villoutreix2016
  furrow compare volumes data/jankele2021_volumes.csv --regress wt,ctrl")]
pub struct VolumesArgs {
    /// Tables of cell volumes (CSV), tracked embryos (zip, CSV, XML, txt, folder), or folders of these
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Published means to compare if no table is given
    #[arg(help_heading = "Tables", long, value_name = "NAME", value_enum, default_value_t = Published::Jankele2021, conflicts_with = "files")]
    published: Published,
    /// Tables of a second condition, for a regression
    #[arg(help_heading = "Tables", long, value_name = "FILE", requires = "files")]
    against: Vec<PathBuf>,
    /// Edge length of a voxel in µm, which converts voxels to µm³, and diameters in pixels to µm; EMBRYO=UM sets it for one embryo
    #[arg(help_heading = "Tables", long, value_name = "UM|EMBRYO=UM", value_parser = of_embryo, requires = "files")]
    voxel: Vec<OfEmbryo>,
    #[command(flatten)]
    matching: MatchArgs,
    /// Unit of volumes in tables that give no unit: um3, voxels or relative; default voxels for a grid of whole numbers, otherwise
    /// relative if no number is above 1.5 and µm³ if one is
    #[arg(help_heading = "Tables", long, value_name = "UNIT", value_parser = str::parse::<Unit>, requires = "files")]
    unit: Option<Unit>,
    /// Two groups to regress on each other, such as wt,ctrl
    #[arg(help_heading = "Statistics", long, value_name = "X,Y")]
    regress: Option<String>,
    /// Populations of a table of divisions to use, such as Mac,Mes; default all
    #[arg(help_heading = "Tables", long, value_name = "NAME,NAME,..", value_delimiter = ',', requires = "files")]
    population: Option<Vec<String>>,
    /// Edges of the bins of the mother's volume, in ascending order, such as 100,1000,10000; default decades
    #[arg(help_heading = "Statistics", long, visible_alias = "classes", value_name = "V,V,..", value_delimiter = ',', value_parser = number,
        requires = "files")]
    bins: Option<Vec<f64>>,
    /// L_h in the cube root of the tables' unit (µm for µm³), or fit to use all mothers. The default is the lineage file's L_h,
    /// otherwise the L_h at which P0 has its measured size, or fit if P0 was not measured
    #[arg(help_heading = "Statistics", long, value_name = "LENGTH|fit", value_parser = wanted_scale,
        requires = "files")]
    length_scale: Option<LengthScale>,
    /// Sets of constants from calibrate --ensemble, for a range of the model's χ
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

/// The value of --published.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Published {
    /// C. elegans, by mother
    Jankele2021,
    /// Sea urchin, by population and generation
    Villoutreix2016,
}

/// Reads the value of --length-scale.
fn wanted_scale(text: &str) -> Result<LengthScale, String> {
    match text {
        "fit" => Ok(LengthScale::Fitted),
        _ => Ok(LengthScale::Given(number(text)?)),
    }
}

pub fn run(args: &VolumesArgs, context: &Context) -> Result<(), CliError> {
    check(args)?;
    let picture = args.plot.file()?;
    writable_folder("--out", args.out.as_deref(), &files::NAMES)?;
    let lineage = load_lineage(args.lineage.as_deref())?;
    let sets = match &args.constants {
        Some(file) => context.constants(file, &lineage, [])?,
        None => Vec::new(),
    };
    context.check_taken(&[&lineage], [])?;
    let measured = read(args, &args.matching.names(&lineage)?)?;
    let settings: TreeSettings =
        tree_settings(context.settings_in(&lineage.units())?, &lineage, 0, context.quantisation);
    let memo = context.memo()?;
    let grow = |lineages| {
        let trees = trees_of(lineages, &memo, context)?;
        if !sets.is_empty() {
            // Trees over sets of constants are not cached.
            interrupt::abort();
        }
        Ok::<_, CliError>(trees)
    };
    let found = context.scheduled(|options| {
        let model = VolumesModel {
            lineage: &lineage,
            own_cues: args.lineage.is_some(),
            settings: &settings,
            constants: &sets,
            length_scale: args.length_scale.unwrap_or(LengthScale::Usual),
            memo: &memo,
            options,
            cancel: interrupt::flag(),
        };
        let regress = |groups: &[GroupComparison]| Ok(regressions(args, groups)?);
        VolumesComparison::of(&measured, args.bins.as_deref(), &model, grow, regress)
    })?;
    warn_of_sizes(&found.embryos);
    let json = to_json(&found)?;
    if let Some(out) = &args.out {
        files::write(out, &found, &measured.divisions.divisions, &json)?;
    }
    if picture.is_wanted() {
        let (groups, bins, divisions) = (&found.groups, &found.bins, measured.sized());
        let unit = found.unit.map_or(String::new(), |unit| format!("({})", unit.symbol()));
        let length = found.length_scale.map(|scale| scale.length);
        let curves = curves(&lineage, &settings, (divisions, length), &memo, context)?;
        let noise = found.noise.as_ref().map_or(&[][..], |null| &null.bins);
        picture.write(|| comparison::draw(&Comparison { groups, divisions, bins, noise, unit, length, curves }))?;
    }
    if context.json { print(&json) } else { print(&text(&found, &measured, measured.volumes.files > 1)) }
}

fn text(found: &VolumesComparison, measured: &MeasuredVolumes, is_of_several: bool) -> String {
    let source = found.source.map_or(String::new(), |source| format!("measured: means published by {source}\n\n"));
    let groups: String = found.groups.iter().map(group_text).collect();
    let trend = if measured.volumes.divisions.is_empty() { String::new() } else { trend_text(&found.trend) };
    let noise = found.noise.as_ref().map_or(String::new(), noise_text);
    let regressions: String = found.regressions.iter().map(regression_text).collect();
    let scale = scale_text(found.unit, found.length_scale);
    // For one table with many embryos they are only in the JSON.
    let sizes = if is_of_several { sizes_text(&found.embryos, found.unit) } else { String::new() };
    let matched = matched_text(&found.matched);
    [source, groups, bins_text(found), trend, noise, regressions, scale, sizes, matched, used_text(found)].concat()
}

/// The model's χ over the sizes of the measured mothers, for the picture; empty without a length scale.
fn curves(
    lineage: &Lineage,
    settings: &TreeSettings,
    (divisions, length): (&[Division], Option<f64>),
    memo: &Memo,
    context: &Context,
) -> Result<Vec<SizeCurve>, CliError> {
    let Some(length) = length else { return Ok(Vec::new()) };
    let radii = divisions.iter().map(|d| (0.75 / std::f64::consts::PI * d.mother_volume()).cbrt() / length);
    let [least, most] = radii.fold([f64::INFINITY, 0.0], |[a, b], r| [f64::min(a, r), f64::max(b, r)]);
    // The range is from a cell at rest to a cell slightly larger than the zygote.
    let [from, to] = [least.clamp(SMALLEST, settings.cell.r0), most.clamp(SMALLEST, 1.2 * settings.cell.r0)];
    if from >= to {
        return Ok(Vec::new());
    }
    Ok(context.scheduled(|options| size_curves(lineage, settings, [from, to], memo, options))?)
}

/// Smallest radius of the curve, in L_h: smaller cells stay at rest.
const SMALLEST: f64 = 1.0;

fn check(args: &VolumesArgs) -> Result<(), InputError> {
    if let Some(LengthScale::Given(length)) = args.length_scale {
        let allowed = "a length from 1e-6 to 1e6, in the cube root of the tables' unit, or fit";
        InputError::require((1e-6..=1e6).contains(&length), "--length-scale", "length_scale", length, allowed)?;
    }
    check_bins(args.bins.as_deref())
}

fn read(args: &VolumesArgs, cells: &Names) -> Result<MeasuredVolumes, InputError> {
    if args.files.is_empty() {
        cells.require_met()?;
        return Ok(match args.published {
            Published::Jankele2021 => MeasuredVolumes::published(SOURCE, jankele2021()?),
            Published::Villoutreix2016 => MeasuredVolumes::published(SEA_URCHIN_SOURCE, villoutreix2016()?),
        });
    }
    let (mut volumes, voxel) = (Volumes::default(), voxels(&args.voxel)?);
    // If the tables have no groups, the two conditions become two groups.
    let names = |name: &str| (!args.against.is_empty()).then(|| name.to_owned());
    for (files, group) in [(&args.files, names("measured")), (&args.against, names("against"))] {
        let options =
            ReadOptions { voxel: voxel.clone(), group, unit: args.unit, names: cells.clone(), class: Vec::new() };
        for file in &files_of(files, TableKind::Volumes)? {
            volumes.read_file(file, &options)?;
        }
    }
    volumes.require_used(&args.files[0].display().to_string())?;
    volumes.require_options()?;
    cells.require_met()?;
    if volumes.of_nuclei {
        messages::warning!("AceTree and StarryNite measure nuclei: χ is that of their nuclei, not of the cells");
    }
    MeasuredVolumes::of(volumes, ("--population", args.population.as_deref()))
}

/// The requested regressions, of named groups or of two conditions.
fn regressions(args: &VolumesArgs, groups: &[GroupComparison]) -> Result<Vec<Regression>, InputError> {
    let names = match &args.regress {
        Some(text) => text.split_once(',').map(|(x, y)| (x.trim(), y.trim())).filter(|(x, y)| x != y),
        None => Some(("measured", "against")),
    };
    let found = names.and_then(|(x, y)| regression_of(groups, x, y));
    let known: Vec<&str> = groups.iter().map(|group| group.group.as_str()).filter(|name| !name.is_empty()).collect();
    let known =
        if known.is_empty() { "the tables have none".to_owned() } else { format!("groups are {}", known.join(", ")) };
    let allowed = format!("two groups of the tables, as X,Y; {known}");
    // Tables with groups lack the names of the two conditions.
    let fine = found.is_some() || args.regress.is_none();
    InputError::require(
        fine,
        "--regress",
        "regress",
        format!("{:?}", args.regress.as_deref().unwrap_or_default()),
        allowed,
    )?;
    Ok(found.into_iter().filter(|_| args.regress.is_some() || !args.against.is_empty()).collect())
}

fn scale_text(unit: Option<Unit>, scale: Option<Scale>) -> String {
    let Some(Scale { length, from }) = scale else { return String::new() };
    let unit = match unit {
        Some(Unit::CubicMicrometres) => "µm",
        Some(Unit::Voxels) => "edges of a voxel",
        _ => "in the cube root of the unit",
    };
    let from = match from {
        ScaleFrom::Given => "as given",
        ScaleFrom::P0 => "by P0",
        ScaleFrom::Lineage => "by the lineage file",
        ScaleFrom::Fitted => "by all mothers that the model has",
    };
    format!("one L_h is {length:.4} {unit}, {from}\n")
}

/// The numbers of used and of unused volumes.
fn used_text(found: &VolumesComparison) -> String {
    let VolumesComparison { used, skipped, skipped_count, divisions, half_seen, .. } = found;
    let used = match (found.source, found.unit) {
        (Some(_), _) => String::new(),
        (None, Some(Unit::OfMother)) => format!("χ of {divisions} divisions used, {skipped_count} skipped\n"),
        (None, _) => format!(
            "{used} volumes used, {skipped_count} skipped; {divisions} divisions with both daughters, {} with one\n",
            half_seen.len()
        ),
    };
    used + &skipped_text(&[(skipped, *skipped_count)])
}

fn group_text(group: &GroupComparison) -> String {
    let name = if group.group.is_empty() { "measured".to_owned() } else { format!("group {}", group.group) };
    let with_bands = group.events.iter().any(|event| event.band.is_some());
    let bands = if with_bands { "  over the constants: median, 90 %" } else { "" };
    let wide = group.events.iter().map(|event| event.measured.mother.len()).fold(10, usize::max);
    let is_modelled = group.events.iter().any(|event| event.model.is_some());
    let with_firsts = group.events.iter().any(|event| event.given_first.is_some());
    let of_model = if is_modelled { "   model (sd off)" } else { "" };
    let of_firsts = if with_firsts { "     AB, P1 as measured" } else { "" };
    let mut out = format!(
        "{name}, {} embryos\n{:<wide$}   n       χ measured   signed{of_model}{of_firsts}{bands}\n",
        group.embryos, "mother"
    );
    for event in &group.events {
        let MotherComparison { measured, model, given_first, band, .. } = event;
        let of = |model: &Option<ModelDivision>| {
            let (chi, outcome) = model.map_or((None, None), |model| (model.chi, model.outcome));
            let off = chi.and_then(|chi| event.off(chi)).map_or(String::new(), |off| format!(" ({off:+.1})"));
            ended(chi, outcome) + &off
        };
        let chi = format!("{:.3}{}", measured.mean, plus_minus(measured.sd, measured.n));
        let model = if is_modelled { format!(" {:>16}", of(model)) } else { String::new() };
        let first = if with_firsts { format!(" {:>22}", of(given_first)) } else { String::new() };
        let band = band.map_or(String::new(), band_text);
        let (mother, n) = (&measured.mother, measured.n);
        let signed = measured.mean_signed.map_or("-".to_owned(), |signed| format!("{signed:+.3}"));
        let _ = writeln!(out, "{mother:<wide$}{n:>4} {chi:>16} {signed:>8}{model}{first}{band}");
    }
    if !is_modelled && !with_firsts {
        out += "the model's tree has none of these mothers\n";
    }
    out + "\n"
}

/// The range of χ over sets of constants, and the fraction of sets with which the cell divides.
fn band_text(Band { chi, divides }: Band) -> String {
    let share = if divides < 1.0 { format!(", divides with {:.0} %", 100.0 * divides) } else { String::new() };
    match chi {
        Some(Range { p5, p50, p95 }) => format!("  {p50:.3} [{p5:.3}, {p95:.3}]{share}"),
        None => "  divides with none".to_owned(),
    }
}

fn regression_text(regression: &Regression) -> String {
    let Regression { x, y, mothers, only_x, only_y, through_origin, with_intercept } = regression;
    let mut out = format!("χ of {y} over χ of {x}, {} mothers:\n", mothers.len());
    for (name, line) in [("through the origin", through_origin), ("with an intercept", with_intercept)] {
        let Some(line) = line else { continue };
        let Line { slope, slope_error, intercept, intercept_error, r_squared, r_squared_about_mean, .. } = line;
        let [about, about_mean] = [r_squared, r_squared_about_mean].map(|of| share(*of, 4));
        let rest = match intercept_error {
            Some(error) => format!(", intercept {intercept:+.4} ± {error:.4}, R² = {about_mean} about the mean"),
            None => format!(", R² = {about} about 0, {about_mean} about the mean"),
        };
        let _ = writeln!(out, "  {name}: slope {slope:.4} ± {slope_error:.4}{}{rest}", significance(line));
    }
    for (group, only) in [(x, only_x), (y, only_y)].into_iter().filter(|(_, only)| !only.is_empty()) {
        let shown: Vec<&str> = only.iter().take(MOST_SKIPPED).map(String::as_str).collect();
        let more = if only.len() > shown.len() { ", …" } else { "" };
        let _ = writeln!(out, "  skipped, measured in {group} alone: {} ({}{more})", only.len(), shown.join(", "));
    }
    out + "\n"
}
