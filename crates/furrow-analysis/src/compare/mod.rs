//! Compares the model with measured embryos.
//!
//! | file | content |
//! |---|---|
//! | [`volumes`] | χ of measured divisions and of the tree, free or with the measured first division |
//! | [`volumes_comparison`] | the whole comparison of measured volumes |
//! | [`lifetimes`] | lifetimes of cells, over volume and by which sister divides first |
//! | [`departure`] | when a tree with a clock leaves the embryo's |
//! | [`dose`] | asymmetry over the dose of a protein, beside the model's over the strength of its cue |
//! | [`noise`] | how much of a trend over size noise makes |
//! | [`counts`] | rounds of founders, by every reading and at every stage |

pub mod counts;
pub mod departure;
pub mod dose;
pub mod lifetimes;
pub mod noise;
pub mod volumes;
pub mod volumes_comparison;

use furrow_lineage::{Daughter, Lineage};
use furrow_measured::names::{NamedFounder, Names};

/// The names that a lineage gives its cells.
pub fn names_of(lineage: &Lineage) -> Names {
    let founder = |(k, founder): (usize, &furrow_lineage::Founder)| NamedFounder {
        name: founder.name.clone(),
        mother: lineage.mother(k),
        is_smaller: founder.daughter == Some(Daughter::Smaller),
        letters: founder.letters.clone(),
    };
    Names::of(lineage.founders.iter().enumerate().map(founder).collect(), lineage.naming)
}
