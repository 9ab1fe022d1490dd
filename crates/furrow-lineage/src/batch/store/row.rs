//! A division as a row: its input and outcome in named columns, and a checksum over them.

use furrow_bvp::Work;
use rusqlite::types::{Value, ValueRef};

use crate::batch::key::{Key, numbers};
use furrow_cell::{Cell, Material, Shell};
use furrow_mechanics::division::{Division, DivisionInput, DivisionRow, Outcome, SecondNeck};

/// The columns. No column has a declared type: in a column of reals SQLite would store −0 as 0.
pub const COLUMNS: &str = "key, solver, \
    r0, epsilon, xi_s, cue, seed, kappa, eta_b, eta_s, friction, tension, xi_ratio, gain, rigidity_gradient, aspect, p0, w, shell_flattening, \
    stages, intervals, modes, elements, contact, scheme, dt, first_step, time_tolerance, step_factor, t_max, noise, noise_time, chi_symmetric, \
    outcome, chi, chi_signed, u_furrow, t_end, first_r0, second_r0, growth_rate, slow_growth_rate, phi, neck_offset, \
    second_neck_u, second_neck_radius, second_neck_share, volume_drift, \
    steps, rejected, newton_iterations, factorisations, remeshings, checksum";

/// Number of columns.
pub const WIDTH: usize = 54;

/// Index of the first column of the outcome.
const OUTCOME: usize = 33;

/// The values of all columns, in their order.
pub fn encode(key: &Key, solver: u32, input: &DivisionInput, division: &Division) -> Vec<Value> {
    // There is no `..`, so that a new field is a compile error until it has a column.
    let DivisionInput { cell, numerics, seed } = input;
    let Cell { r0, epsilon, xi_s, cue: _, material, shell, law, shell_profile } = cell;
    let Material {
        kappa,
        eta_b,
        eta_s,
        friction,
        tension,
        xi_ratio,
        gain,
        rigidity_gradient,
        spontaneous_curvature,
        normal_friction,
    } = *material;
    let Shell { aspect, p0, w, flattening } = *shell;
    let (counts, scheme, numerics) = numbers(numerics);
    let DivisionRow {
        outcome,
        chi,
        chi_signed,
        u_furrow,
        t_end,
        daughters,
        growth_rate,
        slow_growth_rate,
        phi,
        neck_offset,
        second_neck,
        volume_drift,
        work: Work { steps, rejected, iterations, factorisations, remeshings },
    } = division.clone().into();
    let count = |value: usize| Value::Integer(value as i64);

    let mut row = Vec::with_capacity(WIDTH);
    row.extend([Value::Blob(key.as_bytes().to_vec()), Value::Integer(solver.into())]);
    row.extend([*r0, *epsilon, *xi_s].map(Value::Real));
    // The law, the shell's profile, spontaneous curvature and normal friction share the column of the cue, because a new column would
    // invalidate existing tables.
    let added = [("spontaneous_curvature", spontaneous_curvature), ("normal_friction", normal_friction)];
    let added = added.iter().filter(|(_, value)| *value != 0.0).map(|(name, value)| format!(", {name} {value}"));
    let law = law.iter().map(|law| format!(", law {}", law.described()));
    let profile = shell_profile.iter().map(|profile| format!(", shell_profile {}", profile.described()));
    let cue = [cell.simplified_cue().to_string()].into_iter().chain(added).chain(law).chain(profile).collect();
    row.extend([Value::Text(cue), Value::Integer(*seed as i64)]);
    row.extend([kappa, eta_b, eta_s, friction, tension, xi_ratio, gain].map(Value::Real));
    row.push(Value::Text(rigidity_gradient.to_string()));
    row.extend([aspect, p0, w, flattening].map(Value::Real));
    row.extend(counts.map(count));
    row.push(Value::Text(scheme.to_string()));
    row.extend(numerics.map(Value::Real));
    row.push(Value::Text(outcome.name().to_owned()));
    let [first, second] = daughters.map_or([None; 2], |radii| radii.map(Some));
    let rates = [growth_rate, slow_growth_rate];
    let outcome = [chi, chi_signed, u_furrow, Some(t_end), first, second, rates[0], rates[1], phi, neck_offset];
    row.extend(outcome.map(Value::from));
    let second_neck = second_neck.map_or([None; 3], |SecondNeck { u, radius, share }| [u, radius, share].map(Some));
    row.extend(second_neck.map(Value::from));
    row.push(Value::Real(volume_drift));
    row.extend([steps, rejected, iterations, factorisations, remeshings].map(count));
    let checksum = checksum(row.iter().map(ValueRef::from));
    row.push(Value::Integer(checksum));
    row
}

