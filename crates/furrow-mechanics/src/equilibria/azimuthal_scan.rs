//! Growth rates of every azimuthal number along a branch, and their sign changes.

use furrow_bvp::newton::NewtonScratch;
use furrow_bvp::{Continuation, Newton, Solution, System};

use super::point::{ShapePoint, XI};
use crate::azimuthal::Azimuthal;
use crate::cortex::Cortex;
use crate::cortex::problem::SHAPE_SCALARS;
use furrow_cell::Parameter;

/// Most steps of the search for a crossing, and its accuracy in ξ_s.
const SEARCH: usize = 40;
pub(super) const CLOSE: f64 = 1e-9;

/// A shape at which perturbations of one azimuthal number neither grow nor decay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The azimuthal number.
    pub m: usize,
    /// The shape.
    pub point: ShapePoint,
    /// Whether they grow beyond it along the branch.
    pub grows: bool,
}

/// Growth rates along a branch for m = 1 … `most`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AzimuthalScan {
    /// Largest azimuthal number; 0 computes no rates.
    most: usize,
    /// For every point, the largest growth rate for m = 1, 2, …, if it could be computed.
    pub rates: Vec<Vec<Option<f64>>>,
    /// Points where a rate changes sign.
    pub crossings: Vec<Crossing>,
    /// Azimuthal numbers with a sign change after a point (its index) that could not be located.
    pub not_located: Vec<(usize, usize)>,
    before: Option<Solution>,
}

/// The largest growth rate of perturbations of azimuthal number m.
pub(super) fn rate(cortex: &Cortex, y: &Solution, m: usize) -> Option<f64> {
    Azimuthal::new(cortex, y, m).growth_rate().ok()
}

impl AzimuthalScan {
    /// For m = 1 … `most`.
    pub fn new(most: usize) -> AzimuthalScan {
        AzimuthalScan { most, ..AzimuthalScan::default() }
    }

    /// The azimuthal numbers with points where the rate could not be computed, and the indices of these points.
    pub fn missing(&self) -> Vec<(usize, Vec<usize>)> {
        let of = |m: usize| {
            let at = |(k, rates): (usize, &Vec<Option<f64>>)| matches!(rates.get(m - 1), Some(None)).then_some(k);
            (m, self.rates.iter().enumerate().filter_map(at).collect::<Vec<_>>())
        };
        let most = self.rates.iter().map(Vec::len).max().unwrap_or(0);
        (1..=most).map(of).filter(|(_, points)| !points.is_empty()).collect()
    }

    /// Adds the newest point of a branch.
    pub(crate) fn take_in(&mut self, branch: &Continuation<Cortex>) {
        if self.most == 0 {
            return;
        }
        let (cortex, y) = (&branch.problem, &branch.state.solution);
        let now: Vec<Option<f64>> = (1..=self.most).map(|m| rate(cortex, y, m)).collect();
        if let (Some(last), Some(from)) = (self.rates.last(), &self.before) {
            for (k, (a, b)) in last.iter().zip(&now).enumerate() {
                let (Some(a), Some(b)) = (a, b) else { continue };
                if (*a < 0.0) == (*b < 0.0) {
                    continue;
                }
                match crossing(cortex, [from, y], k + 1, [*a, *b]) {
                    Some((point, _)) => self.crossings.push(Crossing { m: k + 1, point, grows: *b > *a }),
                    None => self.not_located.push((k + 1, self.rates.len() - 1)),
                }
            }
        }
        self.rates.push(now);
        self.before = Some(y.clone());
    }
}

/// Computes stationary shapes of one cell at given activities.
pub(super) struct Corrector {
    /// The cell.
    pub cortex: Cortex,
    system: System,
    scratch: NewtonScratch,
}

impl Corrector {
    /// For the cell of a cortex.
    pub fn of(cortex: &Cortex, stages: usize) -> Corrector {
        let cortex = Cortex::new(&cortex.cell, cortex.domain, &[]);
        let system = System::new(Cortex::dimensions_for(&cortex.cell, 0), stages);
        Corrector { cortex, system, scratch: NewtonScratch::default() }
    }

    /// The growth rate of perturbations of azimuthal number m at ξ_s; `y`, a shape nearby, becomes the shape there.
    pub fn rate(&mut self, xi: f64, y: &mut Solution, m: usize) -> Option<f64> {
        self.rest(xi, y)?;
        rate(&self.cortex, y, m)
    }

    /// Turns `y`, a shape nearby, into the shape at ξ_s.
    fn rest(&mut self, xi: f64, y: &mut Solution) -> Option<()> {
        y.scalars.truncate(SHAPE_SCALARS);
        self.cortex.set(Parameter::XiS, xi);
        Newton::default().solve(&mut self.system, &mut self.scratch, &mut self.cortex, y, &[], false).ok()?;
        Some(())
    }
}

/// Linear interpolation or extrapolation between two solutions on the same mesh.
pub(super) fn between(from: &Solution, to: &Solution, share: f64) -> Solution {
    let mut y = to.clone();
    for (y, from) in [(&mut y.nodes, &from.nodes), (&mut y.stages, &from.stages), (&mut y.scalars, &from.scalars)] {
        y.iter_mut().zip(from).for_each(|(y, from)| *y = from + share * (*y - from));
    }
    y
}

/// The shape at which perturbations of azimuthal number m neither grow nor decay, as [`crossing_of`].
pub(super) fn crossing(
    cortex: &Cortex,
    shapes: [&Solution; 2],
    m: usize,
    rates: [f64; 2],
) -> Option<(ShapePoint, Solution)> {
    crossing_of(cortex, shapes, rates, &mut |cortex, y| rate(cortex, y, m))
}

/// The shape with growth rate 0 between two shapes of a branch, by false position in ξ_s; `None` if the branch turns
/// back between them, or a shape or its rate is not found.
pub(super) fn crossing_of(
    cortex: &Cortex,
    [from, to]: [&Solution; 2],
    rates: [f64; 2],
    rate: &mut dyn FnMut(&Cortex, &Solution) -> Option<f64>,
) -> Option<(ShapePoint, Solution)> {
    let gauss = to.gauss();
    let from = from.on_mesh(&gauss, &to.mesh);
    let (mut ends, mut rates) = ([from.scalars[XI], to.scalars[XI]], rates);
    let mut at_rest = Corrector::of(cortex, to.m);
    let whole = ends[1] - ends[0];
    let mut found = None;
    for _ in 0..SEARCH {
        let xi = ends[0] - rates[0] * (ends[1] - ends[0]) / (rates[1] - rates[0]);
        let mut y = between(&from, to, (xi - from.scalars[XI]) / whole);
        at_rest.rest(xi, &mut y)?;
        let here = rate(&at_rest.cortex, &y)?;
        let step = found.map_or(f64::INFINITY, |(before, _): (ShapePoint, Solution)| (before.xi_s - xi).abs());
        found = Some((ShapePoint::of(&y, &at_rest.cortex, &gauss), y));
        if here == 0.0 || step < CLOSE * (1.0 + xi.abs()) {
            break;
        }
        // The Illinois rule: the value at an end that is kept is halved.
        if (here < 0.0) == (rates[1] < 0.0) {
            rates[0] *= 0.5;
        } else {
            (ends[0], rates[0]) = (ends[1], rates[1]);
        }
        (ends[1], rates[1]) = (xi, here);
    }
    found
}
