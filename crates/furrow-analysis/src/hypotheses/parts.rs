//! Samples of a posterior drawn on several machines, put together.
//!
//! Each part is a sample by itself, with random numbers of its own. Its evidence says how much of the posterior it found, so that its
//! points weigh
//!
//! * \[F.18 parts\] w = Z_p/(n_p Σ_q Z_q) for n_p points of part p with evidence Z_p.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use furrow_input::table::{Table, text as text_of};
use furrow_input::{InputError, open_file, shown};

use crate::ensemble::relative_weights;
use crate::shard::Shard;
use crate::table::csv_of;

/// Columns of a part beside its numbers.
pub(super) const LOG_EVIDENCE: &str = "log_evidence";
pub(super) const ASKED: &str = "asked";
pub(super) const PART: &str = "part";
/// The column of hypotheses, where a table has several.
pub(super) const HYPOTHESIS: &str = "hypothesis";

/// Parts put together.
#[derive(Clone, Debug, PartialEq)]
pub struct MergedSample {
    /// The table: a column for each number and one of weights, which sum to 1 for each hypothesis.
    pub csv: String,
    /// Its rows.
    pub points: usize,
    /// The parts.
    pub parts: usize,
    /// The log evidence of each hypothesis: the mean over parts.
    pub log_evidence: BTreeMap<String, f64>,
}

/// A row of a part.
struct Row {
    texts: Vec<String>,
    hypothesis: String,
    log_evidence: f64,
    /// The hash of its data and model, if the part has it.
    asked: Option<String>,
    part: u64,
}

/// Puts the parts of a sample together, as `furrow test --shard` wrote them.
///
/// # Errors
/// A file that is no part, parts with different columns, of different data or models, of different numbers of parts, and a part that is
/// missing or there twice.
pub fn merge_parts(files: &[PathBuf]) -> Result<MergedSample, InputError> {
    let (mut head, mut rows, mut seen): (Vec<String>, Vec<Row>, BTreeMap<u64, String>) = Default::default();
    let mut of_all = None;
    let mut asked: BTreeMap<String, (String, Option<String>)> = BTreeMap::new();
    for file in files {
        let source = file.display().to_string();
        let (columns, read, Shard { number, of }) = part(file, &source)?;
        let allowed = format!("the columns of {}: {}", files[0].display(), head.join(","));
        InputError::require(head.is_empty() || head == columns, &source, "columns", columns.join(","), allowed)?;
        let parts = *of_all.get_or_insert(of);
        InputError::require(parts == of, &source, PART, format!("{number}/{of}"), format!("a part of {parts}"))?;
        if let Some(other) = seen.insert(number, source.clone()) {
            let allowed = format!("each part once; {other} is the same");
            return Err(InputError::not_allowed(source, PART, format!("{number}/{of}"), allowed));
        }
        for Row { hypothesis, asked: own, .. } in &read {
            let (first, known) = asked.entry(hypothesis.clone()).or_insert_with(|| (source.clone(), own.clone()));
            let allowed =
                || format!("as in {first}: parts are of one table, cue, list of free numbers, noise and lineage");
            let value = own.as_deref().unwrap_or("(none)");
            InputError::require(known == own, &source, ASKED, value, allowed())?;
        }
        head = columns;
        rows.extend(read);
    }
    let parts = of_all.unwrap_or_default();
    if let Some(missing) = (1..=parts).find(|number| !seen.contains_key(number)) {
        let allowed = format!("all {parts} parts; {missing}/{parts} is missing");
        return Err(InputError::not_allowed("parts", PART, format!("{} files", files.len()), allowed));
    }
    Ok(weighed(head, &rows, seen.len()))
}

/// The columns of a part without those that are about it, its rows, and which it is.
fn part(file: &Path, source: &str) -> Result<(Vec<String>, Vec<Row>, Shard), InputError> {
    let mut table = Table::open(open_file(file)?, source)?;
    let (_, mut columns) = table.header(|_| false)?;
    let place = |name: &str| {
        let allowed = "a part of a sample, which furrow test --shard writes";
        let found = columns.iter().position(|column| column == name);
        found.ok_or_else(|| InputError::not_allowed(source, "columns", columns.join(","), allowed))
    };
    let (evidence, number) = (place(LOG_EVIDENCE)?, place(PART)?);
    let [hypothesis, asked] = [HYPOTHESIS, ASKED].map(|name| columns.iter().position(|column| column == name));
    let (mut rows, mut which): (Vec<Row>, Option<Shard>) = (Vec::new(), None);
    while let Some(row) = table.next_row()? {
        let line = format!("{source}:{}", row.line);
        let texts: Vec<String> = (0..columns.len()).map(|k| text_of(row.text(k)).into_owned()).collect();
        let refused = |k: usize, allowed: &str| InputError::not_allowed(&line, &columns[k], shown(&texts[k]), allowed);
        let log_evidence = row.number(evidence).map_err(|_| refused(evidence, "a number"))?;
        let shard = texts[number].parse::<Shard>().map_err(|allowed| refused(number, &allowed))?;
        if *which.get_or_insert(shard) != shard {
            return Err(refused(number, "the same in every row"));
        }
        let hypothesis = hypothesis.map_or(String::new(), |k| texts[k].clone());
        let own = asked.map(|k| texts[k].clone());
        let kept = texts.into_iter().enumerate().filter(|(k, _)| ![evidence, number].contains(k) && Some(*k) != asked);
        let texts = kept.map(|(_, text)| text).collect();
        rows.push(Row { texts, hypothesis, log_evidence, asked: own, part: shard.number });
    }
    let shard = which.ok_or_else(|| InputError::not_allowed(source, "rows", "(none)", "at least one point"))?;
    columns.retain(|name| ![LOG_EVIDENCE, ASKED, PART].contains(&name.as_str()));
    Ok((columns, rows, shard))
}

