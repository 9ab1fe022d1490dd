//! The same problem with kernels for its sizes and with general ones, and with quadratures eliminated or not.

use super::dense::unknowns_of_direction;
use super::linear::{Case, SHAPES, dims, random_residual};
use super::problems::factored;
use super::{Random, distance, largest};
use crate::{BoundaryValueProblem, Dimensions, Direction, Kernels};

/// Sizes that [`Quadratic`](super::problems::Quadratic) has kernels for: 7 components with 3 quadratures, or 9 with the first 3 and the
/// last as quadratures; 3 or 4 stages; 1 or 2 lanes of columns.
fn unrolled() -> impl Iterator<Item = (Dimensions, usize)> {
    let cell = dims(7, 3, 2, 4, 4, 1);
    let regulated = Dimensions { trailing_quadratures: 1, ..dims(9, 3, 2, 5, 5, 1) };
    let of = |dims, sizes: &'static [(usize, usize)]| {
        sizes.iter().map(move |&(m, scalars)| (Dimensions { scalars, ..dims }, m))
    };
    of(cell, &[(3, 2), (4, 2), (4, 3), (4, 5)]).chain(of(regulated, &[(3, 2), (4, 2), (4, 5)]))
}

#[test]
fn sized_kernels_give_the_bits_of_the_general_ones() {
    for (dims, m) in unrolled() {
        let mut case = Case::new(dims, m, 3, &mut Random(41 + m as u64));
        assert!(case.problem.kernels(m).matching(dims, m).is_sized());
        let r = random_residual(&case.system.residual, &mut Random(43));
        let (mut sized, mut general) = (Direction::default(), Direction::default());
        case.system.solve(&r, &mut sized).unwrap();
        case.problem.sized = false;
        let mut system = factored(&mut case.problem, &case.y, &case.conditions);
        system.solve(&r, &mut general).unwrap();
        assert_eq!((&system.residual, general), (&case.system.residual, sized));
        assert_eq!(system.determinant(), case.system.determinant());
    }
}

#[test]
fn kernels_for_other_sizes_are_not_used() {
    let kernels = Kernels::sized::<7, 3, 0, 4, 4, 3, 1>();
    let sized = |dims: Dimensions, m: usize| kernels.matching(dims, m).is_sized();
    assert_eq!(unrolled().filter(|(dims, m)| sized(*dims, *m)).count(), 1);
    assert!(!SHAPES.into_iter().filter(|d| (d.components, d.scalars) != (7, 3)).any(|dims| sized(dims, 4)));
}

#[test]
fn kernels_for_few_components_give_the_bits_of_the_general_ones() {
    let few = [
        dims(1, 0, 0, 1, 0, 0),
        dims(2, 0, 1, 0, 3, 0),
        dims(2, 1, 1, 0, 2, 1),
        dims(3, 0, 0, 2, 1, 0),
        dims(4, 0, 2, 3, 3, 0),
        dims(4, 1, 3, 2, 1, 3),
        dims(6, 0, 0, 3, 3, 0),
        dims(6, 1, 1, 3, 3, 1),
    ];
    for dims in few {
        assert!(
            Kernels::general().matching(dims, 4).has_known_sizes()
                && !Kernels::general().matching(dims, 3).has_known_sizes()
        );
        let mut random = Random(47);
        let mut case = Case::new(dims, 4, 3, &mut random);
        let r = random_residual(&case.system.residual, &mut random);
        let (mut known, mut general) = (Direction::default(), Direction::default());
        case.system.solve(&r, &mut known).unwrap();
        let determinant = case.system.determinant();
        case.system.kernels = Kernels::general();
        case.system.condense().unwrap();
        case.system.factor_blocks(&case.conditions).unwrap();
        case.system.solve(&r, &mut general).unwrap();
        assert_eq!((known, determinant), (general, case.system.determinant()), "{dims:?}");
    }
}

#[test]
fn eliminating_quadratures_changes_no_solution() {
    for dims in SHAPES.into_iter().filter(|d| d.all_quadratures() > 0) {
        for m in 1..=5 {
            let mut random = Random(29 + m as u64);
            let mut case = Case::new(dims, m, 3, &mut random);
            let r = random_residual(&case.system.residual, &mut random);
            let (mut eliminated, mut plain) = (Direction::default(), Direction::default());
            case.system.solve(&r, &mut eliminated).unwrap();
            let leading = (0..dims.quadratures).map(|fewer| (fewer, dims.trailing_quadratures));
            let trailing = (0..dims.trailing_quadratures).map(|fewer| (dims.quadratures, fewer));
            for fewer in leading.chain(trailing) {
                (case.problem.dims.quadratures, case.problem.dims.trailing_quadratures) = fewer;
                let mut system = factored(&mut case.problem, &case.y, &case.conditions);
                assert_eq!(system.residual, case.system.residual);
                system.solve(&r, &mut plain).unwrap();
                let (a, b) = (unknowns_of_direction(&eliminated), unknowns_of_direction(&plain));
                assert!(distance(&a, &b) <= case.dense.tolerance() * largest(&a), "{dims:?} m={m} {fewer:?}");
                case.assert_determinant(&case.dense, system.determinant());
            }
        }
    }
}
