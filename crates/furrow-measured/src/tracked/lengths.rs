//! Units of lengths, and the volumes of spheres in them.

use furrow_input::InputError;
use furrow_input::table::{NamedUnit, unit_of};

use super::TrackOptions;
use crate::volumes::Unit;

/// A unit of lengths with the unit of volumes that follows: micrometres in it, or pixels.
pub(crate) type LengthUnit = NamedUnit<Unit>;

const fn length(size: f64, words: &'static [&'static str]) -> LengthUnit {
    NamedUnit { kind: Unit::CubicMicrometres, size, words }
}

/// Pixels, and lengths without a unit.
pub(super) const PIXELS: LengthUnit =
    NamedUnit { kind: Unit::Voxels, size: 1.0, words: &["pixel", "pixels", "px", "voxel", "voxels", ""] };

/// Units of lengths.
pub(super) const LENGTHS: [LengthUnit; 8] = [
    length(1.0, &["micron", "microns", "um", "micrometer", "micrometers", "micrometre", "micrometres"]),
    PIXELS,
    length(1e-3, &["nm", "nanometer", "nanometers", "nanometre", "nanometres"]),
    length(1e-4, &["angstrom", "angstroms", "å"]),
    length(1e3, &["mm", "millimeter", "millimeters", "millimetre", "millimetres"]),
    length(1e4, &["cm", "centimeter", "centimeters", "centimetre", "centimetres"]),
    length(1e6, &["m", "meter", "meters", "metre", "metres"]),
    length(25_400.0, &["inch", "inches", "in"]),
];

/// A unit of lengths by a text, which may be in brackets.
pub(crate) fn length_unit(text: &str) -> Option<LengthUnit> {
    unit_of(text.trim().trim_matches(['(', ')', '[', ']']), &LENGTHS).copied()
}

/// The unit of lengths by a text; an unknown one is refused where sizes are needed.
pub(super) fn known_length_unit(
    text: &str,
    options: &TrackOptions,
    refused: impl FnOnce() -> InputError,
) -> Result<LengthUnit, InputError> {
    length_unit(text).or(options.without_sizes.then_some(PIXELS)).ok_or_else(refused)
}

/// The volume of a sphere.
pub(super) fn sphere(diameter: f64) -> f64 {
    std::f64::consts::FRAC_PI_6 * diameter.powi(3)
}

/// The volume of a sphere from its diameter in a unit; of pixels in µm³ if a pixel's edge is known.
pub(super) fn sphere_in(unit: LengthUnit, diameter: f64, options: &TrackOptions) -> f64 {
    let pixel = options.pixel.filter(|_| unit.kind == Unit::Voxels).unwrap_or(1.0);
    sphere(diameter * unit.size * pixel)
}

/// The volume of a sphere from its diameter in pixels.
pub(super) fn sphere_of_pixels(diameter: f64, options: &TrackOptions) -> f64 {
    sphere(diameter * options.pixel.unwrap_or(1.0))
}

/// The unit of the volumes of a file, and what says so.
#[derive(Clone, Copy, Debug)]
pub(super) struct SizeUnit {
    pub unit: Unit,
    /// Whether sizes are in pixels or voxels, so that a pixel's edge says something of them.
    pub in_pixels: bool,
    /// Whether the file has volumes without a unit.
    pub is_bare: bool,
}

impl From<Unit> for SizeUnit {
    fn from(unit: Unit) -> SizeUnit {
        SizeUnit { unit, in_pixels: false, is_bare: false }
    }
}

/// The unit of volumes from lengths in a unit.
pub(super) fn unit_of_spheres(unit: LengthUnit, options: &TrackOptions) -> SizeUnit {
    if unit.kind == Unit::Voxels { unit_of_pixels(options) } else { unit.kind.into() }
}

/// The unit of volumes from sizes in pixels.
pub(super) fn unit_of_pixels(options: &TrackOptions) -> SizeUnit {
    let unit = if options.pixel.is_some() { Unit::CubicMicrometres } else { Unit::Voxels };
    SizeUnit { unit, in_pixels: true, is_bare: false }
}

/// The unit of volumes without a unit, and its size: the given unit, or else the usual one of the format.
pub(super) fn unit_of_bare(usual: Unit, options: &TrackOptions) -> (f64, SizeUnit) {
    match options.unit.unwrap_or(usual) {
        Unit::Voxels => (voxel(options), SizeUnit { is_bare: true, ..unit_of_pixels(options) }),
        unit => (1.0, SizeUnit { unit, in_pixels: false, is_bare: true }),
    }
}

/// The volume of a voxel, 1 if unknown.
pub(super) fn voxel(options: &TrackOptions) -> f64 {
    options.pixel.map_or(1.0, |pixel| pixel.powi(3))
}
