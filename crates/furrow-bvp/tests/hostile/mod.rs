//! Any bytes make a problem, a mesh, a guess and settings, sound or not: every solve with them ends with a result or an error.

use furrow_bvp::continuation::State;
use furrow_bvp::continuation::predictor::History;
use furrow_bvp::{
    AntisymmetricEnd, BoundaryJacobian, BoundaryValueProblem, Codim2Curve, CollocationPoint, Continuation,
    ContinuationSettings, CurveSettings, Dimensions, Direction, Directional, Fold, Gauss, LinearCondition, Metric,
    MinimallyAugmented, MirrorSymmetric, Newton, PointDirection, PointJacobian, PointValues, Settings, Singularity,
    Solution, SolutionOperator, SymmetryBreaking, System, locate, mesh, solve,
};

/// Numbers read from bytes; zeros behind the last.
#[derive(Clone)]
struct Bytes<'a>(&'a [u8]);

/// Numbers that break what was not written with them in mind.
const ODD: [f64; 16] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    0.0,
    -0.0,
    -1.0,
    1e-300,
    5e-324,
    1e300,
    -1e300,
    f64::MAX,
    1.0 + f64::EPSILON,
    1e-16,
    1e16,
    -1e-3,
    3.0,
];

impl Bytes<'_> {
    fn byte(&mut self) -> usize {
        let Some((first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        usize::from(*first)
    }

    /// True once in `among` times.
    fn rarely(&mut self, among: usize) -> bool {
        self.byte() % among == 1
    }

    /// Mostly a number of moderate size, now and then an odd one.
    fn number(&mut self) -> f64 {
        match self.byte() {
            kind @ 240.. => ODD[kind - 240],
            kind => (kind as f64 - 120.0) / 40.0,
        }
    }

    /// Mostly `usual`, now and then any number.
    fn setting(&mut self, usual: f64) -> f64 {
        if self.rarely(16) { self.number() } else { usual }
    }

    fn numbers(&mut self, len: usize) -> Vec<f64> {
        (0..len).map(|_| self.number()).collect()
    }

    /// Mostly `len`, now and then a little more or less.
    fn near(&mut self, len: usize) -> usize {
        if self.rarely(24) { (len + 2).saturating_sub(self.byte() % 5) } else { len }
    }
}

/// A polynomial right-hand side with a pole and a hole, linear conditions, an integral.
#[derive(Clone)]
struct Hostile {
    dims: Dimensions,
    /// Of y, y², p, and one more.
    terms: [f64; 4],
    /// What f is instead, in every component, where y is above 2.
    above: Option<f64>,
    mirror: [Vec<usize>; 2],
}

impl Hostile {
    fn slope(&self, y: f64, p: f64) -> [f64; 3] {
        match self.above {
            Some(value) if y > 2.0 => [value; 3],
            _ => {
                let [a, b, c, d] = self.terms;
                [a * y + b * y * y + c * p * y + d, a + 2.0 * b * y + c * p, c * y]
            }
        }
    }
}

impl BoundaryValueProblem for Hostile {
    fn dimensions(&self) -> Dimensions {
        self.dims
    }

    fn rhs(&self, _: CollocationPoint, y: &[f64], p: &[f64], f: &mut [f64], g: &mut [f64]) {
        let n = y.len();
        for (k, f) in f.iter_mut().enumerate() {
            *f = self.slope(y[(k + 1) % n], p.last().copied().unwrap_or(1.0))[0];
        }
        g.fill(y[0]);
    }

    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        self.rhs(at, y, p, out.f, out.g);
        let (n, np) = (y.len(), p.len());
        for k in 0..n {
            let [_, by_y, by_p] = self.slope(y[(k + 1) % n], p.last().copied().unwrap_or(1.0));
            out.fy[k * n + (k + 1) % n] = by_y;
            if np > 0 {
                out.fp[k * np + np - 1] = by_p;
            }
        }
        out.gy.chunks_exact_mut(n).for_each(|row| row[0] = 1.0);
    }

    fn left(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        condition(y, p, out);
    }

    fn right(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        condition(y, p, out);
    }
}

