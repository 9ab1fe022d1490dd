//! Cues on every field, compared with independent reference runs and their mirror images.

use crate::common::tables;
use furrow_cell::cue::Field;
use furrow_cell::cue::profile::NAMES;
use furrow_cell::{Cell, Cue, Numerics};
use furrow_mechanics::division::stepper::SOLVED_TO;
use furrow_mechanics::division::{Division, DivisionInput, divide};

/// The reference's spelling, `activity:band(A=0.05 u0=0.465 om=0.0577)`, as ours. Its gradients carry numbers that they do
/// not use.
fn cue(text: &str) -> Cue {
    let (name, numbers) = text.trim_end_matches(')').split_once('(').unwrap();
    let mut out = name.to_owned();
    for (key, value) in numbers.split(' ').map(|entry| entry.split_once('=').unwrap()) {
        match key {
            "A" => out += &format!(",amplitude={value}"),
            _ if name.ends_with("gradient") => {}
            "om" => out += &format!(",omega={value}"),
            key => out += &format!(",{key}={value}"),
        }
    }
    out.parse().unwrap()
}

fn solve(r0: f64, cue: &Cue, numerics: Numerics) -> Division {
    divide(&DivisionInput { numerics, ..DivisionInput::new(Cell::gao2026_thresholds(r0).with_cue(cue.clone())) })
        .unwrap()
}

#[test]
fn divisions_match_the_reference() {
    let rows = tables::reference("division_cue_fields.csv");
    assert!(rows.len() >= 7);
    for row in rows {
        let r0 = row.number("R0");
        let division = solve(r0, &cue(row.text("cue")), Numerics::default());
        let (chi, u) = (division.chi().unwrap(), division.u_furrow().unwrap());
        let [below, _] = division.shares().unwrap();
        println!("{row:?}: {chi:.5} {below:.5} {u:.5}");
        let allowed = if r0 == 5.4 { 0.02 } else { 0.01 };
        assert!((chi - row.number("chi")).abs() < allowed, "{chi} {row:?}");
        assert!((below - row.number("share_below")).abs() < allowed, "{below} {row:?}");
        assert!((u - row.number("u_furrow")).abs() < 0.005, "{u} {row:?}");
    }
}

/// Without noise every field with every profile divides a cell unequally that would divide equally without, and its mirror image
/// the other way round: by as many steps and to rounding, or where that decided on an iteration more or less, to what a step is
/// solved to. A new field or profile is covered as soon as it is in the lists.
#[test]
fn every_field_with_every_profile_mirrors() {
    let numerics = Numerics { noise: 0.0, ..Numerics::default() };
    assert!(solve(3.0, &Cue::none(), numerics).chi().unwrap() < 1e-6);
    for (field, profile) in Field::ALL.into_iter().flat_map(|field| NAMES.map(|profile| (field, profile))) {
        let place = if ["gradient", "par", "par_band"].contains(&profile) { "" } else { "u0=0.42,omega=0.1," };
        let cue: Cue = format!("{}:{profile},{place}amplitude=0.1", field.name()).parse().unwrap();
        let [a, b] = [&cue, &cue.mirrored()].map(|cue| solve(3.0, cue, numerics));
        assert!(a.chi().unwrap() > 1e-3, "{cue} does nothing: {a:?}");
        assert_eq!((a.outcome(), a.work.steps, a.work.rejected), (b.outcome(), b.work.steps, b.work.rejected), "{cue}");
        let sum = |of: fn(&Division) -> Option<f64>| of(&a).unwrap() + of(&b).unwrap();
        let deviation = [sum(|d| d.chi_signed()), sum(|d| d.u_furrow()) - 1.0, a.t_end / b.t_end - 1.0];
        let limit = if a.work.iterations == b.work.iterations { 1e-9 } else { SOLVED_TO };
        assert!(deviation.iter().all(|found| found.abs() < limit), "{cue}: {deviation:?}");
    }
}

/// A cue of a twelfth of a usual interval's width is resolved: a mesh four times as fine and steps half as long change χ by
/// less than a hundredth of itself.
#[test]
fn narrow_cues_are_seen_by_the_mesh() {
    let cue: Cue = "activity:band,u0=0.42,omega=0.004,amplitude=0.4".parse().unwrap();
    let coarse = DivisionInput::new(Cell::gao2026_thresholds(3.0).with_cue(cue));
    let numerics = Numerics { intervals: 192, step_factor: 0.5, ..Numerics::default() };
    let fine = DivisionInput { numerics, ..coarse.clone() };
    let [a, b] = [coarse, fine].map(|input| divide(&input).unwrap().chi_signed().unwrap());
    println!("{a} {b}");
    assert!((a - b).abs() < 2e-4 && a.abs() > 0.015, "{a} {b}");
}
