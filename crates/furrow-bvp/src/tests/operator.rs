//! Solution operators against solves with the same forces and readings.

use super::linear::{Case, dims, for_every_shape};
use super::problems::factored;
use super::{Random, distance, largest};
use crate::{AntisymmetricEnd, BoundaryValueProblem, Dimensions, Direction, InvalidInput, SolutionOperator};

/// Random forces and readings of a case, and the vector to apply its operator to.
struct Restricted {
    /// Forces and readings of every point.
    per_point: [usize; 2],
    force: Vec<f64>,
    reading: Vec<f64>,
    from: Vec<f64>,
}

impl Restricted {
    fn new(case: &Case, per_point: [usize; 2], random: &mut Random) -> Restricted {
        let (points, dims) = (case.y.intervals() * case.y.m, case.problem.dims);
        let own = dims.components - dims.all_quadratures();
        let [forces, readings] = per_point;
        let [force, reading, from] = [own * forces, dims.components * readings, forces];
        let mut of = |size: usize| random.vector(points * size);
        Restricted { per_point, force: of(force), reading: of(reading), from: of(from) }
    }

    /// By a solve with all unknowns: the readings, and the scalars.
    fn solved(&self, case: &mut Case, end: Option<&AntisymmetricEnd>) -> (Vec<f64>, Vec<f64>) {
        let dims = case.problem.dims;
        let (n, own) = (dims.components, dims.components - dims.all_quadratures());
        let [forces, readings] = self.per_point;
        let mut residual = case.system.zero_residual();
        for (point, rows) in residual.stages.chunks_exact_mut(n).enumerate() {
            for (row, to) in rows[dims.quadratures..][..own].iter_mut().enumerate() {
                let force = &self.force[(point * own + row) * forces..][..forces];
                *to = force.iter().zip(&self.from[point * forces..]).map(|(f, w)| f * w).sum();
            }
        }
        let mut update = Direction::default();
        match end {
            None => case.system.solve(&residual, &mut update).unwrap(),
            Some(end) => {
                residual.right = vec![0.0; n - dims.left];
                case.system.solve_antisymmetric(end, &residual, &mut update).unwrap();
            }
        }
        let rows = self.reading.chunks_exact(n).enumerate();
        let read = rows.map(|(o, row)| row.iter().zip(&update.stages[o / readings * n..]).map(|(c, y)| c * y).sum());
        (read.collect(), update.scalars)
    }

    /// The same by the operator.
    fn applied(&self, case: &mut Case, end: Option<&AntisymmetricEnd>) -> Result<(Vec<f64>, Vec<f64>), InvalidInput> {
        let mut operator = SolutionOperator::default();
        operator.assemble(&case.system, self.per_point, &self.force, &self.reading)?;
        let mut read = vec![f64::NAN; self.from.len() / self.per_point[0] * self.per_point[1]];
        let mut scalars = vec![f64::NAN; case.problem.dims.scalars];
        operator.apply(&mut case.system, end, &self.from, &mut read, &mut scalars)?;
        Ok((read, scalars))
    }
}

#[test]
fn operators_give_what_solves_give() {
    for_every_shape(|mut case, random| {
        let restricted = Restricted::new(&case, [2, 3], random);
        let (read, scalars) = restricted.solved(&mut case, None);
        let (applied, same) = restricted.applied(&mut case, None).unwrap();
        let allowed = case.dense.tolerance() * largest(&read).max(largest(&scalars)).max(1.0);
        assert!(
            distance(&read, &applied) <= allowed && distance(&scalars, &same) <= allowed,
            "{:?}",
            case.problem.dims
        );
    });
}

#[test]
fn operators_of_antisymmetric_problems_give_what_their_solves_give() {
    let mut compared = 0;
    for_every_shape(|mut case, random| {
        let dims = case.problem.dims;
        let vanishing: Vec<usize> = (0..dims.components.saturating_sub(dims.left)).collect();
        let mut end = AntisymmetricEnd::default();
        // Too many left conditions leave no square system, and some of these ends are singular.
        if case.system.factor_antisymmetric(&vanishing, &mut end).is_ok_and(|det| det.sign != 0.0) {
            let restricted = Restricted::new(&case, [2, 3], random);
            let (read, _) = restricted.solved(&mut case, Some(&end));
            let (applied, scalars) = restricted.applied(&mut case, Some(&end)).unwrap();
            let allowed = 100.0 * case.dense.tolerance() * largest(&read).max(1.0);
            assert!(distance(&read, &applied) <= allowed, "{dims:?}: {}", distance(&read, &applied));
            assert!(scalars.iter().all(|p| *p == 0.0));
            compared += 1;
        }
    });
    assert!(compared > 50, "{compared}");
}

#[test]
fn sized_kernels_give_the_bits_of_the_general_ones() {
    let regulated = Dimensions { trailing_quadratures: 1, ..dims(9, 3, 2, 5, 5, 1) };
    for dims in [dims(7, 3, 3, 4, 4, 1), regulated] {
        let mut case = Case::new(dims, 4, 3, &mut Random(47));
        assert!(case.problem.kernels(4).matching(dims, 4).is_sized());
        let restricted = Restricted::new(&case, [1, 1], &mut Random(53));
        let sized = restricted.applied(&mut case, None).unwrap();
        case.problem.sized = false;
        case.system = factored(&mut case.problem, &case.y, &case.conditions);
        assert_eq!(sized, restricted.applied(&mut case, None).unwrap());
    }
}

#[test]
fn sizes_that_do_not_fit_are_named() {
    let mut case = Case::new(dims(4, 2, 2, 2, 2, 1), 3, 2, &mut Random(59));
    let fitting = || Restricted::new(&case, [2, 3], &mut Random(61));
    let misfits = [
        ("coefficients of forces", 24, Restricted { force: vec![1.0; 3], ..fitting() }),
        ("coefficients of readings", 72, Restricted { reading: vec![1.0; 3], ..fitting() }),
        ("forces", 12, Restricted { from: vec![1.0; 3], ..fitting() }),
    ];
    for (name, expected, misfit) in misfits {
        let refused = InvalidInput::Length { name, length: 3, expected };
        assert_eq!(misfit.applied(&mut case, None), Err(refused));
    }
    // Of a system that has another mesh since.
    let mut finer = Case::new(case.problem.dims, 3, 4, &mut Random(67));
    let (mut operator, others) = (SolutionOperator::default(), Restricted::new(&finer, [1, 1], &mut Random(71)));
    let fewer = Restricted::new(&case, [1, 1], &mut Random(73));
    operator.assemble(&case.system, [1, 1], &fewer.force, &fewer.reading).unwrap();
    let (mut read, mut scalars) = (others.from.clone(), vec![0.0; case.problem.dims.scalars]);
    let applied = operator.apply(&mut finer.system, None, &others.from, &mut read, &mut scalars);
    assert_eq!(applied, Err(InvalidInput::NotReady { step: "assembled into the operator" }));
}
