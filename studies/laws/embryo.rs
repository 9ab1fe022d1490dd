//! What embryos do: the ring of one zygote, and χ over the size of the mother.

use std::collections::BTreeMap;

use super::{Fault, Row, SIZES};

/// Speed of the ring of one zygote of *C. elegans* between the shares [`SHARES`](super::SHARES) of its radius, in first radii a frame:
/// differences of the radii in github.com/renatkh/cytokinesis, 01Ring.csv, interpolated between frames.
pub const RING_SPEEDS: [f64; 4] = [0.104, 0.117, 0.120, 0.136];

/// Radius of the zygote, in L_h.
const ZYGOTE: f64 = 5.4;

/// χ of the divisions of one mother.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// The mother's name.
    pub mother: String,
    /// Her radius, in L_h, from the ratio of mean volumes to the zygote.
    pub r0: f64,
    /// Mean of χ over embryos.
    pub mean: f64,
    /// Its standard deviation.
    pub sd: f64,
    /// Whether she is of the germline, and has the cue.
    pub germline: bool,
}

/// Mothers down to R0 = 1.8: six wild-type embryos and eight controls of Jankele et al. 2021.
pub fn measured() -> Result<Vec<Measured>, Fault> {
    let mut volumes: BTreeMap<&str, [f64; 2]> = BTreeMap::new();
    for line in include_str!("../../data/jankele2021_volumes.csv").lines().skip(1) {
        let mut fields = line.split(',').skip(2);
        let (cell, volume) = fields.next().zip(fields.next()).ok_or("a line without a volume")?;
        let [sum, count] = volumes.entry(cell).or_default();
        *sum += volume.parse::<f64>()?;
        *count += 1.0;
    }
    let volume = |cell: &str| volumes.get(cell).map(|[sum, count]| sum / count);
    let zygote = volume("P0").ok_or("no volume of P0")?;
    let mut groups: BTreeMap<&str, Vec<[f64; 3]>> = BTreeMap::new();
    for line in include_str!("../../data/jankele2021.csv").lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        if let ["wt" | "ctrl", mother, n, mean, sd, ..] = fields[..]
            && let Ok(sd) = sd.parse()
        {
            groups.entry(mother).or_default().push([n.parse()?, mean.parse()?, sd]);
        }
    }
    let mut out = Vec::new();
    for (mother, groups) in groups {
        let Some(volume) = volume(mother) else { continue };
        let count: f64 = groups.iter().map(|[n, ..]| n).sum();
        let mean = groups.iter().map(|[n, mean, _]| n * mean).sum::<f64>() / count;
        let square = groups.iter().map(|[n, of, sd]| (n - 1.0) * sd * sd + n * (of - mean).powi(2)).sum::<f64>();
        let r0 = ZYGOTE * (volume / zygote).cbrt();
        if r0 >= SIZES[0] {
            let germline = mother.starts_with('P');
            out.push(Measured { mother: mother.to_owned(), r0, mean, sd: (square / (count - 1.0)).sqrt(), germline });
        }
    }
    out.sort_by(|a, b| b.germline.cmp(&a.germline).then(b.r0.total_cmp(&a.r0)));
    Ok(out)
}

/// χ at a size between those that were computed; `None` where one of them does not divide.
pub fn interpolated(rows: &[Row], r0: f64) -> Option<f64> {
    let k = SIZES.partition_point(|size| *size < r0).clamp(1, SIZES.len() - 1);
    let share = (r0 - SIZES[k - 1]) / (SIZES[k] - SIZES[k - 1]);
    let chi = rows[k - 1].chi + share * (rows[k].chi - rows[k - 1].chi);
    chi.is_finite().then_some(chi)
}