/// The division of a row; `None` if the checksum is wrong or a number is out of range.
pub fn decode(row: &[ValueRef<'_>]) -> Option<Division> {
    let (last, values) = row.split_last()?;
    if *last != ValueRef::Integer(checksum(values.iter().copied())) {
        return None;
    }
    let mut values = values.get(OUTCOME..)?.iter();
    let mut next = || values.next().copied();
    let name = next()?;
    let outcomes = [Outcome::Symmetric, Outcome::Asymmetric, Outcome::Arrested];
    let outcome = outcomes.into_iter().find(|outcome| name == ValueRef::Text(outcome.name().as_bytes()))?;
    let mut real = || next()?.as_f64_or_null().ok();
    let row = DivisionRow {
        outcome,
        chi: real()?,
        chi_signed: real()?,
        u_furrow: real()?,
        t_end: real()??,
        daughters: real()?.zip(real()?).map(<[f64; 2]>::from),
        growth_rate: real()?,
        slow_growth_rate: real()?,
        phi: real()?,
        neck_offset: real()?,
        second_neck: match [real()?, real()?, real()?] {
            [Some(u), Some(radius), Some(share)] => Some(SecondNeck { u, radius, share }),
            _ => None,
        },
        volume_drift: real()??,
        work: {
            let mut count = || usize::try_from(next()?.as_i64().ok()?).ok();
            Work {
                steps: count()?,
                rejected: count()?,
                iterations: count()?,
                factorisations: count()?,
                remeshings: count()?,
            }
        },
    };
    Division::try_from(row).ok().filter(in_range)
}

/// Whether the numbers are possible for a division. NaN, which SQLite cannot store, is out of range.
pub fn in_range(division: &Division) -> bool {
    // In an extremely asymmetric division, rounding may give the smaller daughter a volume below 0.
    let share = |number: f64| (0.0..=1.0 + 1e-6).contains(&number);
    let positive = |number: f64| number.is_finite() && number >= 0.0;
    division.chi().is_none_or(share)
        && division.chi_signed().is_none_or(|chi| share(chi.abs()))
        && division.u_furrow().is_none_or(share)
        && division.daughters().is_none_or(|radii| radii.into_iter().all(positive))
        && division.growth_rate().is_none_or(f64::is_finite)
        && division.slow_growth_rate.is_none_or(f64::is_finite)
        && division.phi.is_none_or(f64::is_finite)
        && division.neck_offset.is_none_or(positive)
        && division.second_neck.is_none_or(|neck| share(neck.u) && positive(neck.radius) && share(neck.share))
        && positive(division.t_end)
        && positive(division.volume_drift)
}

/// The first eight bytes of the blake3 hash of the values and their types.
fn checksum<'v>(values: impl Iterator<Item = ValueRef<'v>>) -> i64 {
    let mut bytes = Vec::with_capacity(512);
    let mut put = |kind: u8, value: &[u8]| {
        bytes.push(kind);
        bytes.extend_from_slice(&(value.len() as u32).to_le_bytes());
        bytes.extend_from_slice(value);
    };
    for value in values {
        match value {
            ValueRef::Null => put(0, &[]),
            ValueRef::Integer(value) => put(1, &value.to_le_bytes()),
            ValueRef::Real(value) => put(2, &value.to_bits().to_le_bytes()),
            ValueRef::Text(text) => put(3, text),
            ValueRef::Blob(blob) => put(4, blob),
        }
    }
    let mut first = [0; 8];
    first.copy_from_slice(&blake3::hash(&bytes).as_bytes()[..8]);
    i64::from_le_bytes(first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::fake;

    /// The column of the cue also describes its regulator.
    #[test]
    fn the_cue_is_a_column_of_text() {
        let cue = "kappa:gradient,amplitude=0+tension:gradient,amplitude=0.3+regulator:none,turnover=10,diffusion=1,activity=0.3";
        let cell = fake::input(2.0).cell.with_cue(cue.parse().unwrap());
        let input = DivisionInput { cell, ..fake::input(2.0) };
        let row = encode(&Key::new(&input), 1, &input, &fake::divide(&input));
        let column = COLUMNS.split(", ").position(|name| name.trim() == "cue").unwrap();
        let expected = "tension:gradient,amplitude=0.3+regulator:none,turnover=10,diffusion=1,activity=0.3";
        assert_eq!(row[column], Value::Text(expected.to_owned()));
    }
}
