//! Measured embryos: volumes of named cells, size asymmetries of their divisions, statistics.
//!
//! | file | content |
//! |---|---|
//! | [`names`] | Sulston's names: a cell's mother and sister |
//! | [`volumes`], `layout`, `division_table` | tables of volumes: long tables, frames × cells, and divisions |
//! | [`tracked`] | cells followed over time: AceTree, StarryNite, TrackMate, MaMuT, Mastodon, napari, ultrack, GEFF |
//! | [`matching`] | matches cells with other names to the cells of a lineage |
//! | [`events`] | divisions with both daughters measured: χ by group and mother |
//! | [`per_embryo`], `pace`, `several` | numbers of single embryos; embryos beside each other; embryos of several tables |
//! | [`lifetimes`], `lifetime_table` | tables of lifetimes: over volume, which sister divides first, cells alive over time |
//! | [`trend`] | χ by decades of the mother's volume |
//! | [`dose`] | asymmetry of a division over the dose of a protein |
//! | [`published`] | means over published embryos |
//! | [`statistics`] | means, boxes, rank sums, straight lines |
//! | [`significance`] | p values of slopes, of differences of means and of orders |
//! | `contour` | outlines of cells, their furrows and overlaps (feature `contours`) |
//!
//! # Examples
//! χ of one division from a table of two cells:
//!
//! ```
//! use furrow_measured::events::{divisions, summaries};
//! use furrow_measured::volumes::{ReadOptions, Volumes};
//! let mut volumes = Volumes::default();
//! let table = "cell,volume,embryo\nAB,59,e1\nP1,41,e1\nAB,62,e2\nP1,38,e2\n";
//! volumes.read(table.as_bytes(), "table.csv", &ReadOptions::default())?;
//! let events = divisions(&volumes);
//! let p0 = &summaries(&events.divisions)[0].events[0];
//! assert_eq!((p0.mother.as_str(), p0.n), ("P0", 2));
//! assert!((p0.mean - 0.21).abs() < 1e-12);
//! # Ok::<(), furrow_input::InputError>(())
//! ```

mod cell_tables;
#[cfg(feature = "contours")]
pub mod contour;
mod division_table;
pub mod dose;
pub mod events;
mod layout;
mod lifetime_table;
pub mod lifetimes;
pub mod matching;
pub mod names;
mod pace;
pub mod per_embryo;
pub mod published;
mod several;
pub mod significance;
pub mod statistics;
pub mod tracked;
pub mod trend;
pub mod volumes;
