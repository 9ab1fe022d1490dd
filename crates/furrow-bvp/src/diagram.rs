//! Bifurcation diagrams: a branch, the branches that cross it, those that cross these, and so on.
//!
//! Every branch point has four arms, two along each branch through it. A branch that comes to a branch point which is known already
//! arrives by one arm and leaves by the other; it ends there if another branch has left by that arm. Unused arms wait in a queue, and no
//! branch is followed twice.

use std::collections::VecDeque;
use std::io::{self, Write};

use serde::{Deserialize, Serialize};

use crate::bifurcation::{BranchPoint, BranchPointKind, locate};
use crate::continuation::{Continuation, ContinuationError, ContinuationSettings, State, Termination, distances};
use crate::direction::Direction;
use crate::metric::Metric;
use crate::problem::Directional;
use crate::solution::Solution;

/// How far a diagram goes.
#[derive(Clone, Debug, PartialEq)]
pub struct DiagramSettings {
    /// Every branch.
    pub continuation: ContinuationSettings,
    /// Values of λ in which branches are followed.
    pub range: [f64; 2],
    /// Most points of each branch.
    pub points: usize,
    /// How often branches are switched on the way from the first branch to a last one; 0 for the first branch alone.
    pub depth: usize,
    /// Most branches.
    pub branches: usize,
    /// Branch points nearer to each other than this, in the metric, are the same.
    pub separation: f64,
}

impl Default for DiagramSettings {
    fn default() -> Self {
        DiagramSettings {
            continuation: ContinuationSettings::default(),
            range: [f64::NEG_INFINITY, f64::INFINITY],
            points: 200,
            depth: 2,
            branches: 50,
            separation: 1e-4,
        }
    }
}

/// A kind of special point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SpecialKind {
    /// λ turns.
    Fold,
    /// Branches cross, and λ changes along both.
    Transcritical,
    /// Branches cross, and one of them exists for larger λ alone.
    SupercriticalPitchfork,
    /// Branches cross, and one of them exists for smaller λ alone.
    SubcriticalPitchfork,
}

impl From<BranchPointKind> for SpecialKind {
    fn from(kind: BranchPointKind) -> Self {
        match kind {
            BranchPointKind::Transcritical => SpecialKind::Transcritical,
            BranchPointKind::SupercriticalPitchfork => SpecialKind::SupercriticalPitchfork,
            BranchPointKind::SubcriticalPitchfork => SpecialKind::SubcriticalPitchfork,
        }
    }
}

/// A fold or a branch point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpecialPoint {
    /// Its kind.
    pub kind: SpecialKind,
    /// λ there.
    pub parameter: f64,
    /// Estimated error of λ.
    pub error: f64,
    /// The observed numbers of the solution.
    pub observed: Vec<f64>,
    /// The branch that it was found on.
    pub branch: usize,
    /// The solution.
    pub solution: Solution,
}

/// A point of a branch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DiagramPoint {
    /// λ.
    pub parameter: f64,
    /// Arclength from the start of the branch.
    pub arclength: f64,
    /// The observed numbers of the solution.
    pub observed: Vec<f64>,
}

/// Why a branch of a diagram ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum BranchEnd {
    /// At a bound of λ, at the largest number of points, or where solutions degenerate.
    Followed(Termination),
    /// At a special point, from where another branch has gone on.
    Joined(usize),
    /// At its own start: it is closed. A branch of cycles that returns with another phase is not recognised as closed.
    Closed,
    /// It was lost, for this reason.
    Lost(String),
}

/// A branch of a diagram.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DiagramBranch {
    /// The special point that it starts from. The first branch starts from no special point.
    pub from: Option<usize>,
    /// Switches from the first branch to it.
    pub depth: usize,
    /// Its points.
    pub points: Vec<DiagramPoint>,
    /// Why it ended.
    pub end: BranchEnd,
    /// Its last state: [`Continuation::resume`] goes on from it.
    pub state: State,
}

/// Branches with their special points.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Diagram {
    /// The first branch in both directions, then the others in the order in which they were followed.
    pub branches: Vec<DiagramBranch>,
    /// Folds and branch points, in the order in which they were found.
    pub special: Vec<SpecialPoint>,
}

impl Diagram {
    /// Writes a table with the columns branch, kind, λ, arclength and the observed numbers. The kind is empty for ordinary points.
    ///
    /// # Errors
    /// Errors of the writer.
    pub fn write_csv(&self, to: &mut impl Write, observed: &[&str]) -> io::Result<()> {
        let names: String = observed.iter().map(|name| format!(",{name}")).collect();
        writeln!(to, "branch,kind,parameter,arclength{names}")?;
        let columns = |values: &[f64]| values.iter().map(|value| format!(",{value}")).collect::<String>();
        for (k, branch) in self.branches.iter().enumerate() {
            for point in &branch.points {
                writeln!(to, "{k},,{},{}{}", point.parameter, point.arclength, columns(&point.observed))?;
            }
        }
        for point in &self.special {
            writeln!(to, "{},{:?},{},{}", point.branch, point.kind, point.parameter, columns(&point.observed))?;
        }
        Ok(())
    }
}

