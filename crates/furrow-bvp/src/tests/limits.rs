//! Sizes at and beyond the limits of the kernels.

use super::Random;
use super::linear::{Case, dims};
use crate::{Direction, FactorisationError, InvalidInput, MAX_CONDITIONS, MAX_UNKNOWNS, System, TooLarge};

#[test]
fn every_limit_is_refused_by_name() {
    let cases = [
        (dims(2, 0, 0, 1, 1, 0), 0, TooLarge::Stages { stages: 0 }),
        (dims(2, 0, 0, 1, 1, 0), 6, TooLarge::Stages { stages: 6 }),
        (dims(0, 0, 1, 1, 0, 0), 3, TooLarge::Components { components: 0, quadratures: 0 }),
        (dims(2, 3, 0, 1, 1, 0), 3, TooLarge::Components { components: 2, quadratures: 3 }),
        (dims(MAX_UNKNOWNS, 30, 1, 16, 17, 0), 3, TooLarge::Unknowns { unknowns: 33 }),
        (dims(13, 0, 0, 6, 7, 0), 5, TooLarge::StageUnknowns { stage_unknowns: 65 }),
        (dims(17, 0, 0, 9, 8, 0), 4, TooLarge::StageUnknowns { stage_unknowns: 68 }),
        (dims(2, 0, 0, 2, 1, 0), 3, TooLarge::Conditions { missing: -1 }),
        (dims(2, 0, MAX_CONDITIONS + 1, 1, 1, 0), 3, TooLarge::Conditions { missing: 9 }),
    ];
    for (dims, stages, error) in cases {
        assert_eq!(dims.check(stages), Err(error));
        assert!(!error.to_string().is_empty());
    }
}

#[test]
fn a_workspace_for_what_does_not_fit_refuses_every_use() {
    let mut system = System::new(dims(17, 0, 0, 9, 8, 0), 4);
    let missing = |step| Err(InvalidInput::NotReady { step });
    assert_eq!(system.condense(), missing("evaluated with derivatives").map_err(FactorisationError::from));
    assert_eq!(system.factor_blocks(&[]), missing("condensed").map_err(FactorisationError::from));
    assert_eq!(system.null_direction(0, &mut Direction::default()), missing("factorised"));
}

#[test]
fn sizes_at_the_limits_are_solved() {
    // Random systems this large are ill-conditioned: the test shows that no kernel runs out of room.
    let largest = [
        (dims(MAX_UNKNOWNS, 24, 0, 16, 16, 0), 5),
        (dims(MAX_UNKNOWNS, 24, 0, 32, 0, 0), 1),
        (dims(MAX_UNKNOWNS, 20, 0, 0, 32, 0), 4),
        (dims(16, 6, 16, 16, 4, 12), 4),
        (dims(31, 25, 1, 0, 1, 31), 5),
        (dims(11, 0, 5, 6, 10, 0), 5),
        (dims(1, 0, 31, 32, 0, 0), 5),
        (dims(2, 0, MAX_CONDITIONS, 1, 1, 0), 5),
    ];
    for (dims, stages) in largest {
        dims.check(stages).unwrap();
        let mut case = Case::new(dims, stages, 2, &mut Random(3));
        let mut out = Direction::default();
        case.system.solve_own(&mut out).unwrap();
        assert!(out.nodes.iter().chain(&out.stages).chain(&out.scalars).all(|v| v.is_finite()), "{dims:?}");
    }
}
