//! Compares the model with measured embryos.
//!
//! | file | content |
//! |---|---|
//! | [`volumes`] | χ of measured divisions and of the tree, free or with the measured first division |
//! | [`counts`] | rounds of founders, by every reading and at every stage |

pub mod counts;
pub mod volumes;