fn weighed(head: Vec<String>, rows: &[Row], parts: usize) -> MergedSample {
    // Of each hypothesis and part the log evidence and the points.
    let mut found: BTreeMap<&str, BTreeMap<u64, (f64, usize)>> = BTreeMap::new();
    for row in rows {
        let of_part = found.entry(&row.hypothesis).or_default().entry(row.part).or_insert((row.log_evidence, 0));
        of_part.1 += 1;
    }
    let sums: BTreeMap<&str, (f64, f64)> = found
        .iter()
        .map(|(name, of)| {
            let (weights, most) = relative_weights(of.values().map(|(log, _)| *log), 1.0);
            (*name, (most, weights.into_iter().sum()))
        })
        .collect();
    let weight = |row: &Row| {
        let ((most, sum), (log, n)) = (sums[&*row.hypothesis], found[&*row.hypothesis][&row.part]);
        (log - most).exp() / sum / n as f64
    };
    let head: Vec<String> = head.into_iter().chain(["weight".to_owned()]).collect();
    let line = |row: &Row| row.texts.iter().cloned().chain([weight(row).to_string()]).collect();
    let log_evidence = sums.iter().map(|(name, (most, sum))| ((*name).to_owned(), most + (sum / parts as f64).ln()));
    MergedSample {
        csv: csv_of(std::iter::once(head).chain(rows.iter().map(line))),
        points: rows.len(),
        parts,
        log_evidence: log_evidence.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two parts with evidences 3 : 1 and 2 and 1 points; faults name the file.
    #[test]
    fn points_weigh_by_the_evidence_of_their_part() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let file = folder.path().join(name);
            std::fs::write(&file, text).unwrap();
            file
        };
        let log = 3f64.ln() - 1000.0;
        let first = write("a.csv", &format!("epsilon,log_evidence,part\n0.8,{log},1/2\n0.81,{log},1/2\n"));
        let second = write("b.csv", "epsilon,log_evidence,part\n0.9,-1000,2/2\n");
        let found = merge_parts(&[first.clone(), second.clone()]).unwrap();
        assert_eq!((found.points, found.parts), (3, 2));
        assert!((found.log_evidence[""] - (2f64.ln() - 1000.0)).abs() < 1e-9, "{found:?}");
        let sets = crate::constants::read_constants(&found.csv, "whole.csv").unwrap();
        let weights: Vec<f64> = sets.iter().map(|set| set.weight).collect();
        assert!(weights.iter().zip([0.375, 0.375, 0.25]).all(|(a, b)| (a - b).abs() < 1e-9), "{weights:?}");
        let refused = |files: &[PathBuf]| merge_parts(files).unwrap_err().to_string();
        assert!(refused(std::slice::from_ref(&first)).contains("all 2 parts; 2/2 is missing"));
        assert!(refused(&[first.clone(), first.clone(), second]).contains("each part once"));
        let other = write("c.csv", "xi_s,log_evidence,part\n25,-1,2/2\n");
        assert!(refused(&[first.clone(), other]).contains("the columns of"));
        let other = write("d.csv", "epsilon,log_evidence,part\n25,-1,2/3\n");
        assert!(refused(&[first, other]).contains("part = 2/3: must be a part of 2"));
        let [one, other] = [("f.csv", "aa,1/2"), ("g.csv", "bb,2/2")]
            .map(|(name, of)| write(name, &format!("epsilon,log_evidence,asked,part\n0.8,-1,{of}\n")));
        assert!(refused(&[one, other]).contains("g.csv: asked = bb: must be as in "));
        let whole = write("e.csv", "epsilon\n0.8\n");
        assert!(refused(&[whole]).contains("which furrow test --shard writes"));
    }
}
