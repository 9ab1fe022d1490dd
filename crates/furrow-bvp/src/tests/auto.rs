//! Derivatives by automatic differentiation, their defaults by differences, and the checker of those by hand.

use std::f64::consts::PI;

use super::{Random, distance};
use crate::auto::Jet;
use crate::normal_form::pitchfork_normal_form;
use crate::{
    Auto, BoundaryJacobian, BoundaryValueProblem, CheckError, CollocationPoint, Continuation, Dimensions, Directional,
    DualNum, EndDerivatives, EndValues, Equations, Gauss, Metric, MinimallyAugmented, MirrorSymmetric, Number,
    PointDirection, PointJacobian, PointValues, SimpleProblem, Solution, SymmetryBreaking, check_derivatives,
    check_directional, locate, mesh,
};

/// Every kind of term, all of them nonlinear: two components, two scalars, one integral.
#[derive(Clone)]
struct Everything;

impl Equations for Everything {
    fn dimensions(&self) -> Dimensions {
        Dimensions { components: 2, scalars: 2, left: 1, right: 1, integrals: 1, ..Dimensions::default() }
    }
    fn rhs<D: Number>(&self, x: f64, y: &[D], p: &[D], f: &mut [D]) {
        f[0] = y[1] * y[0].sin() + p[1] * x;
        f[1] = -p[0] * (y[0] * p[1]).exp();
    }
    fn integrands<D: Number>(&self, x: f64, y: &[D], p: &[D], g: &mut [D]) {
        g[0] = y[0].powi(3) * p[0] - x;
    }
    fn left<D: Number>(&self, y: &[D], p: &[D], r: &mut [D]) {
        r[0] = y[1] - y[0].powi(3) * p[1];
    }
    fn right<D: Number>(&self, y: &[D], p: &[D], r: &mut [D]) {
        r[0] = (y[0] * y[1]).cos() - p[0];
    }
    fn offsets<D: Number>(&self, p: &[D], h: &mut [D]) {
        h[0] = p[0].powi(2) * p[1];
    }
}

/// The same in closures.
fn closures() -> SimpleProblem {
    SimpleProblem::new(2, |x, y, p, f| Everything.rhs(x, y, p, f))
        .scalars(2)
        .left_conditions(1, |y, p, r| Everything.left(y, p, r))
        .right_conditions(1, |y, p, r| Everything.right(y, p, r))
        .integrals(1, |x, y, p, g| Everything.integrands(x, y, p, g))
        .offsets(|p, h| Everything.offsets(p, h))
}

/// A problem that gives first derivatives and [`Directional::second`] alone; the named entry is wrong.
#[derive(Clone)]
struct ByHand<E> {
    exact: Auto<E>,
    wrong: &'static str,
}

impl<E> ByHand<E> {
    fn of(equations: E, wrong: &'static str) -> ByHand<E> {
        ByHand { exact: Auto(equations), wrong }
    }

    /// Spoils a value if it is the one that is wrong.
    fn spoil(&self, name: &str, value: &mut [f64], k: usize) {
        if self.wrong == name {
            value[k] = 1.01 * value[k] + 0.03;
        }
    }
}

impl<E: Equations> BoundaryValueProblem for ByHand<E> {
    fn dimensions(&self) -> Dimensions {
        let quadratures = if self.wrong == "∂f[0]/∂y[0] of two quadratures" { 1 } else { 0 };
        Dimensions { quadratures, ..self.exact.dimensions() }
    }
    fn rhs(&self, at: CollocationPoint, y: &[f64], p: &[f64], f: &mut [f64], g: &mut [f64]) {
        self.exact.rhs(at, y, p, f, g);
    }
    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        self.exact.rhs_jacobian(at, y, p, out);
        self.spoil("f[1] with derivatives", out.f, 1);
        self.spoil("∂f[1]/∂y[0]", out.fy, 2);
        self.spoil("∂f[0]/∂p[1]", out.fp, 1);
        self.spoil("∂g[0]/∂y[0]", out.gy, 0);
        self.spoil("∂g[0]/∂p[0]", out.gp, 0);
    }
    fn left(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        self.exact.left(y, p, out);
        self.spoil("∂left[0]/∂y[0]", out.ry, 0);
    }
    fn right(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        self.exact.right(y, p, out);
        self.spoil("∂right[0]/∂p[0]", out.rp, 0);
    }
    fn integral_offset(&self, k: usize, p: &[f64], hp: &mut [f64]) -> f64 {
        let h = self.exact.integral_offset(k, p, hp);
        self.spoil("∂h[0]/∂p[1]", hp, 1);
        h
    }
}

