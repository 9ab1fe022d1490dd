//! Replaces the store in builds without the feature `store`.

use super::StoreWarning;
use crate::batch::Key;
use furrow_mechanics::critical::Archive;
use furrow_mechanics::division::{Division, DivisionInput};

/// The store of a build without the feature `store`; it has no values.
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

    /// Why the store is no longer used.
    pub fn given_up(&self) -> Option<StoreWarning> {
        match *self {}
    }

    pub(in crate::batch) fn take_warnings(&self) -> Vec<StoreWarning> {
        match *self {}
    }
}

impl Archive for Store {
    fn get(&self, _: &str) -> Option<String> {
        match *self {}
    }

    fn put(&self, _: &str, _: &str) {
        match *self {}
    }
}
