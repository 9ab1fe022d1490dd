//! Founder trees grown by the same functions as `furrow tree`, so that the counts are the same.

use furrow_cell::Cue;
use furrow_formats::{founder_rows, newick, tree_from_json, tree_to_json};
use furrow_lineage::batch::{Memo, Progress, Quantisation, SchedulerOptions};
use furrow_lineage::{EndRule, Grower, Lineage, Scope, Thresholds, TreeSettings, expected_work};
use furrow_mechanics::critical::CriticalRadii;
use furrow_mechanics::division::{DivisionInput, divide};
use furrow_report::OfTree;
use serde::Deserialize;

use super::answer::{Answer, PageError};
use super::limits::check;

/// The inputs of a tree: the head of `tree.json` with the changes that the reader of the page has made.
#[derive(Debug, Deserialize)]
struct Request {
    lineage: Lineage,
    #[serde(flatten)]
    settings: TreeSettings,
    /// Replaces every cue of the lineage, as `--cue` does: `none`, a name of the lineage, or terms.
    cue: Option<String>,
}

/// Grows a tree and answers with the text of its `tree.json`. `tell` receives the numbers of solved and of waiting
/// divisions.
///
/// # Errors
/// The request or the cue cannot be read. A cell without a computable division ends its branch and is not an error.
pub fn regrow(request: &[u8], tell: &dyn Fn(usize, usize)) -> Result<Answer, PageError> {
    let Request { mut lineage, settings, cue } = serde_json::from_slice(request)?;
    check(&settings.cell, &settings.numerics)?;
    if let Some(cue) = cue {
        lineage = lineage.carrying(&cue, &settings.cell)?;
    }
    let memo = Memo::new(Quantisation::with_relative_step(settings.r0_step).unwrap_or(Quantisation::DEFAULT));
    // As `furrow tree` does.
    let rule = Thresholds::new(CriticalRadii::new(&settings.numerics)).with_scope(Scope::FirstIfKnown);
    let plain = settings.cell.clone().with_cue(Cue::none());
    let order = |input: &DivisionInput| {
        rule.critical_radius(&plain).map_or(input.cell.r0, |critical| expected_work(critical)(input))
    };
    let progress = |Progress { solved, running, queued, .. }: Progress| tell(solved, running + queued);
    let options = SchedulerOptions {
        threads: 1,
        progress: Some(&progress),
        expected_work: &order,
        ..SchedulerOptions::default()
    };
    let grower = Grower { lineage: &lineage, settings, ends: EndRule::Thresholds(&rule), memo: &memo, options };
    let (tree, _) = grower.grow(divide)?;
    Ok(Answer::of(tree_to_json(&tree)?))
}

/// The `tree.nwk` of a tree, as a JSON text, from its `tree.json`.
///
/// # Errors
/// The request is not a `tree.json`.
pub fn as_newick(request: &[u8]) -> Result<Answer, PageError> {
    let tree = tree_from_json(&String::from_utf8_lossy(request))?;
    Ok(Answer::of(serde_json::to_string(&newick(&tree))?))
}

/// The sections of a page on a tree, from its `tree.json`.
///
/// # Errors
/// The request is not a `tree.json`.
pub fn told(request: &[u8]) -> Result<Answer, PageError> {
    let tree = tree_from_json(&String::from_utf8_lossy(request))?;
    Ok(Answer::of(serde_json::to_string(&OfTree::new(&tree, &founder_rows(&tree)))?))
}

#[cfg(test)]
mod tests {
    use std::cell::Cell as Counter;

    use serde_json::{Value, json};

    use super::*;
    use furrow_cell::Cell;
    use furrow_formats::tree_from_json;

    fn head(cell: &Cell, cue: Option<&str>) -> Vec<u8> {
        let mut request = json!(TreeSettings { cell: cell.clone(), ..TreeSettings::default() });
        request["lineage"] = json!(Lineage::c_elegans().unwrap());
        request["cue"] = json!(cue);
        request.to_string().into_bytes()
    }

    /// A request built from a tree's own `tree.json` gives that tree again.
    #[test]
    fn a_tree_regrown_from_its_own_head_is_the_same() {
        let counted = Counter::new(0);
        let first =
            regrow(&head(&Cell::gao2026_thresholds(3.0), Some("none")), &|solved, _| counted.set(solved)).unwrap();
        assert!(counted.get() > 3);
        let tree = tree_from_json(&first.text).unwrap();
        assert!(tree.len() > 10);
        let mut document: Value = serde_json::from_str(&first.text).unwrap();
        document.as_object_mut().unwrap().remove("cells");
        let again = regrow(document.to_string().as_bytes(), &|_, _| {}).unwrap();
        assert_eq!(again.text, first.text);
        let written: String = serde_json::from_str(&as_newick(first.text.as_bytes()).unwrap().text).unwrap();
        assert_eq!(written, newick(&tree));
        let sections: Value = serde_json::from_str(&told(first.text.as_bytes()).unwrap().text).unwrap();
        let cells = format!("<p>{} cells from one of R0 = 3 ", tree.len());
        assert!(sections["summary"].as_str().unwrap().starts_with(&cells), "{sections}");
        for heading in ["Rounds of division per founder", "Cells over time", "Generations", "Parameters"] {
            assert!(sections["below"].as_str().unwrap().contains(&format!("<h2>{heading}</h2>")), "{heading}");
        }
    }

    #[test]
    fn an_unknown_cue_is_refused_with_the_allowed_ones() {
        let error = regrow(&head(&Cell::gao2026_thresholds(3.0), Some("germlin")), &|_, _| {}).unwrap_err();
        assert!(error.to_string().contains("germline"), "{error}");
    }
}
