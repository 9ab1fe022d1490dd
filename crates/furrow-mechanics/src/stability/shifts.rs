//! From which shifts the rightmost growth rates are looked for, whatever the disturbances are.

use furrow_bvp::Solution;

use super::spectrum::{Result, Spectrum, StabilityError};
use crate::cortex::Cortex;
use crate::cortex::equations::{M, PSI, R};

/// Growth rates further than this many shifts from the shift are left to other shifts.
pub(crate) const REACH: f64 = 50.0;

/// A regulator that hardly spreads and turns over slowly has many modes of nearly one rate, which only a shift as small as they tells
/// apart: where the first shift does not, it is made smaller by this factor so many times.
const NEARER: f64 = 1.0 / 16.0;
const MOST_NEARER: usize = 3;

/// What is known of the growth rates of a shape before any is computed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shifts {
    /// The scale of the cell's own pace, see [`shift_scale`].
    scale: f64,
    /// A bound of growth rates.
    fastest: f64,
    /// Whether a regulator may have slow modes that lie close together.
    regulated: bool,
}

impl Shifts {
    /// Those of a shape.
    pub(crate) fn of(cortex: &Cortex, y: &Solution) -> Shifts {
        Shifts { scale: shift_scale(cortex), fastest: fastest(cortex, y), regulated: cortex.is_regulated() }
    }

    /// The scale of the cell's own pace.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// The `wanted` rightmost growth rates from two shifts, and from more where the shape has a narrow neck; `at_shift` computes
    /// those that one shift can see.
    pub(crate) fn leading(
        &self,
        wanted: usize,
        mut at_shift: impl FnMut(f64, usize) -> Result<Spectrum>,
    ) -> Result<Spectrum> {
        let (near, mut spectrum) = self.within_reach(&mut at_shift, wanted)?;
        self.add_at(&mut at_shift, [8.0 * near, near], wanted, &mut spectrum)?;
        self.add_fast(&mut at_shift, 8.0 * near, wanted, &mut spectrum)?;
        Ok(spectrum)
    }

    /// The largest growth rate only, from one shift, and from more where the shape has a narrow neck.
    pub(crate) fn growth_rate(&self, mut at_shift: impl FnMut(f64, usize) -> Result<Spectrum>) -> Result<f64> {
        let (near, mut spectrum) = self.within_reach(&mut at_shift, 1)?;
        self.add_fast(&mut at_shift, near, 1, &mut spectrum)?;
        Ok(spectrum.growth_rate())
    }

    /// Modes too fast for `shift` to see: a neck pinches at the rate its own curvature sets, whatever the cell's size.
    fn add_fast(
        &self,
        at_shift: &mut impl FnMut(f64, usize) -> Result<Spectrum>,
        mut shift: f64,
        wanted: usize,
        spectrum: &mut Spectrum,
    ) -> Result<()> {
        while 0.5 * REACH * shift < self.fastest {
            shift *= 0.5 * REACH;
            self.add_at(at_shift, [shift; 2], wanted, spectrum)?;
        }
        Ok(())
    }

    /// Adds what a further shift sees, known to about `slack`. One that is too far to tell the slow modes of a regulator apart, and
    /// sees nothing to the right of them, adds nothing.
    fn add_at(
        &self,
        at_shift: &mut impl FnMut(f64, usize) -> Result<Spectrum>,
        [shift, slack]: [f64; 2],
        wanted: usize,
        spectrum: &mut Spectrum,
    ) -> Result<()> {
        match at_shift(shift, wanted) {
            Err(StabilityError::NotConverged { value, error, .. })
                if self.regulated && value <= spectrum.growth_rate() + error => {}
            found => spectrum.add(found?, slack),
        }
        Ok(())
    }

    /// The smallest shift, from the scale of the cell upwards, that sees any mode, and what it sees.
    fn within_reach(
        &self,
        at_shift: &mut impl FnMut(f64, usize) -> Result<Spectrum>,
        wanted: usize,
    ) -> Result<(f64, Spectrum)> {
        let mut shift = self.scale;
        let mut found = at_shift(shift, wanted);
        for _ in 0..MOST_NEARER {
            if self.regulated && matches!(found, Err(StabilityError::NotConverged { .. })) {
                shift *= NEARER;
                found = at_shift(shift, wanted);
            }
        }
        let mut spectrum = found?;
        // Every mode decays faster than the shift can see: none is missed, but none is known.
        while spectrum.values.is_empty() && shift < 1e12 {
            shift *= 0.5 * REACH;
            spectrum = at_shift(shift, wanted)?;
        }
        Ok((shift, spectrum))
    }
}

/// A positive rate of the order of the fastest slow mode: bending over the size of the cell against viscosity, plus what
/// the activity can add.
pub(super) fn shift_scale(cortex: &Cortex) -> f64 {
    let (cell, material) = (&cortex.cell, &cortex.cell.material);
    let viscosity = material.eta_b + material.eta_s;
    let activity = material.gain * cell.xi_s;
    material.kappa / (viscosity * cell.r0 * cell.r0) + activity * activity / (16.0 * material.kappa * viscosity)
}

/// A bound of growth rates: bending and active stress at the largest curvature of the shape against viscosity.
fn fastest(cortex: &Cortex, y: &Solution) -> f64 {
    let (cell, material) = (&cortex.cell, &cortex.cell.material);
    let curvature = y.stages.chunks_exact(y.components).fold(0.0f64, |most, s| {
        let c2 = s[PSI].sin() / s[R];
        most.max(c2.abs()).max((s[M] / material.kappa - c2).abs())
    });
    let stress = material.kappa * curvature * curvature + material.gain * cell.xi_s.abs() * curvature;
    stress / (material.eta_b + material.eta_s)
}
