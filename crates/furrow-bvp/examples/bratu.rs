//! Bratu's problem u″ + λeᵘ = 0, u(0) = u(1) = 0: the branch of its solutions up to the fold. There are no solutions beyond it.

use furrow_bvp::{Auto, Continuation, Dimensions, Equations, Metric, Number, Solution, locate, mesh};

#[derive(Clone)]
struct Bratu;

impl Equations for Bratu {
    fn dimensions(&self) -> Dimensions {
        Dimensions { components: 2, scalars: 1, left: 1, right: 1, ..Dimensions::default() }
    }
    fn rhs<D: Number>(&self, _x: f64, y: &[D], p: &[D], f: &mut [D]) {
        (f[0], f[1]) = (y[1], -p[0] * y[0].exp());
    }
    fn left<D: Number>(&self, y: &[D], _p: &[D], r: &mut [D]) {
        r[0] = y[0];
    }
    fn right<D: Number>(&self, y: &[D], _p: &[D], r: &mut [D]) {
        r[0] = y[0];
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let guess = Solution::constant(4, &mesh::uniform(0.0, 1.0, 20), &[0.0, 0.0], &[0.0]);
    let mut branch = Continuation::start(Auto(Bratu), guess, Metric::unit(2, 1), Default::default(), true)?;
    branch.follow([0.0, 10.0], 100, |_, advance| !advance.passed_fold)?;
    let fold = locate::last_fold(&mut branch)?.solution;
    println!("fold at λ = {:.9} (exact: 3.513830719)", fold.scalars[0]);
    Ok(())
}
