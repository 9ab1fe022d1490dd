//! The answer as text.

use std::fmt::{Display, Formatter, Result};

use super::fit_test::FitTest;
use super::free::NOTHING;
use super::hierarchy::EmbryoNumber;
use super::noise::{Noise, NoiseKind};
use super::observations::Unused;
use super::others::{OtherScore, OthersScore, Quantity};
use super::pairs::LEAST;
use super::posterior::{Posterior, PredictedCell, Ridge};
use super::scores::{CellScore, TestedHypothesis};
use super::{HypothesisTest, Pair};
use crate::ranges::Range;

/// Skipped values that are listed.
const MOST_SKIPPED: usize = 10;

/// A number with a given number of digits, or a dash.
fn or_dash(value: Option<f64>, digits: usize) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:.digits$}"))
}

/// A probability.
fn probability(p: f64) -> String {
    match p {
        0.0 => "below 1e-300".to_owned(),
        p if p < 1e-3 => format!("{p:.1e}"),
        p => format!("{p:.3}"),
    }
}

impl Display for HypothesisTest {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let HypothesisTest {
            n,
            left_out,
            units,
            noise,
            hypotheses,
            pairs,
            unused,
            skipped,
            skipped_count,
            matched,
            ..
        } = self;
        let cells = hypotheses.first().map_or(0, |tested| tested.cells.len());
        let count = units.len();
        write!(f, "{n} divisions of {cells} cells; {count} {} left out in turn", left_out.word(count))?;
        if *skipped_count > 0 {
            write!(f, "; {skipped_count} values of the table are not used")?;
        }
        for OthersScore { quantity, sd, rows, .. } in hypotheses.iter().take(1).flat_map(|tested| &tested.others) {
            let what = if *quantity == Quantity::Rounds { "founders" } else { "generations" };
            write!(f, "\n{} of {} {what}, ±{sd}{}", quantity.name(), rows.len(), quantity.scale())?;
        }
        writeln!(f)?;
        writeln!(f, "{noise}\n")?;
        let wide = hypotheses.iter().map(|tested| tested.name.chars().count()).fold(10, usize::max);
        writeln!(f, "{:<wide$}     log L   k       AICc  weight   left out   evidence  p of the fit", "hypothesis")?;
        for tested in hypotheses {
            let TestedHypothesis { name, log_likelihood, k, aicc, weight, loo, log_evidence, fit, .. } = tested;
            let [aicc, weight, loo, evidence] =
                [(aicc, 2), (weight, 3), (loo, 2), (log_evidence, 2)].map(|(value, digits)| or_dash(*value, digits));
            let fit = fit.map_or("-".to_owned(), |fit| fit.to_string());
            writeln!(
                f,
                "{name:<wide$} {log_likelihood:>9.2} {k:>3} {aicc:>10} {weight:>7} {loo:>10} {evidence:>10}  {fit}"
            )?;
        }
        self.undefined(f)?;
        for tested in hypotheses {
            write!(f, "\n{tested}")?;
        }
        if let Some(first) = hypotheses.first() {
            write_cells(f, hypotheses, &first.cells)?;
            (0..first.others.len()).try_for_each(|k| write_others(f, hypotheses, k))?;
        }
        for pair in pairs {
            write!(f, "\n{pair}")?;
            let differs = pair.delta.is_some_and(|delta| delta.abs() >= LEAST);
            if let Some(needed) = pair.needed.filter(|_| differs) {
                write!(f, "; needs about {needed} {}", left_out.word(2))?;
            }
        }
        if !pairs.is_empty() {
            writeln!(f)?;
        }
        for Unused { cell, n, why } in unused {
            write!(f, "\nnot used: {cell}, {n}: {why}")?;
        }
        for value in skipped.iter().take(MOST_SKIPPED) {
            write!(f, "\nskipped {value}")?;
        }
        if *skipped_count > MOST_SKIPPED as u64 {
            write!(f, "\nand {} more", skipped_count - MOST_SKIPPED as u64)?;
        }
        if !unused.is_empty() || !skipped.is_empty() {
            writeln!(f)?;
        }
        matched.iter().try_for_each(|matched| write!(f, "\n{matched}"))
    }
}

