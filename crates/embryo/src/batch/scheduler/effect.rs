//! The effect of rounding sizes, estimated from how records change with the size of their tasks.

use std::collections::hash_map::Entry;

use crate::batch::{
    key::{Key, KeyMap},
    memo::Memo,
    task::{Record, Task},
};

/// Responses of one run's records, over the sizes of their tasks.
#[derive(Debug, Default)]
pub struct Responses(KeyMap<Sample>);

#[derive(Clone, Copy, Debug)]
struct Sample {
    /// Key of the same task without its size.
    family: Key,
    size: f64,
    response: f64,
}

impl Responses {
    /// Notes the response of a canonical task's record.
    pub fn note<T: Task>(&mut self, memo: &Memo<T>, key: Key, canonical: &T, record: &T::Record) {
        if let Some(response) = record.response()
            && let Entry::Vacant(vacant) = self.0.entry(key)
        {
            let family = memo.key(&canonical.with_size(0.0));
            vacant.insert(Sample { family, size: canonical.size(), response });
        }
    }

    /// Largest |Δresponse/Δln size| between neighbouring sizes of one family; 0 if there are none.
    pub fn steepest_slope(self) -> f64 {
        let mut samples: Vec<Sample> = self.0.into_values().collect();
        samples.sort_by(|a, b| a.family.cmp(&b.family).then_with(|| a.size.total_cmp(&b.size)));
        samples
            .windows(2)
            .filter(|pair| pair[0].family == pair[1].family && pair[0].size < pair[1].size)
            .map(|pair| ((pair[1].response - pair[0].response) / (pair[1].size / pair[0].size).ln()).abs())
            .fold(0.0, f64::max)
    }
}