/// Row k: component k is the scalar unknown k, or 0.
fn condition(y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
    let n = y.len();
    for k in 0..out.r.len() {
        out.r[k] = y[k % n] - p.get(k).copied().unwrap_or(0.0);
        out.ry[k * n + k % n] = 1.0;
        if k < p.len() {
            out.rp[k * p.len() + k] = -1.0;
        }
    }
}

impl Directional for Hostile {
    fn second(&self, point: PointValues, [a, b]: [PointDirection; 2], [f, _]: [&mut [f64]; 2]) {
        let n = point.y.len();
        for (k, f) in f.iter_mut().enumerate() {
            let c = (k + 1) % n;
            let along = |d: PointDirection| d.p.last().copied().unwrap_or(0.0);
            *f = 2.0 * self.terms[1] * a.y[c] * b.y[c] + self.terms[2] * (a.y[c] * along(b) + b.y[c] * along(a));
        }
    }
}

impl MirrorSymmetric for Hostile {
    fn vanishing_at_mirror(&self) -> &[usize] {
        &self.mirror[0]
    }

    fn free_at_mirror(&self) -> &[usize] {
        &self.mirror[1]
    }
}

fn problem(from: &mut Bytes) -> Hostile {
    let components = from.near(1 + from.clone().byte() % 3);
    let scalars = from.byte() % 4;
    // Mostly square or short of one or two conditions.
    let conditions = (components + scalars).saturating_sub(from.byte() % 3);
    let integrals = usize::from(from.rarely(6)).min(conditions);
    let left = from.near((conditions - integrals) / 2);
    let right = from.near((conditions - integrals).saturating_sub(left));
    let dims = Dimensions { components, scalars, left, right, integrals, ..Dimensions::default() };
    let dims = match from.byte() {
        255 => Dimensions { components: usize::MAX, ..dims },
        254 => Dimensions { left: usize::MAX, right: usize::MAX, ..dims },
        253 => Dimensions { quadratures: usize::MAX, trailing_quadratures: 1, ..dims },
        252 => Dimensions { scalars: 40, ..dims },
        _ => dims,
    };
    let terms = [0; 4].map(|_| from.number());
    let above = from.rarely(6).then(|| from.number());
    let mut list = |start: usize, len: usize| (start..start + from.near(len)).collect();
    let vanish = components.saturating_sub(left);
    let mirror = [list(0, vanish), list(vanish.min(components.saturating_sub(1)), 1)];
    Hostile { dims, terms, above, mirror }
}

/// Mostly a mesh; now and then short, not increasing or not finite.
fn nodes(from: &mut Bytes) -> Vec<f64> {
    let mut mesh = mesh::uniform(from.setting(0.0), from.setting(1.0), from.near(2 + from.clone().byte() % 4));
    if from.rarely(12) && !mesh.is_empty() {
        let k = from.byte() % mesh.len();
        mesh[k] = from.number();
    }
    if from.rarely(32) {
        mesh.truncate(from.byte() % 3);
    }
    mesh
}

fn guess(from: &mut Bytes, dims: Dimensions) -> Solution {
    let (stages, mesh) = (from.near(1 + from.clone().byte() % 5), nodes(from));
    let components = from.near(dims.components.min(8));
    let scalars = from.near(dims.scalars.min(8));
    let scalars = from.numbers(scalars);
    if let Ok(gauss) = Gauss::new(stages)
        && !from.byte().is_multiple_of(4)
        && let Ok(y) = Solution::from_fn(&gauss, &mesh, components, &scalars, |_, y| y.fill(from.number()))
    {
        return y;
    }
    // Fields set by hand, which need not agree.
    let nodes = from.near(mesh.len() * components);
    let values = from.near(mesh.len().saturating_sub(1) * stages * components);
    Solution { components, m: stages, nodes: from.numbers(nodes), stages: from.numbers(values), scalars, mesh }
}

fn direction(from: &mut Bytes, y: &Solution) -> Direction {
    let [nodes, stages, scalars] = [&y.nodes, &y.stages, &y.scalars].map(|values| from.near(values.len()));
    Direction { nodes: from.numbers(nodes), stages: from.numbers(stages), scalars: from.numbers(scalars) }
}

