//! Without the feature `store` there is none.

use super::StoreWarning;
use crate::batch::Key;
use furrow_mechanics::division::{Division, DivisionInput};

/// No store: this build has none.
#[derive(Debug)]
pub enum Store {}

impl Store {
    pub(in crate::batch) fn get(&self, _: &Key) -> Option<Division> {
        match *self {}
    }

    pub(in crate::batch) fn commit(&self, _: &Key, _: &DivisionInput, _: &Division) {
        match *self {}
    }

    pub(in crate::batch) fn damaged(&self) -> usize {
        match *self {}
    }

    pub(in crate::batch) fn take_warnings(&self) -> Vec<StoreWarning> {
        match *self {}
    }
}
