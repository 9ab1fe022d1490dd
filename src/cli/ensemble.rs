//! `furrow calibrate --ensemble` samples admissible constants; `furrow tree --constants` grows a lineage over them.

use super::context::Context;
use super::error::CliError;
use super::interrupt;
use super::output::{merged, print_as, writable_file};
use super::picture::Picture;
use furrow_analysis::{Ensemble, LineageRanges, Range, ensemble, ranges, read_constants, write_constants};
use furrow_cell::settings::Settings;
use furrow_figures::plot;
use furrow_formats::write_atomically;
use furrow_input::read_text;
use furrow_lineage::{Lineage, Scenario};
use furrow_mechanics::calibration::Targets;
use serde_json::json;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

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
    let Settings { cell, numerics } = &context.settings;
    let found = ensemble(targets, cell, numerics, count, seed, context.threads, &false.into())?;
    let table = write_constants(&found.constants());
    if let Some(file) = out {
        write_atomically(file, table.as_bytes())?;
    }
    picture.write(|| plot::calibration::draw_ensemble(&found))?;
    let excluded = found.excluded.iter().map(|(datum, sets)| json!({ "datum": datum, "sets": sets }));
    let constants = quantiles(&found).map(|(name, range)| (name, json!(range)));
    let document = json!({
        "members": found.members.len(),
        "effective_sample_size": found.effective_sample_size,
        "draws": found.draws,
        "acceptance": found.acceptance(),
        "excluded": excluded.collect::<Vec<_>>(),
        "constants": constants.collect::<serde_json::Map<_, _>>(),
    });
    print_as(context.json, &document, || match out {
        Some(file) => format!("{}written to {}\n", ensemble_text(&found), file.display()),
        None => format!("{}\n{table}", ensemble_text(&found)),
    })
}

/// Weighted quantiles of every constant.
fn quantiles(found: &Ensemble) -> impl Iterator<Item = (String, Range)> {
    found.parameters.iter().enumerate().filter_map(|(k, parameter)| {
        let values = found.members.iter().map(|member| (member.values[k], member.weight)).collect();
        Some((parameter.to_string(), Range::of(values)?))
    })
}

fn ensemble_text(found: &Ensemble) -> String {
    let (members, draws, worth) = (found.members.len(), found.draws, found.effective_sample_size);
    let accepted = 100.0 * found.acceptance();
    let mut text = format!(
        "{members} admissible sets of constants, worth {worth:.1} independent ones; {draws} drawn, {accepted:.0} % of them admissible\n\n{:<10} {:>10} {:>10} {:>10}\n",
        "", "5 %", "median", "95 %"
    );
    for (name, Range { p5, p50, p95 }) in quantiles(found) {
        let _ = writeln!(text, "{name:<10} {p5:>10.5} {p50:>10.5} {p95:>10.5}");
    }
    for (datum, count) in &found.excluded {
        let _ = writeln!(text, "{datum} excluded {count} of the sets drawn");
    }
    text
}

/// Grows a lineage with every set of constants of a table.
pub fn grow_over(file: &Path, scenario: &Scenario, context: &Context, picture: &Picture) -> Result<(), CliError> {
    let Scenario { lineage, settings, .. } = scenario;
    let start = Instant::now();
    let sets = read_constants(&read_text(file)?, &file.display().to_string())?;
    let found = ranges(lineage, settings, &sets, context.threads, interrupt::flag())?;
    let elapsed_s = start.elapsed().as_secs_f64();
    picture.write(|| plot::rounds::draw_ranges(lineage, &found))?;
    print_as(context.json, &merged(json!(found), json!({ "elapsed_s": elapsed_s })), || {
        ranges_text(lineage, &found, elapsed_s)
    })
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
        let Some(r) = &founder.rounds else {
            let _ = writeln!(out, "{:<8} is never born", founder.name);
            continue;
        };
        let depends = founder.depends_on.as_ref();
        let depends = depends.map_or(String::new(), |d| format!("{} ({:+.2})", d.parameter, d.rank_correlation));
        let [min, max, symmetric, cells] = [r.min, r.max, r.symmetric, r.terminal].map(whole);
        let (name, mean, chi) = (&founder.name, exact(r.mean), founder.chi.map_or("-".to_owned(), exact));
        let _ =
            writeln!(out, "{name:<8} {min:>16} {mean:>22} {max:>16} {symmetric:>16} {cells:>16} {chi:>20}  {depends}");
    }
    out.push('\n');
    for (name, shares) in found.symmetric_doublings.iter().filter(|(_, shares)| shares.len() > 1) {
        let shares = shares.iter().enumerate().filter(|(_, share)| **share > 0.0);
        let parts: Vec<String> = shares.map(|(k, share)| format!("{k}: {:.0} %", 100.0 * share)).collect();
        let _ = writeln!(out, "{name} divides symmetrically for so many rounds: {}", parts.join(", "));
    }
    for founder in &found.founders {
        let Some(near) = founder.within_one_round else { continue };
        let shares = [("min", near.min), ("mean", near.mean), ("max", near.max)].into_iter();
        let parts = shares.filter_map(|(name, share)| Some(format!("{name} {:.0} %", 100.0 * share? + 0.0)));
        let parts = parts.collect::<Vec<_>>().join(", ");
        let _ = writeln!(out, "{}: within one round of the observed: {parts}", founder.name);
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
    let (solved, hits) = (found.divisions_solved, found.memo_hits);
    out + &format!("{solved} divisions solved, {hits} memo hits, {elapsed_s:.1} s\n")
}
