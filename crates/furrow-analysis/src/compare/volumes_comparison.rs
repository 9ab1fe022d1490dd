//! The whole comparison of measured volumes with the model, with the keys of its JSON.

use super::noise::{NoiseNull, noise_null};
use super::volumes::{
    BinModel, Cells, GroupComparison, Regression, Scale, ScaleFrom, add_bands, compare_groups, model, model_by_bin,
    scale,
};
use crate::constants::Constants;
use furrow_input::InputError;
use furrow_lineage::batch::Memo;
use furrow_lineage::batch::scheduler::{SchedulerError, SchedulerOptions};
use furrow_lineage::{GrowError, Lineage, Tree, TreeSettings};
use furrow_measured::events::{Division, Divisions, GroupSummary, HalfSeen, divisions, summaries};
use furrow_measured::matching::Matched;
use furrow_measured::trend::{AdjacentTest, VolumeBin, VolumeTrend, adjacent_tests, volume_bins, volume_trend};
use furrow_measured::volumes::{EmbryoSize, Skipped, Unit, Volumes};
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

/// Measured volumes and the divisions among them.
#[derive(Clone, Debug)]
pub struct MeasuredVolumes {
    /// What published means are from.
    pub source: Option<&'static str>,
    /// The volumes; empty for published means.
    pub volumes: Volumes,
    /// The divisions; empty for published means.
    pub divisions: Divisions,
    /// Their means.
    pub groups: Vec<GroupSummary>,
}

impl MeasuredVolumes {
    /// Published means of a source.
    pub fn published(source: &'static str, groups: Vec<GroupSummary>) -> MeasuredVolumes {
        let (volumes, divisions) = (Volumes::default(), Divisions::default());
        MeasuredVolumes { source: Some(source), volumes, divisions, groups }
    }

    /// The divisions of tables; if populations are named, of these alone. `option` is what named them.
    ///
    /// # Errors
    /// A population that the tables lack.
    pub fn of(
        volumes: Volumes,
        (option, populations): (&str, Option<&[String]>),
    ) -> Result<MeasuredVolumes, InputError> {
        let mut divisions = divisions(&volumes);
        if let Some(wanted) = populations {
            divisions.keep_populations(option, wanted)?;
        }
        let groups = summaries(&divisions.divisions);
        Ok(MeasuredVolumes { source: None, volumes, divisions, groups })
    }

    /// The divisions with sizes of their mothers, which a table of χ lacks.
    pub fn sized(&self) -> &[Division] {
        if self.has_sizes() { &self.divisions.divisions } else { &[] }
    }

    fn has_sizes(&self) -> bool {
        self.volumes.unit != Some(Unit::OfMother)
    }
}

/// Choice of one L_h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LengthScale {
    /// By the lineage's units if volumes are in µm³, else by P0, else by all mothers.
    Usual,
    /// A given length.
    Given(f64),
    /// By all mothers.
    Fitted,
}

/// The model's side of a comparison.
pub struct VolumesModel<'a> {
    /// The lineage.
    pub lineage: &'a Lineage,
    /// Whether cells of the sizes of bins also get the cues of the lineage.
    pub own_cues: bool,
    /// The parameters of its divisions.
    pub settings: &'a TreeSettings,
    /// Sets of constants, over which the model's χ get ranges.
    pub constants: &'a [Constants],
    /// One L_h.
    pub length_scale: LengthScale,
    /// Solved divisions.
    pub memo: &'a Memo,
    /// How divisions of cells of the sizes of bins are scheduled.
    pub options: &'a SchedulerOptions<'a>,
    /// Stops trees over sets of constants.
    pub cancel: &'a AtomicBool,
}

/// Measured volumes beside the model.
#[derive(Clone, Debug, Serialize)]
pub struct VolumesComparison {
    /// What published means are from.
    pub source: Option<&'static str>,
    /// χ by group and mother.
    pub groups: Vec<GroupComparison>,
    /// Number of volumes used.
    pub used: u64,
    /// The first volumes that are not used.
    pub skipped: Vec<Skipped>,
    /// Number of volumes that are not used.
    pub skipped_count: u64,
    /// Each embryo beside the others; empty for published means and tables of divisions.
    pub embryos: Vec<EmbryoSize>,
    /// How the cells of embryos that were followed were matched to the lineage.
    pub matched: Vec<Matched>,
    /// Number of divisions with both daughters.
    pub divisions: usize,
    /// Divisions with one daughter.
    pub half_seen: Vec<HalfSeen>,
    /// Unit of the volumes.
    pub unit: Option<Unit>,
    /// One L_h in the cube root of the unit.
    pub length_scale: Option<Scale>,
    /// One L_h in µm.
    pub length_scale_um: Option<f64>,
    /// Sets of constants over which the model's χ have ranges.
    pub members: Option<usize>,
    /// χ by the mother's volume, of all groups.
    pub bins: Vec<VolumeBin>,
    /// Tests of adjacent bins.
    pub tests: Vec<AdjacentTest>,
    /// χ over the mother's volume.
    pub trend: VolumeTrend,
    /// What noise makes of equal divisions.
    pub noise: Option<NoiseNull>,
    /// The model's cells of the sizes of the bins, without a cue.
    pub model_by_bin: Vec<BinModel>,
    /// The same with the cues of the lineage, by their names.
    pub model_by_bin_with_cues: BTreeMap<String, Vec<BinModel>>,
    /// Regressions between the χ of two groups.
    pub regressions: Vec<Regression>,
}