fn newton(from: &mut Bytes) -> Newton {
    Newton {
        tolerance: from.setting(1e-8),
        max_factorisations: from.near(4),
        max_iterations: from.near(8),
        min_damping: from.setting(0.1),
        leniency: from.setting(1.0),
        chord_contraction: from.setting(0.3),
    }
}

fn continuation(from: &mut Bytes) -> ContinuationSettings {
    ContinuationSettings {
        newton: newton(from),
        first_step: from.setting(0.1),
        min_step: from.setting(1e-2),
        max_step: from.setting(1.0),
        min_cosine: from.setting(0.5),
        remesh_above: from.setting(1.5),
        remesh_every: from.byte() % 4,
        tolerance: from.rarely(3).then(|| from.setting(1e-3)),
        max_intervals: from.byte() % 40,
        ..ContinuationSettings::default()
    }
}

fn curve(from: &mut Bytes) -> CurveSettings {
    CurveSettings {
        first_step: from.setting(0.1),
        min_step: from.setting(1e-2),
        max_step: from.setting(1.0),
        min_cosine: from.setting(0.5),
        target_correction: from.setting(1e-4),
        tolerance: from.setting(1e-8),
        remesh_above: from.setting(1.5),
    }
}

fn metric(from: &mut Bytes, y: &Solution) -> Metric {
    let (components, scalars) = (from.near(y.components), from.near(y.scalars.len()));
    let mut metric = Metric::unit(components, scalars);
    metric.components.iter_mut().chain(&mut metric.scalars).for_each(|w| *w = from.setting(1.0));
    metric
}

/// Solves the problem in the bytes in every way.
pub fn check(data: &[u8]) {
    let from = &mut Bytes(data);
    let mut problem = problem(from);
    let y = guess(from, problem.dims);
    values(from, &mut problem, &y);
    let max_intervals = from.byte() % 40;
    let settings =
        Settings { tolerance: from.setting(1e-3), max_intervals, newton: newton(from), ..Settings::default() };
    if let Ok(solved) = solve(&mut problem, &y, &settings) {
        assert!(solved.defect <= settings.tolerance && solved.solution.check().is_ok());
    }
    branch(from, &problem, &y);
    linearised(from, &mut problem, &y);
    let (metric, tangent) = (metric(from, &y), direction(from, &y));
    let fold = Fold::new(from.byte() % 4);
    singular(from, &problem, fold.clone(), &y, &metric, &tangent);
    singular(from, &problem, SymmetryBreaking::default(), &y, &metric, &tangent);
    let curve_settings = curve(from);
    if let Ok(mut curve) = Codim2Curve::start(problem, fold, y, metric, &tangent, curve_settings, true) {
        let _ = (curve.advance(), curve.advance(), curve.turning_point(from.byte()), curve.at(from.byte(), 1.0));
        curve.head_for(from.byte(), from.number());
        let _ = curve.follow_to(from.byte() % 4, from.number(), 3, |_, _| true);
    }
}

/// Values of a solution that need not be one.
fn values(from: &mut Bytes, problem: &mut Hostile, y: &Solution) {
    let (mut out, other) = (vec![0.0; from.near(y.components)], nodes(from));
    y.eval(&y.gauss(), from.number(), &mut out);
    let carried = y.on_mesh(&Gauss::default(), &other);
    carried.eval(&carried.gauss(), from.number(), &mut out);
    let defects = mesh::defect(&y.gauss(), problem, y);
    let (mut weight, mut grid) = (Vec::new(), Vec::new());
    mesh::defect_monitor(&other, &defects, y.m, &mut weight);
    mesh::equidistribute(&other, &weight, from.byte() % 9, &mut grid);
    assert!(mesh::rebalanced(&mesh::halved(&other), &weight, 1.0).is_none_or(|grid| mesh::check(&grid).is_ok()));
}

