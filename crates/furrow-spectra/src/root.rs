//! Roots of a test function between the last two points of a branch.

use furrow_bvp::{
    BoundaryValueProblem, Bracket, Continuation, Direction, LinearCondition, Solution, System, mesh, metric,
};

/// A root and the result of the test there.
pub(crate) struct Root<T> {
    pub solution: Solution,
    pub arclength: f64,
    pub found: T,
    /// The value of the test and its slope in the parameter.
    value: f64,
    slope: f64,
    tangent: Direction,
}

/// Most points that are tried between the ends of a step.
const MOST_TRIALS: usize = 60;

/// A bracket is narrow enough at this fraction of a step.
const NARROW: f64 = 1e-13;

/// Differences of the test below this part of its values at the ends are of rounding.
const ROUNDING: f64 = 1e-9;

fn parameter(y: &Solution) -> f64 {
    y.scalars.last().copied().unwrap_or(f64::NAN)
}

/// The root of a test between the last two points of a branch, where it has `values` of different signs. Every point that is tried is
/// corrected onto the branch; where that fails, the error is `lost` of the parameters at both ends. None if there is one point alone.
pub(crate) fn between<P: BoundaryValueProblem, T, E>(
    branch: &mut Continuation<P>,
    values: [f64; 2],
    lost: impl FnOnce([f64; 2]) -> E,
    mut test: impl FnMut(&mut P, &Solution) -> Result<(f64, T), E>,
) -> Result<Option<Root<T>>, E> {
    let history = &branch.state.history;
    let (Some((from, first)), Some((to, newest))) = (history.back(1), history.back(0)) else { return Ok(None) };
    let ends = [first, newest].map(parameter);
    let (tangent, mut bracket) = (branch.state.tangent.clone(), Bracket::new([[from, values[0]], [to, values[1]]]));
    let mut before = [ends[0], values[0]];
    let (mut slope, mut root): (f64, Option<Root<T>>) = (f64::NAN, None);
    for _ in 0..MOST_TRIALS {
        let arclength = bracket.secant();
        let moved = root.as_ref().map_or(f64::INFINITY, |root| (arclength - root.arclength).abs());
        if !arclength.is_finite() || moved <= NARROW * (to - from).abs() {
            break;
        }
        let mut solution = branch.state.solution.clone();
        branch.state.history.extrapolate(arclength, &mut solution);
        if !branch.correct_across(&mut solution, &tangent) {
            return Err(lost(ends));
        }
        let (value, found) = test(&mut branch.problem, &solution)?;
        let now = [parameter(&solution), value];
        if (value - before[1]).abs() > ROUNDING * (values[1] - values[0]).abs() {
            slope = (value - before[1]) / (now[0] - before[0]);
        }
        before = now;
        root = Some(Root { solution, arclength, found, value, slope, tangent: tangent.clone() });
        if value == 0.0 {
            break;
        }
        bracket.keep([arclength, value]);
    }
    branch.problem.prepare(&branch.state.solution.scalars);
    root.map_or_else(|| Err(lost(ends)), |root| Ok(Some(root)))
}

impl<T> Root<T> {
    /// Estimates the error of the parameter by its change where the intervals are halved: the change of the point, and the change of the test
    /// divided by its slope. Infinite if the point is not found on the finer mesh.
    pub fn error<P: BoundaryValueProblem, E>(
        &self,
        branch: &mut Continuation<P>,
        test: impl FnOnce(&mut P, &Solution) -> Result<(f64, T), E>,
    ) -> f64 {
        let Continuation { problem, system, settings, metric, state, .. } = branch;
        let (y, finer) = (&self.solution, mesh::halved(&self.solution.mesh));
        let (mut refined, mut along) = (y.on_mesh(&system.gauss, &finer), self.tangent.clone());
        metric::transfer_direction(&system.gauss, &y.mesh, &finer, &mut along);
        let mut plane = LinearCondition::default();
        metric.plane_through(&refined, &along, &mut plane);
        let mut own = System::new(system.dimensions(), y.m);
        let solved = settings.newton.solve(&mut own, &mut Default::default(), problem, &mut refined, &[plane], false);
        let there = solved.ok().and_then(|_| test(problem, &refined).ok());
        problem.prepare(&state.solution.scalars);
        let error = there.map(|(value, _)| {
            let moved = parameter(&refined) - parameter(y);
            mesh::error_of_change(moved - (value - self.value) / self.slope, y.m)
        });
        error.filter(|error| !error.is_nan()).unwrap_or(f64::INFINITY)
    }
}