/// An arm of a branch point: direction, and whether a branch has used it.
struct Arm {
    direction: Direction,
    used: bool,
}

/// A branch point with its arms, on its own mesh.
struct Crossing {
    /// Among the special points.
    index: usize,
    solution: Solution,
    arms: Vec<Arm>,
}

/// A branch that is still to be followed.
struct Pending {
    from: Option<(usize, usize)>,
    depth: usize,
    state: State,
}

/// The diagram from the branch through a start, in both directions.
///
/// `observe` gives the numbers that are kept of every solution, one for every column of a table. Branches that cannot be followed to
/// their end are kept as far as they go, with the reason.
///
/// # Errors
/// [`ContinuationError`] if the start has no branch, or its input is refused.
///
/// # Examples
/// A rod u″ + λ sin u = 0, u(0) = u(1) = 0 buckles at λ = (kπ)². `Oscillator` is in `examples/problems/oscillator.rs`.
///
/// ```
/// # mod oscillator { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/problems/oscillator.rs")); }
/// # use oscillator::Oscillator;
/// use furrow_bvp::{ContinuationSettings, DiagramSettings, Metric, diagram};
/// let rod = Oscillator::elastica(0);
/// let start = rod.zero(1.0, 20, 4, 5.0);
/// let continuation = ContinuationSettings { max_step: 2.0, ..Default::default() };
/// let settings = DiagramSettings { continuation, range: [1.0, 60.0], depth: 1, ..Default::default() };
/// let found = diagram(&rod, start, &Metric::unit(2, 1), &settings, |y| vec![y.node(0)[1]])?;
/// // The straight rod to both sides, and the rod that is bent once or twice, to both sides.
/// assert_eq!((found.special.len(), found.branches.len()), (2, 6));
/// assert!((found.special[0].parameter - std::f64::consts::PI.powi(2)).abs() < 1e-8);
/// # Ok::<(), furrow_bvp::ContinuationError>(())
/// ```
pub fn diagram<P: Directional + Clone>(
    problem: &P,
    start: Solution,
    metric: &Metric,
    settings: &DiagramSettings,
    observe: impl FnMut(&Solution) -> Vec<f64>,
) -> Result<Diagram, ContinuationError> {
    let mut run = Run {
        problem,
        metric,
        settings,
        observe,
        crossings: Vec::new(),
        pending: VecDeque::new(),
        found: Diagram::default(),
    };
    for upwards in [true, false] {
        let first = Continuation::start(
            problem.clone(),
            start.clone(),
            metric.clone(),
            settings.continuation.clone(),
            upwards,
        )?;
        run.pending.push_back(Pending { from: None, depth: 0, state: first.state });
    }
    while run.found.branches.len() < settings.branches {
        let Some(next) = run.pending.pop_front() else { break };
        run.follow(next);
    }
    Ok(run.found)
}

struct Run<'a, P, O> {
    problem: &'a P,
    metric: &'a Metric,
    settings: &'a DiagramSettings,
    observe: O,
    crossings: Vec<Crossing>,
    pending: VecDeque<Pending>,
    found: Diagram,
}

