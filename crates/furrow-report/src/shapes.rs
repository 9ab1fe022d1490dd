//! Records of stationary shapes, folds, pitchforks and the checks of a division, with the keys used in files, in `--json` and in Python.
//!
//! Lengths are in L_h, p in κ0/L_h³, activities in κ0/L_h, growth rates in 1/τ. H is the elongation in units of R0, L
//! the length of the contour.

use serde_json::{Value, json};

use furrow_analysis::json::{filled, merged};
use furrow_cell::Numerics;
use furrow_lineage::batch::checks::{Effects, MeshEffect, NoiseEffect, Settled};
use furrow_mechanics::azimuthal::mode::Mode;
use furrow_mechanics::division::Division;
use furrow_mechanics::equilibria::azimuthal_scan::Crossing;
use furrow_mechanics::equilibria::{BranchEvent, HopfPoint, Pitchfork, StationaryShape};
use furrow_mechanics::stability::{GrowthRate, Spectrum, StabilityError};

/// A stationary shape and its stability: its rightmost growth rates with the parity of their modes, the activities of
/// the folds that the branch passed on its way here, and, with a regulator, φ at u = ½ and at u = 0.
pub fn stationary_report(shape: &StationaryShape, spectrum: &Spectrum, growth_rate_error: f64) -> Value {
    let rate = |v: &GrowthRate| json!({ "re": v.re, "im": v.im, "parity": format!("{:?}", v.parity).to_lowercase() });
    let [reduced_volume, bending_energy] = shape.reduced_volume_and_bending();
    let mut report = json!({
        "L": shape.length(),
        "p": shape.pressure(),
        "H": shape.elongation(),
        "r_eq": shape.equator_radius(),
        "reduced_volume": reduced_volume,
        "bending_energy": bending_energy,
        "stable": spectrum.is_stable(),
        "growth_rate": spectrum.growth_rate(),
        "growth_rate_uncertainty": growth_rate_error,
        "growth_rates": spectrum.values.iter().map(rate).collect::<Vec<_>>(),
        "folds_passed": shape.folds,
    });
    if let (Some(middle), Some(pole)) = (shape.regulator_at(0.5), shape.regulator_at(0.0)) {
        report["regulator"] = json!({ "phi_mid": middle, "phi_pole": pole });
    }
    report
}

/// Stability of a stationary shape to perturbations of azimuthal number m.
pub struct AzimuthalStability {
    /// The azimuthal number.
    pub m: usize,
    /// The rightmost growth rates.
    pub spectrum: Spectrum,
    /// The leading mode; `None` for m = 0.
    pub mode: Option<Mode>,
}

impl AzimuthalStability {
    /// Of perturbations up to m = `most`; those of m = 0 have the given growth rates.
    ///
    /// # Errors
    /// Growth rates cannot be computed.
    pub fn up_to(
        most: usize,
        shape: &StationaryShape,
        axisymmetric: &Spectrum,
    ) -> Result<Vec<AzimuthalStability>, StabilityError> {
        let mut found = vec![AzimuthalStability { m: 0, spectrum: axisymmetric.clone(), mode: None }];
        for m in 1..=most {
            let mut perturbations = shape.azimuthal(m);
            let spectrum = perturbations.leading()?;
            let mode = perturbations.mode(spectrum.growth_rate())?;
            found.push(AzimuthalStability { m, spectrum, mode: Some(mode) });
        }
        Ok(found)
    }

    /// The growth rates, the parity of the leading mode and, for m = 1, the shares of the mode that shift and tilt the whole cell.
    pub fn report(&self) -> Value {
        let rate = |v: &GrowthRate| json!({ "re": v.re, "im": v.im });
        let mut report = json!({
            "m": self.m,
            "growth_rate": self.spectrum.growth_rate(),
            "growth_rates": self.spectrum.values.iter().map(rate).collect::<Vec<_>>(),
        });
        if let Some(mode) = &self.mode {
            report["parity"] = format!("{:?}", mode.parity()).to_lowercase().into();
            if let Some(rigid) = mode.rigid() {
                report["rigid"] = json!({ "translation": rigid.translation, "rotation": rigid.rotation });
            }
        }
        report
    }
}