impl<E: Equations> Directional for ByHand<E> {
    fn second(&self, point: PointValues, along: [PointDirection; 2], [f, g]: [&mut [f64]; 2]) {
        self.exact.second(point, along, [&mut *f, &mut *g]);
        self.spoil("D²f[1]", f, 1);
        self.spoil("D²g[0]", g, 0);
    }
    fn third(&self, point: PointValues, a: PointDirection, [[f2, g2], [f3, g3]]: [[&mut [f64]; 2]; 2]) -> bool {
        let spoilt = ["D² of third: f[0]", "D³f[1]", "D³g[0]"].contains(&self.wrong);
        if spoilt {
            self.exact.third(point, a, [[&mut *f2, &mut *g2], [&mut *f3, &mut *g3]]);
            self.spoil("D² of third: f[0]", f2, 0);
            self.spoil("D³f[1]", f3, 1);
            self.spoil("D³g[0]", g3, 0);
        }
        spoilt
    }
}

impl<E: MirrorSymmetric> MirrorSymmetric for ByHand<E> {
    fn vanishing_at_mirror(&self) -> &[usize] {
        self.exact.vanishing_at_mirror()
    }
    fn free_at_mirror(&self) -> &[usize] {
        self.exact.free_at_mirror()
    }
}

/// Values without a pattern.
fn somewhere() -> Solution {
    let wave = |x: f64, y: &mut [f64]| y.copy_from_slice(&[0.4 + x.sin(), 0.9 - x * x]);
    Solution::from_fn(&Gauss::new(2).unwrap(), &mesh::uniform(0.1, 1.0, 5), 2, &[0.7, -0.4], wave).unwrap()
}

/// First derivatives, D² along two directions, D² and D³ along the first, of f and g and of the conditions.
fn derivatives<P: Directional>(problem: &mut P, random: &mut Random) -> Vec<Vec<f64>> {
    let ([y, ya, yb], [p, pa, pb]) = ([(); 3].map(|()| random.vector(2)), [(); 3].map(|()| random.vector(2)));
    let at = CollocationPoint { x: 0.3, index: 0 };
    let [mut f, mut fp] = [2, 4].map(|len| vec![0.0; len]);
    let ([mut fy, mut gy, mut gp], mut g) = ([vec![0.0; 4], vec![0.0; 2], vec![0.0; 2]], vec![0.0]);
    let mut out = PointJacobian { f: &mut f, fy: &mut fy, fp: &mut fp, g: &mut g, gy: &mut gy, gp: &mut gp };
    problem.rhs_jacobian(at, &y, &p, &mut out);
    let [mut f2, mut f3, mut ff] = [(); 3].map(|()| vec![0.0; 2]);
    let [mut g2, mut g3, mut gg] = [(); 3].map(|()| vec![0.0]);
    let (a, b) = (PointDirection { y: &ya, p: &pa }, PointDirection { y: &yb, p: &pb });
    problem.second(PointValues { at, y: &y, p: &p }, [a, b], [&mut ff, &mut gg]);
    let points = crate::CollocationPoints { first: 0, x: &[at.x], y: &y };
    problem.third_many(points, &p, a, [[&mut f2, &mut g2], [&mut f3, &mut g3]]);
    let ends = EndValues { left: &y, right: &ya, p: &p };
    let [a, b] = [[&ya, &yb, &pa], [&yb, &ya, &pb]].map(|[left, right, p]| EndValues { left, right, p });
    let mut at_ends = [[0.0; 3]; 2];
    for (order, [left, right, offset]) in at_ends.iter_mut().enumerate() {
        let [left, right, offsets] = [left, right, offset].map(std::slice::from_mut);
        let out = EndDerivatives { left, right, offsets };
        if order == 0 { problem.second_at_ends(ends, [a, b], out) } else { problem.third_at_ends(ends, a, out) }
    }
    let [second, third] = at_ends.map(Vec::from);
    vec![[f, fy, fp, g, gy, gp].concat(), [ff, gg].concat(), [f2, g2].concat(), [f3, g3].concat(), second, third]
}

#[test]
fn equations_closures_and_differences_have_the_same_derivatives() {
    let mut random = Random(7);
    for _ in 0..20 {
        let seed = random.0;
        let exact = derivatives(&mut Auto(Everything), &mut Random(seed));
        let jets = derivatives(&mut closures(), &mut Random(seed));
        let differences = derivatives(&mut ByHand::of(Everything, ""), &mut Random(seed));
        for ((exact, jets), differences) in exact.iter().zip(&jets).zip(&differences) {
            assert!(distance(exact, jets) < 1e-13, "{exact:?} {jets:?}");
            assert!(distance(exact, differences) < 1e-7, "{exact:?} {differences:?}");
        }
        random.next();
    }
}

