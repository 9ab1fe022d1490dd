//! `furrow calibrate --ensemble` samples admissible constants; `furrow tree --constants` grows a lineage over them.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use super::interrupt;
use super::output::writable_file;
use super::picture::Picture;
use super::prelude::*;
use furrow_analysis::{Ensemble, LineageRanges, Range, ensemble, ranges, read_constants, write_constants};
use furrow_formats::write_atomically;
use furrow_input::read_text;
use furrow_lineage::{Lineage, TreeSettings};
use furrow_mechanics::calibration::Targets;

/// Draws that a statement of the targets excluded.
#[derive(Serialize)]
struct Excluded {
    datum: String,
    sets: usize,
}

/// What `calibrate --ensemble --json` prints.
#[derive(Serialize)]
struct EnsembleAnswer {
    members: usize,
    effective_sample_size: f64,
    draws: usize,
    excluded: Vec<Excluded>,
    /// Weighted quantiles of every constant.
    constants: BTreeMap<String, Range>,
}

/// Samples constants and writes them as a table.
pub fn sample(
    targets: &Targets,
    context: &Context,
    count: usize,
    seed: u64,
    out: Option<&Path>,
    picture: &Picture,
) -> Result<(), CliError> {
    writable_file("--out", out)?;
    let settings = &context.settings;
    let found =
        ensemble(targets, &settings.cell, &settings.numerics, count, seed, context.threads, &AtomicBool::new(false))?;
    let table = write_constants(&found.constants());
    if let Some(file) = out {
        write_atomically(file, table.as_bytes())?;
    }
    picture.write(|| furrow_figures::plot::calibration::draw_ensemble(&found))?;
    let constants = |k: usize| {
        let values = found.members.iter().map(|member| (member.values[k], member.weight)).collect();
        Some((found.parameters[k].to_string(), Range::of(values)?))
    };
    let document = EnsembleAnswer {
        members: found.members.len(),
        effective_sample_size: found.effective_sample_size,
        draws: found.draws,
        excluded: found.excluded.iter().map(|(datum, sets)| Excluded { datum: datum.clone(), sets: *sets }).collect(),
        constants: (0..found.parameters.len()).filter_map(constants).collect(),
    };
    print_as(context.json, &document, || {
        let table = if out.is_some() { String::new() } else { format!("\n{table}") };
        format!("{}{table}", ensemble_text(&found, &document, out))
    })
}

fn ensemble_text(found: &Ensemble, document: &EnsembleAnswer, out: Option<&Path>) -> String {
    let mut text = format!(
        "{} admissible sets of constants out of {} drawn, worth {:.1} independent ones\n\n{:<10} {:>10} {:>10} {:>10}\n",
        document.members, document.draws, document.effective_sample_size, "", "5 %", "median", "95 %"
    );
    for parameter in &found.parameters {
        let name = parameter.to_string();
        if let Some(Range { p5, p50, p95 }) = document.constants.get(&name) {
            let _ = writeln!(text, "{name:<10} {p5:>10.5} {p50:>10.5} {p95:>10.5}");
        }
    }
    for (datum, count) in &found.excluded {
        let _ = writeln!(text, "{datum} excluded {count} of the sets drawn");
    }
    if let Some(file) = out {
        let _ = writeln!(text, "written to {}", file.display());
    }
    text
}

/// What `tree --constants --json` prints.
#[derive(Serialize)]
struct RangesAnswer<'a> {
    #[serde(flatten)]
    ranges: &'a LineageRanges,
    elapsed_s: f64,
}

/// Grows a lineage with every set of constants of a table.
pub fn grow_over(
    file: &Path,
    lineage: &Lineage,
    settings: &TreeSettings,
    context: &Context,
    picture: &Picture,
) -> Result<(), CliError> {
    let start = std::time::Instant::now();
    let sets = read_constants(&read_text(file)?, &file.display().to_string())?;
    let found = ranges(lineage, settings, &sets, context.threads, Some(interrupt::flag()))?;
    let elapsed_s = start.elapsed().as_secs_f64();
    picture.write(|| furrow_figures::plot::rounds::draw_ranges(lineage, &found))?;
    let document = RangesAnswer { ranges: &found, elapsed_s };
    print_as(context.json, &document, || ranges_text(lineage, &found, elapsed_s))
}

fn ranges_text(lineage: &Lineage, found: &LineageRanges, elapsed_s: f64) -> String {
    let mut out = format!(
        "{} over {} sets of constants: median, and the range that holds 90 % of their weight\n\n",
        lineage.name, found.members
    );
    let _ = writeln!(
        out,
        "{:<8} {:>16} {:>22} {:>16} {:>16} {:>16} {:>20}  depends most on",
        "founder", "rounds, min", "mean", "max", "sym", "cells", "χ"
    );
    let whole = |r: Range| format!("{:.0} [{:.0}, {:.0}]", r.p50, r.p5, r.p95);
    let exact = |r: Range| format!("{:.2} [{:.2}, {:.2}]", r.p50, r.p5, r.p95);
    for founder in &found.founders {
        let Some(rounds) = &founder.rounds else {
            let _ = writeln!(out, "{:<8} is never born", founder.name);
            continue;
        };
        let depends = founder
            .depends_on
            .as_ref()
            .map_or(String::new(), |d| format!("{} ({:+.2})", d.parameter, d.rank_correlation));
        let _ = writeln!(
            out,
            "{:<8} {:>16} {:>22} {:>16} {:>16} {:>16} {:>20}  {depends}",
            founder.name,
            whole(rounds.min),
            exact(rounds.mean),
            whole(rounds.max),
            whole(rounds.symmetric),
            whole(rounds.terminal),
            founder.chi.map_or("-".to_owned(), exact),
        );
    }
    out.push('\n');
    for (name, shares) in found.symmetric_doublings.iter().filter(|(_, shares)| shares.len() > 1) {
        let parts: Vec<String> = shares
            .iter()
            .enumerate()
            .filter(|(_, share)| **share > 0.0)
            .map(|(k, share)| format!("{k}: {:.0} %", 100.0 * share))
            .collect();
        let _ = writeln!(out, "{name} divides symmetrically for so many rounds: {}", parts.join(", "));
    }
    for founder in &found.founders {
        let Some(near) = founder.within_one_round else { continue };
        let parts: Vec<String> = [("min", near.min), ("mean", near.mean), ("max", near.max)]
            .into_iter()
            .filter_map(|(name, share)| Some(format!("{name} {:.0} %", 100.0 * share? + 0.0)))
            .collect();
        let _ = writeln!(out, "{}: within one round of the observed: {}", founder.name, parts.join(", "));
    }
    if let Some(share) = found.paper_sentence {
        let _ = writeln!(
            out,
            "EMS and the germline (P4) together within one round of the observed most, the paper's sentence: {:.0} %",
            100.0 * share
        );
    }
    if let Some(cells) = found.cells {
        let _ = writeln!(out, "cells {}", whole(cells));
    }
    let _ =
        writeln!(out, "{} divisions solved, {} memo hits, {elapsed_s:.1} s", found.divisions_solved, found.memo_hits);
    out
}
