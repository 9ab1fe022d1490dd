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

use std::collections::BTreeMap;

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
        .with_lifetimes(known_lifetimes(lineage))
}

/// Lifetimes that a lineage gives without a tree: of single cells, and of founders where they do not depend on sizes.
fn known_lifetimes(lineage: &Lineage) -> BTreeMap<String, f64> {
    let Some(clock) = &lineage.clock else { return BTreeMap::new() };
    let law = |(k, founder): (usize, &furrow_lineage::Founder)| {
        let law = lineage.lifetime_law(k).filter(|law| law.exponent == 0.0 && clock.tau_min.is_none())?;
        Some((founder.name.clone(), law.lifetime_min))
    };
    let mut known: BTreeMap<String, f64> = lineage.founders.iter().enumerate().filter_map(law).collect();
    known.extend(clock.lifetimes.iter().flatten().map(|(name, minutes)| (name.clone(), *minutes)));
    known
}
