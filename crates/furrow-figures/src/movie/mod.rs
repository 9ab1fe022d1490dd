//! A division as a moving picture: its surface, shaded, in its shell, with the cue and the active forces.
//!
//! | file | content |
//! |---|---|
//! | `scene` | the contents of a movie: surfaces, forces, title, legend |
//! | `division` | the division of a cell that keeps its axis, as a scene |
//! | `surface` | the division of a cell without axial symmetry, as a scene |
//! | `view` | the direction from which the cell is seen |
//! | `raster` | the surface in pixels |
//! | `light` | the light on the surface |
//! | `shell` | the shell as glass |
//! | `picture` | one frame |
//! | `palette` | pixels in 256 colours |
//! | `encode` | frames as GIF, animated PNG or animated SVG |

mod division;
mod encode;
mod light;
mod palette;
mod picture;
mod raster;
mod scene;
mod shell;
mod surface;
mod view;

pub use division::{Movie, even_times};
pub use encode::MovieFormat;
pub use scene::{Force, Scene};
pub use surface::SurfaceMovie;
