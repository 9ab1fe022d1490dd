//! Units of a GEFF: of its axes, which may be scaled, and of sizes.

use furrow_input::InputError;
use furrow_input::table::{NamedUnit, unit_of, units_listed};
use serde_json::Value;

use super::lengths::{LENGTHS, LengthUnit, PIXELS, SizeUnit, length_unit, unit_of_pixels, voxel};
use super::times::{time_unit, times_listed};
use super::{TimeUnit, TrackOptions};
use crate::layout::VOLUMES;
use crate::volumes::Unit;

/// Scales of axes that differ by less are equal.
const SAME_SCALE: f64 = 1e-9;

/// The factor and the unit into which values of an axis are scaled, if they are.
fn scaled<'a>(axis: &'a Value, file: &str) -> Result<Option<(f64, &'a str)>, InputError> {
    let (scale, unit) = (&axis["scale"], axis["scaled_unit"].as_str());
    match (scale.as_f64(), unit) {
        (Some(scale), Some(unit)) if scale > 0.0 && scale.is_finite() => Ok(Some((scale, unit))),
        (Some(1.0), None) => Ok(None),
        (None, None) if scale.is_null() => Ok(None),
        (None, Some(unit)) if scale.is_null() && axis["unit"] == unit => Ok(None),
        _ => {
            let allowed = "a number above 0, given together with scaled_unit, or both left out";
            Err(InputError::not_allowed(file, format!("geff.axes.{}.scale", axis_name(axis)), scale, allowed))
        }
    }
}

fn axis_name(axis: &Value) -> &str {
    axis["name"].as_str().unwrap_or("?")
}

/// The minutes or frames in a unit of the axis of times. Where minutes of a frame are given, times in frames are not scaled.
pub(super) fn of_times(axis: &Value, file: &str, options: &TrackOptions) -> Result<(f64, TimeUnit), InputError> {
    let refused = |field: &str, value: &Value| {
        let allowed = format!("one of {}", times_listed());
        InputError::not_allowed(file, format!("geff.axes.{field}"), value, allowed)
    };
    let own = time_unit(axis["unit"].as_str().unwrap_or("frame"));
    let is_counted = options.frame_minutes.is_some() && own.is_some_and(|(_, kind)| kind == TimeUnit::Frames);
    match scaled(axis, file)?.filter(|_| !is_counted) {
        None => own.ok_or_else(|| refused("unit", &axis["unit"])),
        Some((scale, unit)) => {
            let (size, kind) = time_unit(unit).ok_or_else(|| refused("scaled_unit", &axis["scaled_unit"]))?;
            Ok((scale * size, kind))
        }
    }
}

/// The units of the axes of space after scaling; empty if they are not scaled.
fn of_space(axes: &[Value], file: &str) -> Result<Vec<LengthUnit>, InputError> {
    let mut found = Vec::new();
    for axis in axes.iter().filter(|axis| axis["type"] == "space") {
        let Some((scale, unit)) = scaled(axis, file)? else { continue };
        let unit = length_unit(unit).ok_or_else(|| {
            let allowed = format!("one of {}", units_listed(&LENGTHS));
            InputError::not_allowed(file, "geff.axes.scaled_unit", unit, allowed)
        })?;
        found.push(NamedUnit { size: scale * unit.size, ..unit });
    }
    Ok(found)
}

/// The unit of radii; by default the unit of the spatial axes. `None` if neither is given. Radii in pixels have the scale of the axes.
pub(super) fn of_radii(
    (property, own): (&str, &Value),
    axes: &[Value],
    file: &str,
    options: &TrackOptions,
) -> Result<Option<LengthUnit>, InputError> {
    let refused = |value: &str, allowed: String| {
        Err(InputError::not_allowed(file, format!("unit of {property}"), value.to_owned(), allowed))
    };
    let space = axes.iter().find(|axis| axis["type"] == "space").map_or(&Value::Null, |axis| &axis["unit"]);
    let said = if own.is_null() { space } else { own };
    let unit = match said.as_str().map(|text| (text, length_unit(text))) {
        None => None,
        Some((_, Some(unit))) => Some(unit),
        Some(_) if options.without_sizes => Some(PIXELS),
        Some((text, None)) => {
            return refused(text, format!("one of {}, or none (relative sizes)", units_listed(&LENGTHS)));
        }
    };
    let is_scaled = own.is_null() || unit.is_some_and(|unit| unit.kind == Unit::Voxels);
    if !is_scaled || options.without_sizes {
        return Ok(unit);
    }
    let scales = of_space(axes, file)?;
    let Some(first) = scales.first().copied() else { return Ok(unit) };
    let is_same =
        |other: &LengthUnit| other.kind == first.kind && (other.size - first.size).abs() <= SAME_SCALE * first.size;
    if !scales.iter().all(is_same) {
        let value = said.as_str().unwrap_or("none");
        return refused(value, "a unit of length that is not pixels, since the axes have different scales".to_owned());
    }
    Ok(Some(first))
}

/// The size of a unit of volumes, as `micrometer**3`, and the unit of the volumes. Voxels are scaled as the axes are.
pub(super) fn of_volumes(
    (property, own): (&str, &str),
    axes: &[Value],
    file: &str,
    options: &TrackOptions,
) -> Result<(f64, SizeUnit), InputError> {
    let cubic = || {
        let text = own.trim().strip_suffix(['3', '³'])?.trim_end_matches(['*', '^']);
        let unit = length_unit(text).filter(|_| !text.trim().is_empty())?;
        Some((unit.size.powi(3), unit.kind))
    };
    let known = unit_of(own, &VOLUMES).map(|unit| (unit.size, unit.kind)).or_else(cubic);
    let Some((size, kind)) = known.or(options.without_sizes.then_some((1.0, Unit::Voxels))) else {
        let allowed =
            format!("one of {}, or the third power of one of {}", units_listed(&VOLUMES), units_listed(&LENGTHS));
        return Err(InputError::not_allowed(file, format!("unit of {property}"), own, allowed));
    };
    if kind != Unit::Voxels {
        return Ok((size, kind.into()));
    }
    let scales = if options.without_sizes { Vec::new() } else { of_space(axes, file)? };
    match scales[..] {
        [x, y, z] if scales.iter().all(|unit| unit.kind != Unit::Voxels) => {
            Ok((x.size * y.size * z.size, Unit::CubicMicrometres.into()))
        }
        _ => Ok((voxel(options), unit_of_pixels(options))),
    }
}
