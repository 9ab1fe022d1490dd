//! Compares the model with measured embryos.
//!
//! | file | content |
//! |---|---|
//! | [`volumes`] | χ of measured divisions and of the tree, free or with the measured first division |
//! | [`lifetimes`] | lifetimes of cells, over volume and by which sister divides first |
//! | [`departure`] | when a tree with a clock leaves the embryo's |
//! | [`counts`] | rounds of founders, by every reading and at every stage |

pub mod counts;
pub mod departure;
pub mod lifetimes;
pub mod volumes;
