//! The model beside measured embryos.
//!
//! | file | what it says |
//! |---|---|
//! | [`volumes`] | χ of measured divisions beside the tree's, free and with the first division as measured |
//! | [`counts`] | rounds of founders beside the observed ones, by every reading and at every stage |

pub mod counts;
pub mod volumes;
