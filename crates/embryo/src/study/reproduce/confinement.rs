//! Figure 2G: confinement without a cue.

use super::lab::{Finding, Found, Lab, LabError, Shown};
use super::paper::Statement;
use super::series::{all_equal, between, readings, unequal_stretches};
use crate::division::{DivisionInput, Outcome};

/// The sweep that ships.
const CONFINEMENT: &str = include_str!("../../../../../studies/confinement.ron");

/// χ over ε, and where division ends.
pub fn over_epsilon(lab: &Lab<'_>, _: &[Statement]) -> Result<Found, LabError> {
    let mut found = Found::default();
    let (sweep, rows) = lab.sweep(CONFINEMENT, "confinement.ron", &mut found)?;
    let all = readings(&sweep, &rows, "epsilon", &[]);
    let loose = between(&all, [0.54, 0.86]);
    found.say(Finding::words("confinement_halves", all_equal(&loose), unequal_stretches(&loose)));
    let chi: Option<Vec<f64>> = between(&all, [0.87, 0.89]).iter().map(|reading| reading.chi).collect();
    found.say(match chi.as_deref() {
        Some(chi @ [first, .., last]) => {
            let rises = chi.windows(2).all(|pair| pair[1] > pair[0]);
            let text = format!("χ = {first:.2} at ε = 0.87, {last:.2} at 0.89");
            Finding::words("confinement_unequal", rises && *first > 0.5, text)
        }
        _ => Finding::words("confinement_unequal", false, "not all divide".to_owned()),
    });
    let edge = edge(lab, &mut found)?;
    found.say(match edge {
        Some(epsilon) => Finding::number("confinement_edge", epsilon).noting(
            "found by bisection to 0.0001; just above it cells rest off the centre, up to the pitchfork's ε of figure 2H-L",
        ),
        None => Finding::not_computed("confinement_edge", "divisions do not end between ε = 0.88 and 0.91"),
    });
    found.show("2G", Shown::Sweep(Box::new(sweep), rows));
    Ok(found)
}

/// Halvings of the interval that the edge is looked for in.
const HALVINGS: usize = 8;

/// The volume fraction above which a cell of R0 = 2.22 comes to rest.
fn edge(lab: &Lab<'_>, found: &mut Found) -> Result<Option<f64>, LabError> {
    let mut rests = |epsilons: Vec<f64>| -> Result<Vec<Option<bool>>, LabError> {
        let input =
            |epsilon: f64| DivisionInput { numerics: lab.numerics(), ..DivisionInput::new(lab.cell(2.22, epsilon)) };
        let divisions = lab.divisions(epsilons.into_iter().map(input).collect(), found)?;
        Ok(divisions.iter().map(|division| Some(division.as_ref()?.outcome == Outcome::Failed)).collect())
    };
    let [mut low, mut high] = [0.88, 0.91];
    if rests(vec![low, high])? != [Some(false), Some(true)] {
        return Ok(None);
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        match rests(vec![middle])?[..] {
            [Some(true)] => high = middle,
            [Some(false)] => low = middle,
            _ => return Ok(None),
        }
    }
    Ok(Some(0.5 * (low + high)))
}