impl HypothesisTest {
    /// Why numbers of the first table are missing.
    fn undefined(&self, f: &mut Formatter<'_>) -> Result {
        for TestedHypothesis { name, k, .. } in self.hypotheses.iter().filter(|tested| tested.aicc.is_none()) {
            writeln!(
                f,
                "no AICc of {name}, k = {k} needs {} data or more; weights need the AICc of every hypothesis",
                k + 2
            )?;
        }
        for TestedHypothesis { name, loo_parts, .. } in &self.hypotheses {
            let open = self.units.iter().zip(loo_parts).filter(|(_, part)| part.is_none());
            let open: Vec<&str> = open.map(|(unit, _)| unit.as_str()).collect();
            if !open.is_empty() {
                let open = furrow_input::listed(open, ", ");
                writeln!(
                    f,
                    "left out of {name} is not defined: without {open} the data do not determine its fit or their error"
                )?;
            }
        }
        Ok(())
    }
}

impl Display for Noise {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Noise { kind, sd, exponent, degrees_of_freedom, folded, .. } = self;
        let signs = if *folded { "; χ has lost its sign" } else { "" };
        match (kind, sd) {
            (NoiseKind::Given, _) => write!(f, "errors of χ as given in the table{signs}"),
            (NoiseKind::Common, None) => write!(f, "one error of χ, fitted{signs}"),
            (NoiseKind::Common, Some(sd)) => {
                write!(
                    f,
                    "one error of χ, fitted; within cells ±{sd:.4} on {degrees_of_freedom} degrees of freedom{signs}"
                )
            }
            (NoiseKind::Replicates, sd) => {
                let sd = or_dash(*sd, 4);
                write!(f, "errors of χ from replicates, ±{sd} on {degrees_of_freedom} degrees of freedom")?;
                if *exponent > 0.0 {
                    write!(f, ", growing as volume^-{exponent:.2}")?;
                }
                f.write_str(signs)
            }
        }
    }
}

impl Display for FitTest {
    /// The probability, and the test.
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let p = self.p().map_or("-".to_owned(), probability);
        match self {
            FitTest::ChiSquared { statistic, degrees_of_freedom, .. } => {
                write!(f, "{p} (χ² {statistic:.1} on {degrees_of_freedom})")
            }
            FitTest::LackOfFit { statistic, degrees_of_freedom: [above, below], .. } => {
                write!(f, "{p} (F {statistic:.2} on {above}, {below})")
            }
        }
    }
}

impl Display for TestedHypothesis {
    /// The fitted numbers, and the cells that rest.
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let TestedHypothesis {
            name, cue, sigma, parameters, at_limit, resting, cells, posterior, mirror_image, ..
        } = self;
        let what = if name == cue { String::new() } else { format!(": {cue}") };
        writeln!(f, "{name}{what}")?;
        for number in parameters {
            let open = if number.without_effect { "without effect on χ" } else { "undetermined" };
            let error = number.se.map_or(open.to_owned(), |se| format!("± {se:.4}"));
            let [from, to] = number.searched;
            writeln!(f, "  {:<24} {:>9.4} {error}  (searched {from}..{to})", number.name, number.value)?;
        }
        if let Some(sigma) = sigma {
            writeln!(f, "  {:<24} {sigma:>9.4}", "error of χ")?;
        }
        if let Some(posterior) = posterior {
            write!(f, "{posterior}")?;
        }
        let carrying: Vec<&str> = cells.iter().filter(|cell| cell.has_cue).map(|cell| cell.cell.as_str()).collect();
        match carrying[..] {
            [] if cue != NOTHING => writeln!(f, "  no measured cell has the cue")?,
            [] => {}
            _ => writeln!(f, "  cue in {}", carrying.join(", "))?,
        }
        if let Some(image) = mirror_image {
            writeln!(f, "  its mirror image {image} fits equally well")?;
        }
        for number in at_limit {
            let [from, to] = number.searched;
            writeln!(f, "  {} ended at the edge of its range, from {from} to {to}", number.name)?;
        }
        for cell in cells.iter().filter(|cell| resting.contains(&cell.cell)) {
            let CellScore { cell, n, log_likelihood, .. } = cell;
            writeln!(f, "  {cell} does not divide: n = {n}, {log_likelihood:+.1} to log L")?;
        }
        Ok(())
    }
}

