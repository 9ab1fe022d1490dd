//! The shifts at which the rightmost growth rates are computed, for all kinds of perturbations.

use furrow_bvp::Solution;
use furrow_spectra::Arnoldi;

use super::spectrum::{GrowthRate, Parity, Result, Spectrum, StabilityError};
use crate::cortex::Cortex;
use crate::cortex::equations::{M, PSI, R};

/// Growth rates further than this many shifts from the shift are left to other shifts.
pub(crate) const REACH: f64 = 50.0;

/// A regulator with weak diffusion and slow turnover has many modes of nearly the same rate, which only a shift of
/// similar size separates. If the first shift does not, it is reduced by this factor, at most [`MOST_NEARER`] times.
const NEARER: f64 = 1.0 / 16.0;
const MOST_NEARER: usize = 3;

/// Factor by which the Krylov space is enlarged where no shift separates the slow modes of a regulator, since nearer
/// shifts may miss all modes.
const LARGER: usize = 4;

/// Bounds on the growth rates of a shape before their computation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shifts {
    /// The scale of the cell's own rates, see [`shift_scale`].
    scale: f64,
    /// An upper bound of growth rates.
    fastest: f64,
    /// Whether a regulator may have slow modes that lie close together.
    regulated: bool,
}

impl Shifts {
    /// The bounds for a shape.
    pub(crate) fn of(cortex: &Cortex, y: &Solution) -> Shifts {
        Shifts { scale: shift_scale(cortex), fastest: fastest(cortex, y), regulated: cortex.is_regulated() }
    }

    /// The scale of the cell's own rates.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// The rightmost growth rates from two shifts, and from further ones if the shape has a narrow neck; `at_shift`
    /// computes the rates within reach of one shift.
    pub(crate) fn leading(
        &self,
        arnoldi: Arnoldi,
        mut at_shift: impl FnMut(f64, Arnoldi) -> Result<Spectrum>,
    ) -> Result<Spectrum> {
        let (near, mut spectrum) = self.within_reach(&mut at_shift, arnoldi)?;
        self.add_at(&mut at_shift, [8.0 * near, near], arnoldi, &mut spectrum)?;
        self.add_fast(&mut at_shift, 8.0 * near, arnoldi, &mut spectrum)?;
        Ok(spectrum)
    }

    /// The largest growth rate only, from one shift, and from further ones if the shape has a narrow neck.
    pub(crate) fn growth_rate(
        &self,
        arnoldi: Arnoldi,
        at_shift: impl FnMut(f64, Arnoldi) -> Result<Spectrum>,
    ) -> Result<f64> {
        self.rightmost(arnoldi, at_shift).map(|rate| rate.re)
    }

    /// The same with its imaginary part.
    pub(crate) fn rightmost(
        &self,
        arnoldi: Arnoldi,
        mut at_shift: impl FnMut(f64, Arnoldi) -> Result<Spectrum>,
    ) -> Result<GrowthRate> {
        let arnoldi = Arnoldi { wanted: 1, ..arnoldi };
        let (near, mut spectrum) = self.within_reach(&mut at_shift, arnoldi)?;
        self.add_fast(&mut at_shift, near, arnoldi, &mut spectrum)?;
        let none = GrowthRate { re: f64::NAN, im: 0.0, parity: Parity::Mixed, error: 0.0 };
        Ok(spectrum.values.first().copied().unwrap_or(none))
    }

    /// Adds modes too fast for `shift`: a neck pinches at a rate set by its own curvature, independent of the cell's
    /// size.
    fn add_fast(
        &self,
        at_shift: &mut impl FnMut(f64, Arnoldi) -> Result<Spectrum>,
        mut shift: f64,
        arnoldi: Arnoldi,
        spectrum: &mut Spectrum,
    ) -> Result<()> {
        while 0.5 * REACH * shift < self.fastest {
            shift *= 0.5 * REACH;
            self.add_at(at_shift, [shift; 2], arnoldi, spectrum)?;
        }
        Ok(())
    }

    /// Adds the modes within reach of another shift, with the tolerance `slack` for duplicates. A shift that is too far
    /// away to separate the slow modes of a regulator, and has no modes to the right of them, adds nothing.
    fn add_at(
        &self,
        at_shift: &mut impl FnMut(f64, Arnoldi) -> Result<Spectrum>,
        [shift, slack]: [f64; 2],
        arnoldi: Arnoldi,
        spectrum: &mut Spectrum,
    ) -> Result<()> {
        match at_shift(shift, arnoldi) {
            Err(StabilityError::NotConverged { value, error, .. })
                if self.regulated && value <= spectrum.growth_rate() + error => {}
            found => spectrum.add(found?, slack),
        }
        Ok(())
    }

    /// The smallest shift, from the scale of the cell upwards, within reach of any mode, and its modes.
    fn within_reach(
        &self,
        at_shift: &mut impl FnMut(f64, Arnoldi) -> Result<Spectrum>,
        arnoldi: Arnoldi,
    ) -> Result<(f64, Spectrum)> {
        let lie_close = |found: &Result<_>| self.regulated && matches!(found, Err(StabilityError::NotConverged { .. }));
        let larger = Arnoldi { max_dimension: LARGER * arnoldi.max_dimension, ..arnoldi };
        let mut shift = self.scale;
        let mut found = at_shift(shift, arnoldi);
        for _ in 0..MOST_NEARER {
            if lie_close(&found) {
                shift *= NEARER;
                found = at_shift(shift, arnoldi);
            }
        }
        loop {
            if lie_close(&found) {
                found = at_shift(shift, larger);
            }
            let spectrum = found?;
            // All modes decay faster than the shift can reach: no growing mode is missed, but the rates are not known yet.
            if !spectrum.values.is_empty() || shift >= 1e12 {
                return Ok((shift, spectrum));
            }
            shift *= 0.5 * REACH;
            found = at_shift(shift, arnoldi);
        }
    }
}

/// A positive rate of the order of the fastest slow mode: bending over the size of the cell against viscosity, plus the
/// largest contribution of activity.
pub(super) fn shift_scale(cortex: &Cortex) -> f64 {
    let (cell, material) = (&cortex.cell, &cortex.cell.material);
    let viscosity = material.eta_b + material.eta_s;
    let activity = material.gain * cell.xi_s;
    material.kappa / (viscosity * cell.r0 * cell.r0) + activity * activity / (16.0 * material.kappa * viscosity)
}

/// An upper bound of growth rates: bending and active stress at the largest curvature of the shape against viscosity.
fn fastest(cortex: &Cortex, y: &Solution) -> f64 {
    let (cell, material) = (&cortex.cell, &cortex.cell.material);
    let curvature = y.stages.chunks_exact(y.components).fold(0.0f64, |most, s| {
        let c2 = s[PSI].sin() / s[R];
        most.max(c2.abs()).max((s[M] / material.kappa + material.spontaneous_curvature - c2).abs())
    });
    let stress = material.kappa * curvature * curvature + material.gain * cell.xi_s.abs() * curvature;
    stress / (material.eta_b + material.eta_s)
}
