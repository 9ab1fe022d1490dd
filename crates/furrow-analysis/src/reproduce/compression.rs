//! Figure 6: χ in tighter shells, of the model's cells and of a table with compressed embryos.

use super::context::{Figure, Finding, ReproduceError};
use super::embryo::{GERMLINE, cell_named, grow};
use super::readings::chi_in_words;
use furrow_cell::Cell;
use furrow_lineage::{Lineage, Tree};
use furrow_measured::events::{Division as Measured, MotherSummary, summaries};
use furrow_measured::statistics::line_through_origin;

/// Names of the groups of uncompressed and compressed embryos in a table.
const COMPRESSED: [&str; 2] = ["uncompressed", "compressed"];

/// The slope of χ in compressed embryos over χ in the others, by mother; `None` without such groups.
fn slope(divisions: &[Measured]) -> Option<Finding> {
    let groups = summaries(divisions);
    let [x, y] = COMPRESSED.map(|name| groups.iter().find(|group| group.group == name));
    let (x, y) = (x?, y?);
    let both = |event: &MotherSummary| {
        let other = y.events.iter().find(|other| other.mother == event.mother)?;
        Some([event.mean, other.mean])
    };
    let points: Vec<[f64; 2]> = x.events.iter().filter_map(both).collect();
    let line = line_through_origin(&points)?;
    let note = format!("R² = {:.3} of {} mothers", line.r_squared.unwrap_or_default(), points.len());
    Some(Finding::new("compression_slope", line.slope).noting(note))
}

/// The slope that the paper prints, of χ in compressed embryos over χ in others.
const AMPLIFIED: f64 = 1.151;
/// Ratios of χ that count as 15 %: a third of it off to either side.
const ABOUT: [f64; 2] = [1.10, 1.20];
/// The loosest shell in which uncompressed embryos may be, and halvings of the interval from there to the tree's ε.
const LOOSEST: f64 = 0.75;
const HALVINGS: usize = 12;

/// Figure 6B: χ of the germline in a looser shell.
pub fn compression(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let tree = grow(figure, &Lineage::c_elegans()?)?;
    let finding = amplified(figure, &tree)?;
    figure.findings.push(finding);
    figure.findings.extend(figure.context.measured.and_then(|(_, divisions)| slope(divisions)));
    Ok(())
}

/// χ of the tree's cells of these names in a shell of another ε; `None` for a cell that is not born or does not divide.
fn chi_in(
    figure: &mut Figure<'_>,
    tree: &Tree,
    names: [&str; 4],
    epsilon: f64,
) -> Result<[Option<f64>; 4], ReproduceError> {
    let context = figure.context;
    let mut out = [None; 4];
    let of = |k: usize| {
        let cell = cell_named(tree, names[k])?;
        let whole = Cell { r0: cell.r0, epsilon, ..context.settings.cell.clone() };
        Some((k, context.input(whole.with_cue(cell.cue.clone()))))
    };
    let (places, inputs): (Vec<usize>, Vec<_>) = (0..names.len()).filter_map(of).unzip();
    for (k, division) in places.into_iter().zip(figure.divisions(inputs)?) {
        out[k] = division.and_then(|division| division.chi());
    }
    Ok(out)
}

/// The looser shell over which χ of the germline rises with the printed slope, and how much each χ does.
fn amplified(figure: &mut Figure<'_>, tree: &Tree) -> Result<Finding, ReproduceError> {
    let tight = figure.context.settings.cell.epsilon;
    let in_tight = chi_in(figure, tree, GERMLINE, tight)?;
    let ratios = |loose: &[Option<f64>; 4]| -> Option<Vec<[f64; 2]>> {
        loose.iter().zip(in_tight).map(|(loose, tight)| Some([(*loose)?, tight?])).collect()
    };
    let (mut low, mut high, mut found) = (LOOSEST, tight, None);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let Some(points) = ratios(&chi_in(figure, tree, GERMLINE, middle)?) else {
            return Ok(Finding::not_computed("compression", "not all of P0 to P3 divide"));
        };
        let Some(line) = line_through_origin(&points) else { break };
        let more = line.slope > AMPLIFIED;
        found = Some((middle, line.slope, points));
        if more { low = middle } else { high = middle }
    }
    let Some((epsilon, slope, points)) = found else {
        return Ok(Finding::not_computed("compression", "χ is 0"));
    };
    let each: Vec<f64> = points.iter().map(|[loose, tight]| tight / loose).collect();
    let alike = each.iter().all(|ratio| (ABOUT[0]..=ABOUT[1]).contains(ratio));
    let named = GERMLINE.iter().zip(&each).map(|(name, ratio)| format!("{name} ×{ratio:.2}"));
    let text = format!("slope {slope:.3} from ε = {epsilon:.4} to {tight}: {}", named.collect::<Vec<_>>().join(", "));
    Ok(Finding::judged("compression", (alike && (slope / AMPLIFIED - 1.0).abs() < 0.01, text)))
}

/// Cells that figure 6C shows.
const LINEAGES: [&str; 4] = ["ABarapapp", "MSpapap", "ABarapaap", "ABaraaapp"];

/// Figure 6C: χ of single cells in a looser shell and in the tree's shell.
pub fn lineages(figure: &mut Figure<'_>) -> Result<(), ReproduceError> {
    let tree = grow(figure, &Lineage::c_elegans()?)?;
    let tight = figure.context.settings.cell.epsilon;
    let shells = [tight - 0.01, tight];
    let mut chi = [[None; 4]; 2];
    for (of_shell, epsilon) in chi.iter_mut().zip(shells) {
        *of_shell = chi_in(figure, &tree, LINEAGES, epsilon)?;
    }
    let [loose, compressed] = chi;
    let rises = |(loose, tight): (&Option<f64>, &Option<f64>)| loose.zip(*tight).is_some_and(|(a, b)| b > a);
    let holds = loose.iter().zip(&compressed).all(rises);
    let words =
        LINEAGES.iter().zip(loose.iter().zip(compressed)).map(|(name, (loose, tight))| match cell_named(&tree, name) {
            None => format!("{name} is not born"),
            Some(_) => format!("{name} {}, {}", chi_in_words(*loose), chi_in_words(tight)),
        });
    figure.judge("compressed_lineages", holds, words.collect::<Vec<_>>().join("; "));
    Ok(())
}
