//! A division as a moving picture: its surface, shaded, in its shell, with the cue and the active forces.
//!
//! | file | content |
//! |---|---|
//! | `surface` | the surface of revolution as facets, turned and projected |
//! | `picture` | one frame |
//! | `encode` | frames as GIF, animated PNG or animated SVG |

mod encode;
mod picture;
mod surface;

pub use encode::{Movie, MovieFormat};
