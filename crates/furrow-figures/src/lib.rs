//! The pictures of [furrow](https://docs.rs/furrow): charts of its commands' results, drawings and movies of dividing
//! cells.
//!
//! | module | content |
//! |---|---|
//! | [`drawing`] | one style, a canvas for SVG, PDF and PNG, axes, legends, cells |
//! | [`plot`] | a picture for each command |
//! | [`movie`] | a division as a moving picture |
//!
//! # Examples
//! A division as a chart, and as a small movie:
//!
//! ```
//! use furrow_figures::movie::{Movie, MovieFormat};
//! use furrow_figures::plot;
//! use furrow_cell::Cell;
//! use furrow_mechanics::division::{DivisionInput, Trajectory};
//! let cell = Cell::new(3.0);
//! let film = Trajectory::compute(&DivisionInput::new(cell.clone()))?;
//! assert!(plot::division::draw(&cell, &film).svg().starts_with("<svg"));
//! let movie = Movie { cell: &cell, film: &film, frames: 2 };
//! assert!(movie.bytes(MovieFormat::Gif)?.starts_with(b"GIF89a"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod drawing;
pub mod movie;
pub mod plot;
