//! Text for χ over the mother's volume: bins, trend, noise.

use std::fmt::Write;

use furrow_analysis::compare::noise::{Interval, NoiseBin, NoiseNull};
use furrow_analysis::compare::volumes::BinModel;
use furrow_analysis::compare::volumes_comparison::VolumesComparison;
use furrow_measured::statistics::{Line, RankCorrelation};
use furrow_measured::trend::{EmbryoTrend, VolumeTrend};
use furrow_measured::volumes::Unit;

use super::{ended, plus_minus, significance};

/// Bins of the volume, with their tests and the model's cells of the bins' mean sizes; empty without bins.
pub fn bins_text(found: &VolumesComparison) -> String {
    let VolumesComparison { unit, bins, tests, model_by_bin, model_by_bin_with_cues, .. } = found;
    if bins.is_empty() {
        return String::new();
    }
    let mut out = format!("χ by the mother's volume ({}), of all groups:\n", unit.map_or("", Unit::symbol));
    for (k, bin) in bins.iter().enumerate() {
        // A test of one division against another cannot be significant.
        let tested = k.checked_sub(1).filter(|above| bins[*above].n.max(bin.n) > 1);
        let test = tested.and_then(|k| tests.get(k)).map_or(String::new(), |test| {
            format!("  larger than above: U = {}, p = {:.3e} {}", test.test.u, test.test.p, test.stars)
        });
        let (name, sd) = (bin.name(), plus_minus(bin.sd, bin.n));
        let _ = writeln!(out, "  {name:<16} n = {:<5} χ = {:.3}{sd}{test}", bin.n, bin.mean);
    }
    let outside = found.divisions.saturating_sub(bins.iter().map(|bin| bin.n).sum());
    if outside > 0 {
        let _ = writeln!(out, "  divisions of mothers outside the bins: {outside}");
    }
    if !model_by_bin.is_empty() {
        out += &model_text("", model_by_bin);
    }
    model_by_bin_with_cues.iter().for_each(|(cue, bins)| out += &model_text(cue, bins));
    out + "\n"
}

/// The model's cells with one cue.
fn model_text(cue: &str, bins: &[BinModel]) -> String {
    let with = if cue.is_empty() { "without a cue".to_owned() } else { format!("with the cue {cue}") };
    let mut out = format!("Model, cells {with} as large as the mean mother of each bin:\n");
    for BinModel { bin, volume, model } in bins {
        let chi = if model.chi.is_some() { "χ = " } else { "" };
        let end = ended(model.chi, model.outcome);
        let _ = writeln!(out, "  {bin:<16} V = {volume:<8.0} R0 = {:<6.3} {chi}{end}", model.r0);
    }
    out
}

/// The trend over all divisions, and within embryos if there are several.
pub fn trend_text(trend: &VolumeTrend) -> String {
    let Some(line) = trend.line else { return String::new() };
    let Line { slope, slope_error, n, .. } = line;
    let mut out = format!(
        "Trend: χ changes by {slope:+.4} ± {slope_error:.4}{} per decade of volume ({n} divisions)",
        significance(&line)
    );
    if let Some(RankCorrelation { rho, p, .. }) = trend.spearman {
        let _ = write!(out, "; Spearman ρ = {rho:+.3}, p = {p:.3e}");
    }
    out.push('\n');
    if trend.embryos.len() > 1 {
        for EmbryoTrend { embryo, line } in trend.embryos.iter().take(MOST_EMBRYOS) {
            let _ = writeln!(out, "  embryo {embryo}: {:+.4} ± {:.4} ({})", line.slope, line.slope_error, line.n);
        }
    }
    if trend.repeats > 0 {
        let _ = writeln!(
            out,
            "  {} of the divisions repeat a cell of another embryo; the tests of bins and trend count them as independent, so that p is \
             too small where cells differ",
            trend.repeats
        );
    }
    out + "\n"
}

/// Largest number of embryos listed with their trend.
const MOST_EMBRYOS: usize = 20;

/// The trend that measurement noise produces if all divisions are equal.
pub fn noise_text(null: &NoiseNull) -> String {
    let mut out = format!(
        "Noise, estimated from the mother's own volume against that of her daughters together ({} divisions, {} draws of equal ones):\n",
        null.n, null.draws
    );
    for group in &null.groups {
        let (from, to, error) = (group.from, group.to, 100.0 * group.relative_error);
        let _ = writeln!(out, "  V from {from:.0} to {to:.0}: {error:.1} % of one volume");
    }
    for NoiseBin { bin, measured, null } in &null.bins {
        let made = null.map_or("-".to_owned(), interval);
        let _ = writeln!(out, "  {bin:<16} χ = {measured:.3}, of noise alone {made}");
    }
    let Interval { mean, low, high } = null.null_slope;
    let _ = writeln!(
        out,
        "  Trend {:+.4} per decade; of noise alone {mean:+.4} [{low:+.4}, {high:+.4}]: {:.0} % of it (p = {:.3})",
        null.measured.slope,
        100.0 * null.share,
        null.p
    );
    out + "  Growth and differences between embryos widen the spread too, so that the noise may be smaller.\n\n"
}

fn interval(Interval { mean, low, high }: Interval) -> String {
    format!("{mean:.3} [{low:.3}, {high:.3}]")
}