/// A single pitchfork. `coefficient` is c of ξ_s = ξ_s* + c (u_furrow − ½)² along the asymmetric branch; `residual` is
/// the size of the last Newton correction.
pub fn threshold_report(found: &Pitchfork) -> Value {
    let (point, newton) = (&found.point, &found.report);
    let mut report = json!({
        "xi_s": point.xi_s, "criticality": found.criticality(), "coefficient": found.coefficient,
        "H": point.elongation, "L": point.length, "p": point.pressure,
        "residual": newton.correction, "iterations": newton.iterations,
    });
    if let Some(fold) = found.beyond_fold {
        report["beyond_fold"] = json!(fold);
    }
    report
}

/// The effects of the noise and of the mesh on a division, with the divisions that it was compared with.
pub fn checks_report(Effects { settled, noise, mesh }: &Effects) -> Value {
    let of = |one: &Division| json!({ "outcome": one.outcome(), "chi": one.chi(), "u_furrow": one.u_furrow() });
    let on = |mesh: &Numerics| json!({ "intervals": mesh.intervals, "time_tolerance": mesh.time_tolerance });
    let with_seed = |seed: u64, one: &Division| merged(json!({ "seed": seed }), of(one));
    let mut report = json!({});
    if let Some(Settled { check, other, chi_apart }) = settled {
        report["depends_on_noise"] = json!(false);
        report["other_seed"] = filled(merged(with_seed(check.seed, other), on(&check.numerics)));
        report["depends_on_mesh"] = json!(false);
        report["chi_uncertainty"] = json!(chi_apart);
    }
    if let Some(NoiseEffect { seed, other, decides }) = noise {
        report["depends_on_noise"] = json!(decides);
        report["other_seed"] = filled(with_seed(*seed, other));
    }
    if let Some(MeshEffect { finer, other, decides, chi_apart }) = mesh {
        let there = other.as_ref().map_or_else(|failure| json!({ "why": failure.to_string() }), of);
        report["depends_on_mesh"] = json!(decides);
        report["chi_uncertainty"] = json!(chi_apart);
        report["twice_the_mesh"] = filled(merged(on(finer), there));
    }
    report
}

/// A fold or a pitchfork on the named branch. A pitchfork has its criticality and coefficient; a fold says whether ξ_s
/// has a maximum there along the branch.
pub fn event_report(branch: &str, event: &BranchEvent) -> Value {
    let point = event.point();
    let mut report = json!({
        "kind": event.kind(), "branch": branch, "xi_s": point.xi_s, "H": point.elongation, "L": point.length,
        "error": event.error(),
    });
    if let Some(pitchfork) = event.pitchfork() {
        report["criticality"] = json!(pitchfork.criticality());
        report["coefficient"] = json!(pitchfork.coefficient);
    }
    if let Some(fold) = event.fold() {
        report["maximum"] = json!(fold.maximum);
    }
    report
}

/// A point on the named branch where shapes begin to oscillate or cease to, with the period in τ, and whether oscillations grow beyond it
/// along the branch.
pub fn hopf_report(branch: &str, HopfPoint { point, period, grows }: &HopfPoint) -> Value {
    json!({
        "branch": branch, "xi_s": point.xi_s, "H": point.elongation, "period": period, "grows_beyond": grows,
    })
}

/// A point on the named branch where the growth rate of perturbations ∝ cos mφ changes sign, and whether they grow
/// beyond it along the branch.
pub fn crossing_report(branch: &str, Crossing { m, point, grows }: &Crossing) -> Value {
    json!({ "branch": branch, "m": m, "xi_s": point.xi_s, "H": point.elongation, "grows_beyond": grows })
}