impl<P: Directional + Clone, O: FnMut(&Solution) -> Vec<f64>> Run<'_, P, O> {
    fn resumed(&self, state: State) -> Continuation<P> {
        Continuation::resume(self.problem.clone(), state, self.metric.clone(), self.settings.continuation.clone())
    }

    /// Follows a branch unless another branch has already followed it.
    fn follow(&mut self, next: Pending) {
        if let Some((crossing, arm)) = next.from {
            let arm = &mut self.crossings[crossing].arms[arm];
            if std::mem::replace(&mut arm.used, true) {
                return;
            }
        }
        let start = next.state.solution.clone();
        let from = next.from.map(|(crossing, _)| self.crossings[crossing].index);
        let mut branch = self.resumed(next.state);
        let mut points = Vec::new();
        if let Some(from) = from {
            let special = &self.found.special[from];
            points.push(DiagramPoint {
                parameter: special.parameter,
                arclength: 0.0,
                observed: special.observed.clone(),
            });
        }
        points.push(self.point(&branch));
        let (index, mut end) = (self.found.branches.len(), None);
        let followed = branch.follow(self.settings.range, self.settings.points, |branch, advance| {
            points.push(self.point(branch));
            if advance.passed_fold && !advance.passed_branch_point && !branch.is_still() {
                self.keep_fold(branch, index);
            }
            end = match advance.passed_branch_point.then(|| locate::branch_point(branch)) {
                Some(Ok(point)) => self.pass(branch, &point, index, next.depth),
                _ => None,
            };
            if end.is_none() && points.len() > 3 && self.is_at(branch, &start) {
                end = Some(BranchEnd::Closed);
            }
            end.is_none()
        });
        let end = match (end, followed) {
            (Some(end), _) => end,
            (None, Ok(termination)) => BranchEnd::Followed(termination),
            (None, Err(error)) => BranchEnd::Lost(error.to_string()),
        };
        self.found.branches.push(DiagramBranch { from, depth: next.depth, points, end, state: branch.state });
    }

    fn point(&mut self, branch: &Continuation<P>) -> DiagramPoint {
        let State { solution, arclength, .. } = &branch.state;
        DiagramPoint { parameter: branch.state.parameter(), arclength: *arclength, observed: (self.observe)(solution) }
    }

    /// Whether the last step of a branch has passed a point.
    fn is_at(&self, branch: &Continuation<P>, start: &Solution) -> bool {
        let Some((before, from)) = branch.state.history.back(1) else { return false };
        let gauss = &branch.system.gauss;
        let step = branch.state.arclength - before;
        let [along, across] = distances(self.metric, from, &start.on_mesh(gauss, &from.mesh), &branch.state.tangent);
        (0.0..=step).contains(&along) && across < self.settings.separation.max(step * step)
    }

    /// A fold that cannot be located is no reason to end the branch.
    fn keep_fold(&mut self, branch: &mut Continuation<P>, index: usize) {
        if let Ok(fold) = locate::last_fold(branch) {
            let parameter = fold.solution.scalars.last().copied().unwrap_or(f64::NAN);
            let observed = (self.observe)(&fold.solution);
            let (error, solution) = (fold.error, fold.solution);
            let kind = SpecialKind::Fold;
            self.found.special.push(SpecialPoint { kind, parameter, error, observed, branch: index, solution });
        }
    }

    /// Takes note of a branch point: of the arms that a branch has come and gone by, and of those that remain. Returns why the branch
    /// ends there if it does.
    fn pass(
        &mut self,
        branch: &mut Continuation<P>,
        point: &BranchPoint,
        index: usize,
        depth: usize,
    ) -> Option<BranchEnd> {
        let gauss = branch.system.gauss.clone();
        let is_near = |known: &Crossing| {
            let there = known.solution.on_mesh(&gauss, &point.solution.mesh);
            let [along, across] = distances(self.metric, &point.solution, &there, &point.tangents[0]);
            along.hypot(across) < self.settings.separation
        };
        let Some(crossing) = self.crossings.iter().position(is_near) else {
            self.cross(branch, point, index, depth);
            return None;
        };
        let known = &mut self.crossings[crossing];
        let mut used = [false; 2];
        for (sign, used) in [-1.0, 1.0].into_iter().zip(&mut used) {
            let cosine = |arm: &Arm| {
                let mut there = arm.direction.clone();
                crate::metric::transfer_direction(&gauss, &known.solution.mesh, &point.solution.mesh, &mut there);
                sign * self.metric.dot(&point.solution.mesh, &there, &point.tangents[0])
            };
            let nearest = known.arms.iter().enumerate().max_by(|a, b| cosine(a.1).total_cmp(&cosine(b.1)));
            if let Some((arm, _)) = nearest {
                *used = std::mem::replace(&mut known.arms[arm].used, true);
            }
        }
        used[1].then_some(BranchEnd::Joined(known.index))
    }

    /// A new branch point: its other arms are to be followed.
    fn cross(&mut self, branch: &mut Continuation<P>, point: &BranchPoint, index: usize, depth: usize) {
        let observed = (self.observe)(&point.solution);
        let (kind, parameter, error) = (point.kind().into(), point.parameter(), point.error);
        let solution = point.solution.clone();
        let special = self.found.special.len();
        self.found.special.push(SpecialPoint { kind, parameter, error, observed, branch: index, solution });
        let mut arms = Vec::new();
        for (tangent, used) in point.tangents.iter().zip([true, false]) {
            for sign in [-1.0, 1.0] {
                let mut direction = tangent.clone();
                direction.scale(sign);
                arms.push(Arm { direction, used });
            }
        }
        let crossing = self.crossings.len();
        self.crossings.push(Crossing { index: special, solution: point.solution.clone(), arms });
        if depth == self.settings.depth {
            return;
        }
        for (forwards, arm) in [(true, 3), (false, 2)] {
            if let Ok(state) = point.switch(branch, forwards) {
                self.pending.push_back(Pending { from: Some((crossing, arm)), depth: depth + 1, state });
            }
        }
    }
}
