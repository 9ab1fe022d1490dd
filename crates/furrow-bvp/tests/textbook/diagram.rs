//! Diagrams of problems with known branches.

use std::f64::consts::PI;

use furrow_bvp::{
    BranchEnd, Continuation, ContinuationSettings, Diagram, DiagramSettings, Jet, Metric, SimpleProblem, Solution,
    SpecialKind, Termination, diagram, mesh,
};

use super::oscillator::Oscillator;

/// N equations in N + 1 scalar unknowns.
fn algebraic<const N: usize>(equations: fn(&[Jet]) -> [Jet; N]) -> SimpleProblem {
    SimpleProblem::new(1, |_, y, _, f| f[0] = y[0] * 0.0)
        .scalars(N + 1)
        .left_conditions(1, |y, _, r| r[0] = y[0])
        .right_conditions(N, move |_, p, r| r.copy_from_slice(&equations(p)))
}

fn of_algebraic<const N: usize>(
    equations: fn(&[Jet]) -> [Jet; N],
    start: &[f64],
    range: [f64; 2],
    depth: usize,
) -> Diagram {
    let guess = Solution::constant(2, &mesh::uniform(0.0, 1.0, 2), &[0.0], start);
    let continuation = ContinuationSettings { first_step: 0.01, max_step: 0.05, ..Default::default() };
    let settings = DiagramSettings { continuation, range, depth, ..Default::default() };
    let observe = |y: &Solution| y.scalars[..N].to_vec();
    diagram(&algebraic(equations), guess, &Metric::unit(1, N + 1), &settings, observe).unwrap()
}

/// The kinds of all special points with their λ, by λ.
fn special(found: &Diagram) -> Vec<(SpecialKind, f64)> {
    let mut all: Vec<_> = found.special.iter().map(|point| (point.kind, point.parameter)).collect();
    all.sort_by(|a, b| a.1.total_cmp(&b.1));
    all
}

/// x(λ² + x² − 1) = 0: the circle crosses x = 0 twice, and is one branch.
#[test]
fn a_circle_that_crosses_a_line_twice_is_followed_once() {
    let circle = |p: &[Jet]| [p[0] * (p[0] * p[0] + p[1] * p[1] - 1.0)];
    let found = of_algebraic(circle, &[0.0, -1.5], [-2.0, 2.0], 3);
    let kinds = special(&found);
    assert_eq!(kinds.len(), 2, "{kinds:?}");
    assert!(kinds[0].0 == SpecialKind::SupercriticalPitchfork && (kinds[0].1 + 1.0).abs() < 1e-8);
    assert!(kinds[1].0 == SpecialKind::SubcriticalPitchfork && (kinds[1].1 - 1.0).abs() < 1e-8);
    let ends: Vec<_> = found.branches.iter().map(|branch| (branch.from, branch.end.clone())).collect();
    let bound = |value| BranchEnd::Followed(Termination::ParameterBound(value));
    let expected = [(None, bound(2.0)), (None, bound(-2.0)), (Some(0), BranchEnd::Joined(0))];
    assert_eq!(ends, expected);
    let length = found.branches[2].state.arclength;
    assert!((length - 2.0 * PI).abs() < 0.1, "{length}");
    assert!(found.branches[2].points.iter().all(|p| (p.parameter.hypot(p.observed[0]) - 1.0).abs() < 1e-6));
}

/// λ² + x² = 1 alone: the branch closes, in both directions.
#[test]
fn a_closed_branch_ends_at_its_start() {
    let found = of_algebraic(|p: &[Jet]| [p[0] * p[0] + p[1] * p[1] - 1.0], &[1.0, 0.1], [-2.0, 2.0], 3);
    assert!(found.branches.iter().all(|branch| branch.end == BranchEnd::Closed), "{:?}", found.branches[0].end);
    assert!(found.branches.iter().all(|branch| (branch.state.arclength - 2.0 * PI).abs() < 0.1));
}

/// x(x − λ)(x − 1) = 0: three lines that cross pairwise at (0, 0) and (1, 1); x = 0 and x = 1 do not meet.
#[test]
fn depth_counts_the_switches() {
    let lines = |p: &[Jet]| [p[0] * (p[0] - p[1]) * (p[0] - 1.0)];
    let counts: Vec<_> = (0..4)
        .map(|depth| {
            let found = of_algebraic(lines, &[0.0, -0.53], [-1.0, 2.0], depth);
            (found.special.len(), found.branches.len())
        })
        .collect();
    // The line x = 0; with x = λ to both sides; with x = 1 to both sides, where no other line remains.
    assert_eq!(counts, [(1, 2), (2, 4), (2, 6), (2, 6)]);
}