impl VolumesComparison {
    /// Compares measured volumes, in bins with these edges, with trees that `grow` grows. `regress` chooses groups for a regression.
    ///
    /// # Errors
    /// Errors of `grow` and `regress`; a division or a tree that cannot be computed.
    pub fn of<E: From<GrowError> + From<SchedulerError>>(
        measured: &MeasuredVolumes,
        edges: Option<&[f64]>,
        of_model: &VolumesModel<'_>,
        grow: impl FnOnce(Vec<Lineage>) -> Result<Vec<Tree>, E>,
        regress: impl FnOnce(&[GroupComparison]) -> Result<Vec<Regression>, E>,
    ) -> Result<VolumesComparison, E> {
        let VolumesModel { lineage, settings, constants, memo, options, cancel, .. } = *of_model;
        let Volumes { unit, used, ref skipped, skipped_count, ref divisions, .. } = measured.volumes;
        let (free, firsts) = model(lineage, settings.cell.r0, &measured.groups, grow)?;
        let all = &measured.divisions.divisions;
        let mut groups = compare_groups(measured.groups.clone(), all, &free, &firsts, edges);
        add_bands(&mut groups, &free, lineage, settings, constants, options.threads, cancel)?;
        if !measured.has_sizes() {
            groups.iter_mut().for_each(GroupComparison::without_sizes);
        }
        let bins = volume_bins(measured.sized(), edges);
        let length_scale = of_model.scale(measured, &free);
        // Mothers without Sulston's names have no cell in the tree; one of their size is beside them.
        let by_size = length_scale.filter(|_| !divisions.is_empty() && measured.has_sizes());
        let own_cues = of_model.own_cues.then_some(&lineage.cues);
        let by_cue = by_size.map(|scale| model_by_bin(settings, own_cues, &bins, scale.length, memo, options));
        let mut by_cue = by_cue.transpose()?.into_iter().flatten();
        Ok(VolumesComparison {
            source: measured.source,
            used,
            skipped: skipped.clone(),
            skipped_count,
            embryos: sizes_with(measured, length_scale),
            matched: measured.volumes.matched.clone(),
            divisions: all.len(),
            half_seen: measured.divisions.half_seen.clone(),
            unit,
            length_scale,
            length_scale_um: length_scale.filter(|_| unit == Some(Unit::CubicMicrometres)).map(|scale| scale.length),
            members: (!constants.is_empty()).then_some(constants.len()),
            tests: adjacent_tests(&bins),
            trend: trend_of(measured),
            noise: noise_null(measured.sized(), &bins),
            model_by_bin: by_cue.next().map_or(Vec::new(), |(_, bins)| bins),
            model_by_bin_with_cues: by_cue.collect(),
            regressions: regress(&groups)?,
            groups,
            bins,
        })
    }
}

/// χ over the mother's volume. Mothers of populations are numbered in each embryo.
fn trend_of(measured: &MeasuredVolumes) -> VolumeTrend {
    let trend = volume_trend(measured.sized());
    VolumeTrend { repeats: if measured.volumes.of_populations { 0 } else { trend.repeats }, ..trend }
}

/// Each embryo beside the others, with one L_h in it.
fn sizes_with(measured: &MeasuredVolumes, scale: Option<Scale>) -> Vec<EmbryoSize> {
    let mut sizes = measured.volumes.sizes();
    for size in &mut sizes {
        size.length_scale = scale.zip(size.size_factor).map(|(scale, factor)| scale.length * factor.cbrt());
    }
    sizes
}

impl VolumesModel<'_> {
    fn scale(&self, measured: &MeasuredVolumes, cells: &Cells) -> Option<Scale> {
        let in_um = measured.volumes.unit == Some(Unit::CubicMicrometres);
        let of_lineage = self.lineage.units().length_um.filter(|_| in_um);
        match (self.length_scale, of_lineage) {
            (LengthScale::Given(length), _) => Some(Scale { length, from: ScaleFrom::Given }),
            (LengthScale::Fitted, _) => scale(measured.sized(), cells, false),
            (LengthScale::Usual, Some(length)) => Some(Scale { length, from: ScaleFrom::Lineage }),
            (LengthScale::Usual, None) => scale(measured.sized(), cells, true),
        }
    }
}
