//! `furrow calibrate --ensemble` samples admissible constants; `furrow tree --constants` grows a lineage over them.

use super::context::Context;
use super::error::CliError;
use super::interrupt;
use super::messages;
use super::output::{filled, merged, print_as, records_csv, to_json, writable_file, writable_folder};
use super::picture::Picture;
use furrow_analysis::ensemble::{ConstantsSearch, EnsembleError, JOURNAL_COLUMNS};
use furrow_analysis::ranges::{FounderRange, RoundsRange};
use furrow_analysis::{Constants, Ensemble, Journal, LineageRanges, Range, ensemble, ranges, write_constants};
use furrow_cell::settings::Settings;
use furrow_figures::drawing::Format;
use furrow_figures::plot;
use furrow_formats::files::FileSet;
use furrow_formats::{Provenance, write_atomically};
use furrow_lineage::batch::scheduler::workers;
use furrow_lineage::{Lineage, Scenario};
use furrow_mechanics::calibration::Targets;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// The options of a search over sets of constants.
pub struct SearchOptions<'a> {
    pub count: usize,
    pub seed: u64,
    /// The file of the results; with it an interrupted search can be resumed.
    pub out: Option<&'a Path>,
}

/// A kind of search over sets of constants.
pub struct SearchRun {
    /// The schema of the search definition in the journal.
    pub schema: &'static str,
    /// The name of one round of the search.
    pub counted: &'static str,
    /// The same in the progress line.
    pub progress: &'static str,
}

