//! Growth rates of every azimuthal number along a branch, and where they change sign.

use furrow_bvp::newton::NewtonScratch;
use furrow_bvp::{Continuation, Gauss, Newton, Solution, System};

use super::Azimuthal;
use crate::cortex::Cortex;
use crate::cortex::problem::SHAPE_SCALARS;
use crate::equilibria::ShapePoint;
use furrow_cell::Parameter;

/// Index of ξ_s among the scalar unknowns of a branch.
const XI: usize = SHAPE_SCALARS;
/// Steps of the search for a crossing, and how close to it in ξ_s it ends.
const SEARCH: usize = 40;
const CLOSE: f64 = 1e-9;

/// A shape where disturbances of one azimuthal number neither grow nor decay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The azimuthal number.
    pub m: usize,
    /// The shape.
    pub point: ShapePoint,
    /// Whether they grow beyond it, along the branch.
    pub grows: bool,
}

/// Growth rates along a branch for m = 1 … `most`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AzimuthalScan {
    /// Largest azimuthal number; none are computed if it is 0.
    most: usize,
    /// Of every point, the largest growth rate for m = 1, 2, …, where it could be computed.
    pub rates: Vec<Vec<Option<f64>>>,
    /// Where they change sign.
    pub crossings: Vec<Crossing>,
    before: Option<Solution>,
}

/// The largest growth rate of disturbances of azimuthal number m.
fn rate(cortex: &Cortex, y: &Solution, m: usize) -> Option<f64> {
    Azimuthal::new(cortex, y, m).growth_rate().ok()
}

impl AzimuthalScan {
    /// For m = 1 … `most`.
    pub fn new(most: usize) -> AzimuthalScan {
        AzimuthalScan { most, ..AzimuthalScan::default() }
    }

    /// Takes in the newest point of a branch.
    pub(crate) fn take_in(&mut self, branch: &Continuation<Cortex>) {
        if self.most == 0 {
            return;
        }
        let (cortex, y) = (&branch.problem, &branch.state.solution);
        let now: Vec<Option<f64>> = (1..=self.most).map(|m| rate(cortex, y, m)).collect();
        if let (Some(last), Some(from)) = (self.rates.last(), &self.before) {
            for (k, (a, b)) in last.iter().zip(&now).enumerate() {
                if let (Some(a), Some(b)) = (a, b)
                    && (*a < 0.0) != (*b < 0.0)
                    && let Some(point) = crossing(cortex, [from, y], k + 1, [*a, *b])
                {
                    self.crossings.push(Crossing { m: k + 1, point, grows: *b > *a });
                }
            }
        }
        self.rates.push(now);
        self.before = Some(y.clone());
    }
}

/// The shape between two of a branch where the growth rate is 0, by false position on ξ_s; none where the branch turns back between
/// them, or a shape is not found.
fn crossing(cortex: &Cortex, [from, to]: [&Solution; 2], m: usize, rates: [f64; 2]) -> Option<ShapePoint> {
    let gauss = Gauss::new(to.m);
    let from = from.on_mesh(&gauss, &to.mesh);
    let (mut ends, mut rates) = ([from.scalars[XI], to.scalars[XI]], rates);
    let mut fixed = Cortex::new(&cortex.cell, cortex.domain, &[]);
    let mut system = System::new(Cortex::dimensions_for(&fixed.cell, 0), to.m);
    let mut scratch = NewtonScratch::default();
    let whole = ends[1] - ends[0];
    let mut found = None;
    for _ in 0..SEARCH {
        let xi = ends[0] - rates[0] * (ends[1] - ends[0]) / (rates[1] - rates[0]);
        let share = (xi - from.scalars[XI]) / whole;
        let mut y = to.clone();
        for (y, from) in [(&mut y.nodes, &from.nodes), (&mut y.stages, &from.stages), (&mut y.scalars, &from.scalars)] {
            y.iter_mut().zip(from).for_each(|(y, from)| *y = from + share * (*y - from));
        }
        y.scalars.truncate(SHAPE_SCALARS);
        fixed.set(Parameter::XiS, xi);
        Newton::default().solve(&mut system, &mut scratch, &mut fixed, &mut y, &[], false).ok()?;
        let here = rate(&fixed, &y, m)?;
        let step = found.map_or(f64::INFINITY, |before: ShapePoint| (before.xi_s - xi).abs());
        found = Some(ShapePoint::of(&y, &fixed, &gauss));
        if here == 0.0 || step < CLOSE * (1.0 + xi.abs()) {
            break;
        }
        // The Illinois rule: an end that stays counts half.
        if (here < 0.0) == (rates[1] < 0.0) {
            rates[0] *= 0.5;
        } else {
            (ends[0], rates[0]) = (ends[1], rates[1]);
        }
        (ends[1], rates[1]) = (xi, here);
    }
    found
}
