//! Gelfand's problem in the unit ball, u″ + 2u′/r + λeᵘ = 0, u′(0) = u(1) = 0: its branch has
//! infinitely many folds, which close in on λ = 2 as u(0) rises. Finds the first five, on meshes that follow the peak. The exact values follow from
//! the isothermal sphere φ″ + 2φ′/ξ = e^−φ: λ = ξ²e^−φ, with folds where ξφ′ = 2.

use furrow_bvp::{
    Auto, Continuation, ContinuationSettings, Dimensions, Equations, Metric, Number, Solution, locate, mesh,
};

/// λ and u(0) at the folds, by integration of the isothermal sphere from its centre.
const FOLDS: [[f64; 2]; 5] = [
    [3.321_992_118, 1.607_456_775],
    [1.664_156_190, 6.740_792_420],
    [2.108_541_102, 11.376_509_719],
    [1.967_465_559, 16.161_156_634],
    [2.009_976_405, 20.900_146_062],
];

#[derive(Clone)]
struct Ball;

impl Equations for Ball {
    fn dimensions(&self) -> Dimensions {
        Dimensions { components: 2, scalars: 1, left: 1, right: 1, ..Dimensions::default() }
    }
    // Gauss points are never at the centre.
    fn rhs<D: Number>(&self, r: f64, y: &[D], p: &[D], f: &mut [D]) {
        (f[0], f[1]) = (y[1], -y[1] * (2.0 / r) - p[0] * y[0].exp());
    }
    fn left<D: Number>(&self, y: &[D], _p: &[D], r: &mut [D]) {
        r[0] = y[1];
    }
    fn right<D: Number>(&self, y: &[D], _p: &[D], r: &mut [D]) {
        r[0] = y[0];
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let guess = Solution::constant(4, &mesh::uniform(0.0, 1.0, 10), &[0.0, 0.0], &[0.0]);
    let settings = ContinuationSettings { tolerance: Some(1e-7), ..ContinuationSettings::default() };
    let mut branch = Continuation::start(Auto(Ball), guess, Metric::unit(2, 1), settings, true)?;
    println!("λ at fold     exact         u(0)          exact         intervals");
    for [lambda, centre] in FOLDS {
        branch.follow([0.0, 10.0], 400, |_, advance| !advance.passed_fold)?;
        let fold = locate::last_fold(&mut branch)?.solution;
        let (found, height, intervals) = (fold.scalars[0], fold.node(0)[0], fold.intervals());
        println!("{found:.9}   {lambda:.9}   {height:12.9}  {centre:12.9}  {intervals:9}");
    }
    println!("{} steps, {} factorisations", branch.work.steps, branch.work.factorisations);
    Ok(())
}