/// By the formula of the problem, so that not all statements share a mistake.
#[test]
fn automatic_derivatives_are_those_of_the_formula() {
    let (y, p) = ([0.4, 0.9], [0.7, -0.4]);
    let (a, point) = (PointDirection { y: &[1.0, 0.0], p: &[0.0, 0.0] }, CollocationPoint { x: 0.3, index: 0 });
    let ([mut f2, mut f3], [mut g2, mut g3]) = ([[0.0; 2]; 2], [[0.0]; 2]);
    let at = PointValues { at: point, y: &y, p: &p };
    assert!(Auto(Everything).third(at, a, [[&mut f2, &mut g2], [&mut f3, &mut g3]]));
    let force = p[0] * (y[0] * p[1]).exp();
    let expected = [-y[1] * y[0].sin(), -force * p[1] * p[1], -y[1] * y[0].cos(), -force * p[1].powi(3)];
    assert!(distance(&[f2, f3].concat(), &expected) < 1e-15);
    assert!(distance(&[g2, g3].concat(), &[6.0 * y[0] * p[0], 6.0 * p[0]]) < 1e-15);
    let jet = Jet::new(2.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0).powi(3);
    assert_eq!([jet.eps1, jet.eps1eps2, jet.eps1eps2eps3], [12.0, 12.0, 6.0]);
}

/// u″ + λu = 0 on the half [0, ½] with a mirror at ½, and u′(0) = u(0)³.
#[derive(Clone)]
struct Spring;

impl Equations for Spring {
    fn dimensions(&self) -> Dimensions {
        Dimensions { components: 2, scalars: 1, left: 1, right: 1, ..Dimensions::default() }
    }
    fn rhs<D: Number>(&self, _: f64, y: &[D], p: &[D], f: &mut [D]) {
        (f[0], f[1]) = (y[1], -p[0] * y[0]);
    }
    fn left<D: Number>(&self, y: &[D], _: &[D], r: &mut [D]) {
        r[0] = y[1] - y[0].powi(3);
    }
    fn right<D: Number>(&self, y: &[D], _: &[D], r: &mut [D]) {
        r[0] = y[1];
    }
}

impl MirrorSymmetric for Spring {
    fn vanishing_at_mirror(&self) -> &[usize] {
        &[0]
    }
    fn free_at_mirror(&self) -> &[usize] {
        &[1]
    }
}

/// The antisymmetric branch is u = a cos πx + O(a³) at λ = π² + c a². Green's identity with cos πx gives
/// −u′(0) + c a³ ∫cos² πx dx = 0, and with u′(0) = a³ and an integral of ¼ over the half c = 4. All of it is due to the
/// condition: the equation is linear.
#[test]
fn nonlinear_boundary_conditions_enter_the_normal_form() {
    fn coefficient<P: Directional + MirrorSymmetric + Clone>(problem: P) -> f64 {
        let mut y = Solution::constant(4, &mesh::uniform(0.0, 0.5, 10), &[0.0; 2], &[9.0]);
        let metric = Metric::unit(2, 1);
        let branch = Continuation::start(problem.clone(), y.clone(), metric.clone(), Default::default(), true).unwrap();
        let breaking = SymmetryBreaking::default();
        let mut point = MinimallyAugmented::new(problem, breaking, 4, metric, &branch.state.tangent).unwrap();
        point.solve(&mut y, None).unwrap();
        assert!((y.scalars[0] / (PI * PI) - 1.0).abs() < 1e-10);
        // φ has φ′(½) = 1; cos πx has −π there.
        pitchfork_normal_form(&mut point, &y).unwrap().parameters[0] * PI * PI
    }
    let [exact, differences] = [coefficient(Auto(Spring)), coefficient(ByHand::of(Spring, ""))];
    assert!((exact - 4.0).abs() < 1e-8, "{exact}");
    assert!((differences - 4.0).abs() < 1e-7, "{differences}");
}

/// u″ = 0, u′(0) = −λ exp u(0), u(1) = 0: u = A(1 − x) with λ = A exp(−A), which folds at A = 1.
#[derive(Clone)]
struct Heated;

impl Equations for Heated {
    fn dimensions(&self) -> Dimensions {
        Dimensions { components: 2, scalars: 1, left: 1, right: 1, ..Dimensions::default() }
    }
    fn rhs<D: Number>(&self, _: f64, y: &[D], _: &[D], f: &mut [D]) {
        f[0] = y[1];
    }
    fn left<D: Number>(&self, y: &[D], p: &[D], r: &mut [D]) {
        r[0] = y[1] + p[0] * y[0].exp();
    }
    fn right<D: Number>(&self, y: &[D], _: &[D], r: &mut [D]) {
        r[0] = y[0];
    }
}