/// Factors, solves and a solution operator, of sizes that may not fit each other.
fn linearised(from: &mut Bytes, problem: &mut Hostile, y: &Solution) {
    let mut system = System::new(problem.dims, from.near(y.m));
    let conditions = [LinearCondition {
        nodes: vec![1.0; from.near(y.nodes.len())],
        scalars: vec![1.0; y.scalars.len()],
        value: 0.0,
    }];
    let conditions = &conditions[..usize::from(from.rarely(2))];
    let _ = system.factorise(problem, y, conditions);
    let (mut out, residual, mut end) = (Direction::default(), system.zero_residual(), AntisymmetricEnd::default());
    let _ = (system.solve(&residual, &mut out), system.solve_last_node(&residual, &mut out));
    let vanishing: Vec<usize> = (0..from.byte() % 3).map(|_| from.byte() % 3).collect();
    let _ = system.factor_antisymmetric(&vanishing, &mut end);
    let _ = system.solve_antisymmetric(&end, &residual, &mut out);
    let (points, per_point) = (y.intervals() * y.m, [from.byte() % 3, from.byte() % 3]);
    let own = y.components - problem.dims.all_quadratures().min(y.components);
    let [force, reading] = [own * per_point[0], y.components * per_point[1]].map(|k| vec![1.0; from.near(points * k)]);
    let mut operator = SolutionOperator::default();
    let _ = operator.assemble(&system, per_point, &force, &reading);
    if from.rarely(3) {
        let other = guess(from, problem.dims);
        let _ = system.factorise(problem, &other, conditions);
    }
    let [forces, mut read] = per_point.map(|k| vec![1.0; from.near(points * k)]);
    let mut scalars = vec![0.0; from.near(y.scalars.len())];
    let _ = operator.apply(&mut system, from.rarely(2).then_some(&end), &forces, &mut read, &mut scalars);
}

/// A branch started, followed, stored and resumed, also from states that do not fit.
fn branch(from: &mut Bytes, problem: &Hostile, y: &Solution) {
    let (metric, settings) = (metric(from, y), continuation(from));
    if let Ok(mut branch) =
        Continuation::start(problem.clone(), y.clone(), metric.clone(), settings.clone(), from.rarely(2))
    {
        let range = [from.setting(-1.0), from.setting(3.0)];
        let ended = branch.follow(range, 3, |branch, advance| {
            let accurate = |tolerance: f64| advance.defect.is_some_and(|defect| defect <= tolerance);
            assert!(branch.settings.tolerance.is_none_or(accurate));
            if let Ok(point) = locate::branch_point(branch) {
                let _ = (point.kind(), point.switch(branch, true).is_ok());
            }
            true
        });
        let signs = [from.number(), from.number()];
        let _ = (ended, locate::between_last_points(&mut branch, Fold::new(from.byte() % 4), signs));
        let stored = serde_json::to_string(&branch.state).unwrap_or_default();
        if let Ok(state) = serde_json::from_str::<State>(&stored) {
            let _ = Continuation::resume(problem.clone(), state, metric.clone(), settings.clone()).advance();
        }
        branch.move_to(&nodes(from));
        let _ = (branch.advance(), branch.at(from.number()), branch.land_on(from.number()));
    }
    let mut history = History::of_order(from.byte() % 4);
    let other = guess(from, problem.dims);
    history.push(from.number(), if from.rarely(4) { &other } else { y });
    let state = State {
        solution: y.clone(),
        tangent: direction(from, y),
        arclength: from.setting(0.0),
        step: from.setting(0.1),
        points: from.byte(),
        direction: from.number(),
        orientation: from.number(),
        history,
    };
    let mut resumed = Continuation::resume(problem.clone(), state, metric, settings);
    let _ = (resumed.advance(), resumed.factorise_newest(), resumed.land_on(from.number()));
}

fn singular<S: Singularity<Hostile>>(
    from: &mut Bytes,
    problem: &Hostile,
    singularity: S,
    y: &Solution,
    metric: &Metric,
    tangent: &Direction,
) {
    let stages = from.near(y.m);
    let Ok(mut point) = MinimallyAugmented::new(problem.clone(), singularity, stages, metric.clone(), tangent) else {
        return;
    };
    let mut y = y.clone();
    let _ = (point.sign_at(&y), point.solve(&mut y, None), point.refresh(&y));
    point.curve_direction(&y);
}
