//! Points of a branch at which its shapes begin or cease to oscillate: the rightmost growth rates are a complex pair that crosses 0.

use std::f64::consts::TAU;

use furrow_bvp::Solution;
use furrow_cell::Parameter;

use super::azimuthal_scan::crossing_of;
use super::point::{ShapePoint, XI};
use super::rates::Shape;
use crate::cortex::Cortex;
use crate::cortex::problem::SHAPE_SCALARS;
use crate::stability::Stability;
use crate::stability::following::{FollowedRates, Leading};

/// A shape at which an oscillation neither grows nor decays, and all other disturbances decay: stability changes there without a fold or
/// a pitchfork.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HopfPoint {
    /// The shape.
    pub point: ShapePoint,
    /// The period of the oscillation, in τ.
    pub period: f64,
    /// Whether it grows beyond the point along the branch.
    pub grows: bool,
}

/// Growth rates closer to zero than this, in 1/τ, belong to a fold or a pitchfork, and may have either sign there.
const MARGINAL: f64 = 1e-6;

/// Least |Im σ| of an oscillation, relative to |σ|: rounding gives a real rate a small imaginary part.
const OSCILLATES: f64 = 1e-3;

/// The largest growth rates along a branch, and its Hopf points.
pub(super) struct RatesAlong {
    rates: FollowedRates,
    /// The largest growth rate of every point, if it could be computed.
    pub found: Vec<Option<f64>>,
    /// The Hopf points.
    pub hopf: Vec<HopfPoint>,
    /// The last point, the number of folds and pitchforks before it, and its rate.
    before: Option<(Solution, usize, Leading)>,
}

impl RatesAlong {
    /// For shapes of a cell, with m stages per interval.
    pub fn new(cortex: &Cortex, stages: usize) -> RatesAlong {
        let rates = FollowedRates::new(cortex, stages);
        RatesAlong { rates, found: Vec::new(), hopf: Vec::new(), before: None }
    }

    /// Adds the next shape, after `passed` folds and pitchforks, and the Hopf point before it, if there is one.
    pub fn take_in(&mut self, y: Solution, passed: usize, shape: Shape) {
        let now = match shape {
            Shape::Point => self.rates.leading(&y, passed),
            Shape::Event => self.at_event(&y),
        };
        if let (Some((from, then, before)), Some(now)) = (&self.before, now)
            && *then == passed
        {
            let found = hopf_between(self.rates.cortex(), [from, &y], [before.rate, now.rate]);
            self.hopf.extend(found.map(|hopf| HopfPoint { point: ShapePoint { passed, ..hopf.point }, ..hopf }));
        }
        match shape {
            Shape::Point => self.found.push(now.map(|now| now.rate)),
            Shape::Event => {}
        }
        self.before = now.map(|now| (y, passed + usize::from(shape == Shape::Event), now));
    }

    /// The rightmost growth rate at a fold or a pitchfork, where another rate than the one that is 0 may have grown already.
    fn at_event(&self, y: &Solution) -> Option<Leading> {
        let Cortex { cell, domain, .. } = self.rates.cortex();
        let mut cortex = Cortex::new(cell, *domain, &[]);
        cortex.set(Parameter::XiS, y.scalars[XI]);
        let mut y = y.clone();
        y.scalars.truncate(SHAPE_SCALARS);
        Stability::new(y.m).rightmost(&cortex, &y).ok().map(|rate| Leading::of(&rate))
    }
}

/// The Hopf point between two shapes of a branch with these growth rates.
fn hopf_between(cortex: &Cortex, shapes: [&Solution; 2], [a, b]: [f64; 2]) -> Option<HopfPoint> {
    let is_near = |rate: f64| rate.abs() < MARGINAL;
    if (a < 0.0) == (b < 0.0) || is_near(a) || is_near(b) {
        return None;
    }
    let mut stability = Stability::new(shapes[1].m);
    let mut last = None;
    let (point, _) = crossing_of(cortex, shapes, [a, b], &mut |cortex, y| {
        last = stability.rightmost(cortex, y).ok().map(|rate| Leading::of(&rate));
        last.map(|last| last.rate)
    })?;
    // Beyond the point the pair may part into two real rates, so that only the point itself shows it.
    let Leading { rate, frequency } = last?;
    (frequency > OSCILLATES * rate.hypot(frequency)).then(|| HopfPoint { point, period: TAU / frequency, grows: b > a })
}

#[cfg(test)]
mod tests {
    use super::super::{BranchOptions, primary};
    use furrow_cell::{Cell, Law, Numerics};

    /// Isotropic tension that saturates with the concentration of a regulator: an odd pair of rates crosses 0 before the pitchfork, where
    /// the pair has parted into two real rates.
    #[test]
    fn an_oscillation_before_the_pitchfork_is_located() {
        let stress = "gain*xi_s*2*(1 + phi)^2/(1 + (1 + phi)^2)";
        let text = format!("Law(name: \"carried\", stress_uu: \"{stress}\", stress_phiphi: \"{stress}\")");
        let cue = "regulator:none,turnover=1,diffusion=1,activity=0".parse().unwrap();
        let cell = Cell::new(2.0).with_cue(cue).with_law(Law::parse(&text, "carried.ron").unwrap());
        let options = BranchOptions { xi: [0.0, 12.0], growth_rates: true, ..BranchOptions::default() };
        let branch = primary::follow(&cell, &Numerics::default(), &options, |_| true).unwrap();
        let (hopf, pitchfork) = (branch.hopf[0], branch.pitchforks().next().unwrap());
        assert!((hopf.point.xi_s - 9.56).abs() < 0.02 && hopf.grows, "{hopf:?}");
        assert!((hopf.period - 15.1).abs() < 1.0 && pitchfork.point.xi_s > hopf.point.xi_s, "{hopf:?}");
        // The paper's law loses stability at its pitchfork alone.
        let plain = primary::follow(&Cell::new(2.0), &Numerics::default(), &options, |_| true).unwrap();
        assert_eq!(plain.hopf, []);
    }
}