impl Display for Posterior {
    /// Medians with 90 % intervals, ridges and surprises.
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Posterior { samples, log_evidence, parameters, ridges, .. } = self;
        writeln!(f, "  posterior of {samples}: log evidence {log_evidence:.2}")?;
        for number in parameters {
            let Range { p5, p50, p95 } = number.range;
            writeln!(f, "    {:<22} {p50:>9.4} from {p5:.4} to {p95:.4} (90 %)", number.name)?;
        }
        for EmbryoNumber { embryo, mean, sd } in &self.embryos {
            writeln!(f, "      {embryo:<20} {mean:>9.4} ± {sd:.4}")?;
        }
        for Ridge { numbers: [a, b], correlation } in ridges {
            writeln!(f, "    {a} and {b} are open along a line: correlation {correlation:+.3}")?;
        }
        for PredictedCell { cell, chi, rests, p } in self.surprising() {
            let predicted = match chi {
                Some(Range { p5, p95, .. }) if *rests < 0.5 => format!("χ from {p5:.3} to {p95:.3}"),
                _ => format!("at rest in {:.0} %", 100.0 * rests),
            };
            writeln!(f, "    {cell} is surprising, p = {}: predicted {predicted}", probability(*p))?;
        }
        Ok(())
    }
}

impl Display for Pair {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Pair { a, b, delta, se, p, distinguishable, .. } = self;
        let Some(delta) = delta else { return write!(f, "{a} and {b}: no test, left out is not defined") };
        let better = if *delta >= 0.0 { [a, b] } else { [b, a] };
        let error = se.map_or(String::new(), |se| format!(" ± {se:.2}"));
        let untested = if se.is_some() { "no test, all parts differ alike" } else { "no test" };
        let p = p.map_or(untested.to_owned(), |p| format!("p = {}", probability(p)));
        let verdict = if *distinguishable { "distinguishable" } else { "not distinguishable" };
        let [better, other] = better;
        let small = if delta.abs() < LEAST { ", the difference is small" } else { "" };
        write!(f, "{better} above {other} by {:.2}{error}, {p}: {verdict}{small}", delta.abs())
    }
}

/// The cells with χ of each hypothesis.
fn write_cells(f: &mut Formatter<'_>, hypotheses: &[TestedHypothesis], cells: &[CellScore]) -> Result {
    let width = |tested: &TestedHypothesis| tested.name.chars().count().max(6);
    write!(f, "\n{:<10}   n   χ measured      ", "cell")?;
    for tested in hypotheses {
        write!(f, "  {:>wide$}", tested.name, wide = width(tested))?;
    }
    writeln!(f)?;
    for (k, CellScore { cell, n, measured, sd, .. }) in cells.iter().enumerate() {
        let spread = sd.map_or(String::new(), |sd| format!(" ± {sd:.3}"));
        write!(f, "{cell:<10} {n:>3}   {measured:.3}{spread:<10}")?;
        for tested in hypotheses {
            let chi = tested.cells[k].chi.map_or("rests".to_owned(), |chi| format!("{chi:.3}"));
            write!(f, "  {chi:>wide$}", wide = width(tested))?;
        }
        writeln!(f)?;
    }
    Ok(())
}

/// Rounds or lifetimes as observed and in each hypothesis, with the log likelihoods of each hypothesis.
fn write_others(f: &mut Formatter<'_>, hypotheses: &[TestedHypothesis], k: usize) -> Result {
    let all: Vec<(usize, &OthersScore)> =
        hypotheses.iter().map(|tested| (tested.name.chars().count().max(8), &tested.others[k])).collect();
    let Some((_, OthersScore { quantity, rows, .. })) = all.first() else { return Ok(()) };
    write!(f, "\n{:<10}   n  observed", quantity.name())?;
    for (tested, (wide, _)) in hypotheses.iter().zip(&all) {
        write!(f, "  {:>wide$}", tested.name)?;
    }
    for (row, OtherScore { name, n, observed, .. }) in rows.iter().enumerate() {
        write!(f, "\n{name:<10} {n:>3}  {observed:>8.2}")?;
        for (wide, scores) in &all {
            let OtherScore { model, resting, .. } = &scores.rows[row];
            let rests = if *resting > 0 { format!("{resting} rest ") } else { String::new() };
            write!(f, "  {:>wide$}", format!("{rests}{}", or_dash(*model, 2)))?;
        }
    }
    for (what, of) in
        [("log L", (|scores| scores.log_likelihood) as fn(&OthersScore) -> f64), ("left out", |scores| scores.left_out)]
    {
        write!(f, "\n{what:<24}")?;
        for (wide, scores) in &all {
            write!(f, "  {:>wide$.2}", of(scores))?;
        }
    }
    writeln!(f)
}