/// u′ = 0, u(0) = c, ∫u dx − c² − λ = 0: folds at c = ½ with λ = ¼.
#[derive(Clone)]
struct Parabola;

impl Equations for Parabola {
    fn dimensions(&self) -> Dimensions {
        Dimensions { components: 1, scalars: 2, left: 1, integrals: 1, ..Dimensions::default() }
    }
    fn rhs<D: Number>(&self, _: f64, _: &[D], _: &[D], _: &mut [D]) {}
    fn integrands<D: Number>(&self, _: f64, y: &[D], _: &[D], g: &mut [D]) {
        g[0] = y[0];
    }
    fn left<D: Number>(&self, y: &[D], p: &[D], r: &mut [D]) {
        r[0] = y[0] - p[0];
    }
    fn right<D: Number>(&self, _: &[D], _: &[D], _: &mut [D]) {}
    fn offsets<D: Number>(&self, p: &[D], h: &mut [D]) {
        h[0] = -p[0].powi(2) - p[1];
    }
}

/// λ at the fold that the branch from zero passes.
fn fold<P: Directional + Clone>(problem: P) -> f64 {
    let Dimensions { components, scalars, .. } = problem.dimensions();
    let guess = Solution::constant(3, &mesh::uniform(0.0, 1.0, 4), &vec![0.0; components], &vec![0.0; scalars]);
    let metric = Metric::unit(components, scalars);
    let mut branch = Continuation::start(problem, guess, metric, Default::default(), true).unwrap();
    branch.follow([-1.0, 1.0], 100, |_, advance| !advance.passed_fold).unwrap();
    locate::last_fold(&mut branch).unwrap().solution.scalars[scalars - 1]
}

#[test]
fn folds_due_to_boundary_conditions_and_integral_offsets_are_found() {
    for (found, exact) in [
        (fold(Auto(Heated)), (-1f64).exp()),
        (fold(ByHand::of(Heated, "")), (-1f64).exp()),
        (fold(Auto(Parabola)), 0.25),
        (fold(ByHand::of(Parabola, "")), 0.25),
    ] {
        assert!((found - exact).abs() < 1e-12, "{found} {exact}");
    }
}

#[test]
fn the_check_names_the_derivative_that_is_wrong_and_no_other() {
    let right = &mut ByHand::of(Everything, "");
    assert_eq!(check_derivatives(right, &somewhere()).and(check_directional(right, &somewhere())), Ok(()));
    assert_eq!(check_derivatives(&mut Auto(Everything), &somewhere()), Ok(()));
    assert_eq!(check_directional(&mut Auto(Everything), &somewhere()), Ok(()));
    let first = ["f[1] with derivatives", "∂f[1]/∂y[0]", "∂f[0]/∂p[1]", "∂g[0]/∂y[0]", "∂g[0]/∂p[0]"];
    let at_ends = ["∂left[0]/∂y[0]", "∂right[0]/∂p[0]", "∂h[0]/∂p[1]", "∂f[0]/∂y[0] of two quadratures"];
    for name in first.into_iter().chain(at_ends) {
        let error = check_derivatives(&mut ByHand::of(Everything, name), &somewhere());
        let Err(CheckError::Wrong(wrong)) = &error else { panic!("{name}: {error:?}") };
        assert_eq!(wrong.iter().map(|wrong| wrong.entry.as_str()).collect::<Vec<_>>(), [name]);
    }
    for name in ["D²f[1]", "D²g[0]", "D² of third: f[0]", "D³f[1]", "D³g[0]"] {
        let error = check_directional(&mut ByHand::of(Everything, name), &somewhere());
        let Err(CheckError::Wrong(wrong)) = &error else { panic!("{name}: {error:?}") };
        assert_eq!(wrong[0].entry, name);
    }
}

#[test]
fn values_of_other_sizes_cannot_be_checked() {
    let short = Solution { scalars: vec![0.7], ..somewhere() };
    let error = check_derivatives(&mut Auto(Everything), &short).unwrap_err();
    assert_eq!(error, CheckError::Guess { components: 2, scalars: 1 });
    let none = Solution::constant(2, &[0.0], &[0.0; 2], &[0.0; 2]);
    assert!(check_directional(&mut Auto(Everything), &none).is_err());
}

#[test]
fn the_readme_shows_the_first_example_in_thirty_lines() {
    let (example, readme) = (include_str!("../../examples/bratu.rs"), include_str!("../../README.md"));
    let code = example.split_once("use ").unwrap().1;
    assert!(readme.contains(&format!("```rust\nuse {code}```")), "examples/bratu.rs is not what README.md shows");
    assert!(example.lines().count() <= 30);
}