impl SearchRun {
    /// Searches, with a journal next to the file of the results, and writes the results as formatted by `text`.
    pub fn find<T>(
        &self,
        targets: &Targets,
        context: &Context,
        &SearchOptions { count, seed, out }: &SearchOptions<'_>,
        find: fn(&ConstantsSearch<'_>) -> Result<T, EnsembleError>,
        text: impl FnOnce(&T) -> Result<String, CliError>,
    ) -> Result<T, CliError> {
        writable_file("--out", out)?;
        let Settings { cell, numerics, .. } = &context.settings;
        let definition = json!({
            "schema": self.schema, "provenance": Provenance::current(), "targets": targets, "cell": cell,
            "numerics": numerics, (self.counted): count, "seed": seed,
        });
        let open = |file: &Path| {
            let file = PathBuf::from(format!("{}.partial.jsonl", file.display()));
            Journal::open_file(&file, &definition, JOURNAL_COLUMNS.map(str::to_owned).into())
        };
        let journal = out.map(open).transpose()?;
        // Every check is written to the journal immediately.
        if out.is_some() {
            interrupt::finish();
        }
        let found = context.shown(|line| {
            let progress = |done, of| line.show_share(done, of, || self.progress.to_owned());
            let search = ConstantsSearch::new(targets, cell, numerics, (count, seed), interrupt::flag());
            let journal = journal.as_ref();
            find(&ConstantsSearch { threads: context.threads, journal, progress: &progress, ..search })
        });
        if let (Err(EnsembleError::Interrupted), Some(out)) = (&found, out) {
            messages::warning!("sets checked so far are kept beside {}; the same command resumes", out.display());
        }
        let found = found?;
        if let Some(file) = out {
            write_atomically(file, text(&found)?.as_bytes())?;
        }
        if let Some(journal) = journal {
            journal.finish().unwrap_or_else(|error| messages::warning!("the file of checked sets: {error}"));
        }
        Ok(found)
    }
}

/// Samples admissible sets of constants and prints their quantiles.
pub fn sample(
    targets: &Targets,
    context: &Context,
    search: &SearchOptions<'_>,
    picture: &Picture,
) -> Result<(), CliError> {
    let run = SearchRun { schema: "furrow.ensemble", counted: "members", progress: "sets of constants drawn" };
    let table = |found: &Ensemble| write_constants(&found.constants());
    let found = run.find(targets, context, search, ensemble, |found| Ok(table(found)))?;
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
    print_as(context.json, &document, || match search.out {
        Some(file) => format!("{}written to {}\n", ensemble_text(&found), file.display()),
        None => format!("{}\n{}", ensemble_text(&found), table(&found)),
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

/// The output files for a lineage over sets of constants.
const RANGES_FILES: [&str; 4] = ["ranges.csv", "ranges.json", "ranges.svg", "run.json"];

/// Grows a lineage with every set of constants in the table `file`; writes files if an output folder is given.
pub fn grow_over(
    (file, sets): (&Path, &[Constants]),
    scenario: &Scenario,
    context: &Context,
    out: Option<&Path>,
    picture: &Picture,
) -> Result<(), CliError> {
    let Scenario { lineage, settings, .. } = scenario;
    let start = Instant::now();
    writable_folder("--out", out, &RANGES_FILES)?;
    picture.check_apart(out, &RANGES_FILES)?;
    let files = out.map(|folder| FileSet::begin(folder, RANGES_FILES));
    // These trees are not cached, so Ctrl-C may stop immediately.
    interrupt::abort();
    let done = AtomicUsize::new(0);
    let found = context.shown(|line| {
        let shown = || {
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            line.show_share(done, sets.len(), || "sets of constants".to_owned());
        };
        ranges(lineage, settings, sets, context.threads, interrupt::flag(), &shown)
    })?;
    let elapsed_s = start.elapsed().as_secs_f64();
    if let Some(mut files) = files {
        files.stage("ranges.csv", &records_csv(RANGES_COLUMNS, found.founders.iter().map(ranges_row))?)?;
        files.stage("ranges.json", to_json(&found)?.as_bytes())?;
        files.stage("ranges.svg", &plot::rounds::draw_ranges(lineage, &found).bytes(Format::Svg)?)?;
        let record = json!({
            "schema": "furrow.ranges",
            "schema_version": 1,
            "provenance": Provenance::current(),
            "constants": file.display().to_string(),
            "members": found.members,
            "elapsed_s": elapsed_s,
            "threads": workers(context.threads),
            "divisions_solved": found.divisions_solved,
            "memo_hits": found.memo_hits,
        });
        files.stage("run.json", to_json(&record)?.as_bytes())?;
        interrupt::defer(|| files.commit())?;
    }
    picture.write(|| plot::rounds::draw_ranges(lineage, &found))?;
    let written = filled(json!({ "out": out.map(|folder| folder.display().to_string()) }));
    print_as(context.json, &merged(merged(json!(found), json!({ "elapsed_s": elapsed_s })), written), || {
        let written = out.map_or(String::new(), |folder| format!("; files in {}", folder.display()));
        format!("{}{written}\n", ranges_text(lineage, &found, elapsed_s))
    })
}

/// The columns of ranges.csv: 5 %, median and 95 % of every number over the sets; fractions of the weight.
const RANGES_COLUMNS: &str = "founder,divides,chi_p5,chi_p50,chi_p95,min_p5,min_p50,min_p95,mean_p5,mean_p50,mean_p95,\
    max_p5,max_p50,max_p95,full_doublings_p5,full_doublings_p50,full_doublings_p95,symmetric_p5,symmetric_p50,symmetric_p95,\
    terminal_p5,terminal_p50,terminal_p95,within_one_min,within_one_mean,within_one_max,depends_on,rank_correlation";

/// The row of a founder in these columns.
fn ranges_row(founder: &FounderRange) -> Vec<Value> {
    let three = |range: Option<Range>| range.map_or([None; 3], |r| [Some(r.p5), Some(r.p50), Some(r.p95)]);
    let rounds = founder.rounds;
    let of = |read: fn(&RoundsRange) -> Range| three(rounds.as_ref().map(read));
    let counts = [
        of(|r| r.min),
        of(|r| r.mean),
        of(|r| r.max),
        of(|r| r.full_doublings),
        of(|r| r.symmetric),
        of(|r| r.terminal),
    ];
    let near = founder.within_one_round.map_or([None; 3], |near| [near.min, near.mean, near.max]);
    let numbers = three(founder.chi).into_iter().chain(counts.into_iter().flatten()).chain(near);
    let depends = founder.depends_on.as_ref().map(|d| (d.parameter.as_str(), d.rank_correlation)).unzip();
    let first = [json!(founder.name), json!(founder.divides)];
    first.into_iter().chain(numbers.map(|number| json!(number))).chain([json!(depends.0), json!(depends.1)]).collect()
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
    out + &format!("{solved} divisions solved, {hits} memo hits, {elapsed_s:.1} s")
}
