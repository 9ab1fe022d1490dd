//! The study of four laws.

#[allow(dead_code, reason = "the study prints tables and draws its picture too")]
#[path = "../../studies/laws/main.rs"]
mod study;

use furrow_mechanics::division::DivisionInput;
use study::{Row, Studied, strength};

/// The files have the strength that follows from the paper's threshold.
#[test]
fn strengths_follow_from_the_threshold_of_the_paper() {
    for law in [Studied::Ring, Studied::Thickness, Studied::Both] {
        let cell = law.cell(2.0, false).unwrap();
        let (own, found) = (cell.law.unwrap(), strength(law).unwrap());
        let (_, constant) = own.constants().find(|(name, _)| *name == "strength").unwrap();
        assert!((constant.value / found - 1.0).abs() < 1e-4, "{}: {} {found}", law.name(), constant.value);
    }
}

#[test]
fn laws_with_curvature_alone_divide_unequally_without_a_cue() {
    for law in Studied::ALL {
        let row = Row::compute(&DivisionInput::new(law.cell(2.0, false).unwrap())).unwrap();
        let unequal = matches!(law, Studied::Curvature | Studied::Both);
        assert!(
            row.divided && (row.chi > 0.8) == unequal && (row.chi < 1e-3) != unequal,
            "{}: {}",
            law.name(),
            row.chi
        );
    }
}

/// From R0 = 2.7 to 5.4 the carried ring takes 1.3 times as long, and its speed grows as much from the first share to the last.
#[test]
fn a_carried_ring_closes_in_a_time_that_hardly_depends_on_size() {
    let at = |r0: f64| Row::compute(&DivisionInput::new(Studied::Ring.cell(r0, true).unwrap())).unwrap();
    let (small, zygote) = (at(2.7), at(5.4));
    assert!((zygote.closing() / small.closing() - 1.3).abs() < 0.1, "{} {}", small.closing(), zygote.closing());
    let speeds = zygote.speeds();
    assert!((speeds[3] / speeds[0] - 1.31).abs() < 0.03, "{speeds:?}");
    assert!((zygote.chi - 0.199).abs() < 0.001, "{}", zygote.chi);
}

#[test]
fn rows_are_kept_and_read() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("divisions.csv");
    let input = DivisionInput::new(Studied::Ring.cell(3.0, false).unwrap());
    let first = study::Kept::open(&file).unwrap().row(&input).unwrap();
    let mut kept = study::Kept::open(&file).unwrap();
    assert_eq!(kept.row(&input).unwrap(), first);
    std::fs::write(&file, "abc,1,x\n").unwrap();
    let error = study::Kept::open(&file).err().unwrap().to_string();
    assert!(error.contains(":1: abc,1,x: must be a key"), "{error}");
}