/// Two competitors for space, as in the tests of branch points: coexistence joins two branches of one competitor alone.
#[test]
fn a_branch_between_two_others_is_followed_once() {
    let equations = |p: &[Jet]| {
        let (a, gamma, d) = (0.1, 0.8, 0.44);
        let [m, c, lambda] = [p[0], p[1], p[2]];
        let t = -m - c + 1.0;
        [m * c * a - lambda * m / (m + t) + m * t * gamma, t * c - c * d - m * c * a]
    };
    let found = of_algebraic(equations, &[1.0 - 0.1 / 0.8, 0.0, 0.1], [0.0, 1.0], 4);
    let places: Vec<f64> = special(&found).iter().filter(|p| p.0 != SpecialKind::Fold).map(|p| p.1).collect();
    let m = (1.0 - 0.44) / 1.1;
    let mut exact = [0.8 * (1.0 - m), 0.8, 0.44 * (0.1 * 0.56 + 0.8 * 0.44)];
    exact.sort_by(f64::total_cmp);
    assert_eq!(places.len(), 3);
    assert!(places.iter().zip(exact).all(|(found, exact)| (found - exact).abs() < 1e-8), "{places:?} {exact:?}");
}

/// The table and the file of a diagram; a branch read from the file goes on as the branch itself would have.
#[test]
fn a_diagram_is_written_and_its_branches_go_on() {
    let rod = Oscillator::elastica(0);
    let metric = Metric::unit(2, 1);
    let continuation = ContinuationSettings { max_step: 1.0, ..Default::default() };
    let range = [1.0, 35.0];
    let settings =
        DiagramSettings { continuation: continuation.clone(), range, points: 20, depth: 1, ..Default::default() };
    let start = rod.zero(1.0, 16, 4, 5.0);
    let found = diagram(&rod, start, &metric, &settings, |y| vec![y.node(0)[1]]).unwrap();
    let mut table = Vec::new();
    found.write_csv(&mut table, &["slope"]).unwrap();
    let table = String::from_utf8(table).unwrap();
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows[0], "branch,kind,parameter,arclength,slope");
    let points: usize = found.branches.iter().map(|branch| branch.points.len()).sum();
    assert_eq!(rows.len(), 1 + points + found.special.len());
    assert!(rows[1 + points].starts_with("0,SupercriticalPitchfork,9.8696044"), "{}", rows[1 + points]);
    let read: Diagram = serde_json::from_str(&serde_json::to_string(&found).unwrap()).unwrap();
    assert_eq!(read, found);
    let buckled = &read.branches[2];
    assert!(matches!(buckled.end, BranchEnd::Followed(Termination::PointLimit(20))), "{:?}", buckled.end);
    let mut both = [&found, &read].map(|diagram| {
        let state = diagram.branches[2].state.clone();
        Continuation::resume(rod.clone(), state, metric.clone(), continuation.clone())
    });
    for branch in &mut both {
        branch.follow([1.0, 30.0], 5, |_, _| true).unwrap();
    }
    assert_eq!(both[0].state, both[1].state);
    assert!(both[0].state.arclength > buckled.state.arclength + 1.0);
}

/// u″ = −λ(u − u³) with u′ = 0 at both ends: every constant is a solution for λ = 0.
#[test]
fn a_vertical_branch_has_no_folds_of_rounding() {
    let problem = SimpleProblem::new(2, |_, y, p, f| (f[0], f[1]) = (y[1], -p[0] * (y[0] - y[0] * y[0] * y[0])))
        .scalars(1)
        .left_conditions(1, |y, _, r| r[0] = y[1])
        .right_conditions(1, |y, _, r| r[0] = y[1]);
    let guess = Solution::constant(4, &mesh::uniform(0.0, 1.0, 16), &[0.0, 0.0], &[-5.0]);
    let metric = Metric { components: vec![1.0, 0.0], scalars: vec![0.04] };
    let settings = DiagramSettings { range: [-6.0, 6.0], points: 60, depth: 1, ..Default::default() };
    let found = diagram(&problem, guess, &metric, &settings, |y| vec![y.node(0)[0]]).unwrap();
    let folds = found.special.iter().filter(|point| point.kind == SpecialKind::Fold).count();
    assert!(found.branches.len() > 3 && folds <= 2, "{folds} {}", found.branches.len());
}
