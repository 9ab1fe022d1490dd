//! Divisions of cells of all sorts: each ends, and χ that the mesh decides is found by the refined division.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

use furrow_cell::cue::Field;
use furrow_cell::{Cell, Cue};
use furrow_mechanics::division::{Division, DivisionError, DivisionInput, divide};
use furrow_verification::states::Draws;

/// One of several.
fn one_of<'a>(draws: &mut Draws, of: &[&'a str]) -> &'a str {
    of[draws.between(0.0, of.len() as f64) as usize]
}

/// Any profile, with an amplitude for the field or the source.
fn profile(draws: &mut Draws) -> String {
    let (u0, omega, amplitude) = (draws.between(0.1, 0.9), draws.between(0.03, 0.4), draws.between(-0.8, 0.8));
    let unit = one_of(draws, &["", "Lh"]);
    match one_of(draws, &["gradient", "band", "step", "step down"]) {
        "gradient" => format!("gradient,amplitude={amplitude:.4}"),
        "step down" => format!("step,u0={u0:.4},omega=-{omega:.4}{unit},amplitude={amplitude:.4}"),
        name => format!("{name},u0={u0:.4},omega={omega:.4}{unit},amplitude={amplitude:.4}"),
    }
}

/// No cue, any field with any profile, or a regulator, half of them without turnover.
fn cue(draws: &mut Draws) -> String {
    let field = one_of(draws, &Field::ALL.map(Field::name));
    match draws.between(0.0, 10.0) as usize {
        0 => "none".to_owned(),
        1..8 => format!("{field}:{}", profile(draws)),
        kind => {
            let source = if draws.between(0.0, 1.0) < 0.5 { "none".to_owned() } else { profile(draws) };
            let turnover = if kind == 8 { 0.0 } else { draws.between(0.0, 20.0) };
            let (diffusion, strength) = (draws.between(0.1, 8.0), draws.between(-0.4, 0.4));
            let diluted = one_of(draws, &["true", "false"]);
            format!(
                "regulator:{source},turnover={turnover:.4},diffusion={diffusion:.4},diluted={diluted},{field}={strength:.4}"
            )
        }
    }
}

/// The cell of a number: R0 .5–8, ε .4–.98, ξ_s 0–80.
fn cell(number: usize) -> Cell {
    let mut draws = Draws(number as u64);
    // The first numbers of neighbouring seeds are alike.
    for _ in 0..8 {
        draws.between(0.0, 1.0);
    }
    loop {
        let [r0, epsilon, xi_s] = [[0.5, 8.0], [0.4, 0.98], [0.0, 80.0]].map(|[low, high]| draws.between(low, high));
        // A coefficient that the cue brings below zero is refused.
        if let Ok(cue) = cue(&mut draws).parse::<Cue>() {
            return Cell { epsilon, xi_s, ..Cell::new(r0) }.with_cue(cue);
        }
    }
}

/// Whether a division ended: divided, at rest, in a cycle, or where its regulator leaves no cortex.
fn ended(found: &Result<Division, DivisionError>) -> bool {
    use DivisionError::{Coefficient, Collapses, Oscillates};
    matches!(found, Ok(_) | Err(Coefficient { .. } | Collapses { .. } | Oscillates { .. }))
}

/// What became of the cells with these numbers, by kind; prints each that is out of the ordinary.
fn outcomes(numbers: std::ops::Range<usize>) -> BTreeMap<&'static str, usize> {
    let next = AtomicUsize::new(numbers.start);
    let solve = || {
        let mut kinds = Vec::new();
        while let Some(number) = Some(next.fetch_add(1, Ordering::Relaxed)).filter(|number| numbers.contains(number)) {
            let input = DivisionInput::new(cell(number));
            let finer = input.refined().unwrap();
            let [one, two] = [&input, &finer].map(divide);
            let kind = match (&one, &two) {
                (one, two) if !ended(one) || !ended(two) => "no outcome",
                (Ok(one), Ok(two)) if one.depends_on_numerics(two, input.cell.is_mirror_symmetric()) => {
                    "the numerics decide"
                }
                (Ok(_), Ok(_)) => "an outcome",
                _ => "a cycle, or no cortex is left",
            };
            let Cell { r0, epsilon, xi_s, cue, .. } = &input.cell;
            if kind != "an outcome" {
                let said = [one, two].map(|found| match found {
                    Ok(division) => format!("{} {:?} {}", division.outcome(), division.chi_signed(), division.t_end),
                    Err(error) => error.to_string(),
                });
                println!("{number}: {kind}: --r0 {r0} --epsilon {epsilon} --xi {xi_s} --cue {cue}: {said:?}");
            }
            kinds.push(kind);
        }
        kinds
    };
    let kinds = std::thread::scope(|scope| {
        let threads = [scope.spawn(solve), scope.spawn(solve)];
        threads.into_iter().flat_map(|thread| thread.join().unwrap()).collect::<Vec<_>>()
    });
    let mut counts = BTreeMap::new();
    kinds.into_iter().for_each(|kind| *counts.entry(kind).or_default() += 1);
    println!("{counts:?}");
    counts
}

#[test]
fn every_random_cell_has_an_outcome() {
    let counts = outcomes(0..24);
    assert!(!counts.contains_key("no outcome") && counts["an outcome"] > 20, "{counts:?}");
}

/// The slow modes of its regulator decay at nearly the same rate.
#[test]
fn a_cell_with_a_regulator_of_close_modes_comes_to_rest() {
    assert_eq!(outcomes(808..809), BTreeMap::from([("an outcome", 1)]));
}

#[test]
#[ignore = "takes minutes of every core"]
fn every_of_many_random_cells_has_an_outcome() {
    let counts = outcomes(0..1500);
    assert!(!counts.contains_key("no outcome") && counts["an outcome"] > 1450, "{counts:?}");
}
