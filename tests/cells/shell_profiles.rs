//! Shells of any profile: the ellipse as a table is the built-in shell, and an egg has its own divisions.

use furrow_cell::{Cell, Cue, Numerics, Parameter, ShellProfile};
use furrow_mechanics::division::{Division, DivisionInput, divide};
use furrow_mechanics::equilibria::BranchOptions;
use furrow_mechanics::equilibria::pitchfork;

/// r = b sin θ √(1 + kx), z = a x with x = cos θ, by a table of `rows` places.
fn profile(rows: usize, aspect: f64, k: f64) -> ShellProfile {
    let place = |i: usize| {
        let (sin, cos) = (i as f64 * std::f64::consts::PI / (rows - 1) as f64).sin_cos();
        let r = if i == 0 || i + 1 == rows { 0.0 } else { sin * (1.0 + k * cos).sqrt() };
        format!("{},{r}\n", aspect * cos)
    };
    let text = format!("z,r\n{}", (0..rows).map(place).collect::<String>());
    ShellProfile::from_table(text.as_bytes(), "table", "table.csv").unwrap()
}

fn divided(cell: Cell) -> Division {
    divide(&DivisionInput::new(cell)).unwrap()
}

/// Thirteen rows give the ellipse to rounding: its division, its pitchfork and the normal form.
#[test]
fn an_ellipse_by_its_table_is_the_built_in_shell() {
    for cell in [Cell::new(4.0).with_cue(Cue::published()), Cell::new(2.5)] {
        let table = profile(13, cell.shell.aspect, 0.0);
        let [built_in, by_table] = [cell.clone(), cell.with_shell_profile(table)].map(divided);
        let (a, b) = (built_in.chi_signed().unwrap(), by_table.chi_signed().unwrap());
        assert!((a - b).abs() < 1e-9, "{a} {b}");
        assert!((built_in.t_end / by_table.t_end - 1.0).abs() < 1e-9);
    }
    let (cell, numerics) = (Cell::new(2.0), Numerics::default());
    let table = cell.clone().with_shell_profile(profile(13, cell.shell.aspect, 0.0));
    let [built_in, by_table] =
        [cell, table].map(|cell| pitchfork::first(&cell, &numerics, &BranchOptions::default()).unwrap());
    assert!((built_in.point.xi_s / by_table.point.xi_s - 1.0).abs() < 1e-10);
    assert!((built_in.coefficient / by_table.coefficient - 1.0).abs() < 1e-7);
}

/// Rows are added until χ stays: χ of 12, 24 and 48 intervals.
#[test]
fn an_egg_shifts_the_division_and_converges_with_its_rows() {
    let chi =
        |rows: usize, k: f64| divided(Cell::new(4.0).with_shell_profile(profile(rows, 1.505, k))).chi_signed().unwrap();
    let [coarse, middle, fine] = [13, 25, 49].map(|rows| chi(rows, 0.2));
    assert!((fine + 0.411291).abs() < 1e-5, "{fine}");
    assert!((coarse - fine).abs() < 2e-3 && (middle - fine).abs() < 1e-6, "{coarse} {middle} {fine}");
    // The larger daughter has the blunt half, whichever pole it is at.
    assert!((chi(49, -0.2) + fine).abs() < 1e-3);
}

#[test]
fn without_the_axis_an_egg_divides_alike() {
    let cell = Cell::new(4.0).with_shell_profile(profile(49, 1.505, 0.2));
    let numerics = Numerics { modes: 2, ..Numerics::default() };
    let surface =
        furrow_surface::division::divide(&DivisionInput { cell: cell.clone(), numerics, seed: 1 }, &mut |_, _| ())
            .unwrap();
    let (with, without) = (divided(cell).chi_signed().unwrap(), surface.division.chi_signed().unwrap());
    assert!((with - without).abs() < 3e-3, "{with} {without}");
}

#[test]
fn a_profile_keeps_the_meaning_of_every_parameter_of_the_shell() {
    let mut cell = Cell::new(2.0).with_shell_profile(profile(49, 1.4, 0.2));
    let aspect = Parameter::Aspect.get(&cell);
    assert!((aspect - 1.4).abs() < 0.1, "{aspect}");
    // Stretching a profile along the axis equals reading a stretched table.
    Parameter::Aspect.set(&mut cell, 1.5 * aspect);
    let stretched = Cell::new(2.0).with_shell_profile(profile(49, 1.5 * 1.4, 0.2));
    assert!((Parameter::Aspect.get(&stretched) - 1.5 * aspect).abs() < 1e-6);
    let series = |cell: &Cell| cell.shell_profile.as_ref().unwrap().factor().series().to_vec();
    for (a, b) in series(&cell).iter().zip(series(&stretched)) {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
}
