//! What a division is to this floor: a task whose size is the cell's radius, and a record of fixed length.
//!
//! ```text
//! 0        1      8                   100  200
//! outcome  flags  9 reals, 5 counts   0…
//! ```
//! Numbers are little-endian, reals by their bits, so that what is read is bit for bit what was solved.

use bvp::Work;

use super::{
    key::CanonicalBytes,
    store::PAYLOAD,
    task::{Record, Task},
};
use crate::cell::cue::profile::NAMES;
use crate::cell::cue::{Field, Quantity, Term, Width};
use crate::cell::{Cell, Cue, Material, Numerics, RigidityGradient, Scheme, Shell};
use crate::division::{Division, DivisionError, DivisionInput, Outcome};

impl Task for DivisionInput {
    type Record = Division;
    type Error = DivisionError;

    /// Every struct is taken apart without `..`: a new field does not compile until it is given its place here.
    fn write_canonical(&self, bytes: &mut CanonicalBytes) {
        let DivisionInput { cell, numerics, seed } = self;
        // Short, so that all of a cell without a cue fits into three blocks of the hash: look-ups spend their time there.
        bytes.name("division");
        write_cell(cell, bytes);
        write_numerics(numerics, bytes);
        bytes.count(*seed);
    }

    fn size(&self) -> f64 {
        self.cell.r0
    }

    fn with_size(&self, size: f64) -> DivisionInput {
        DivisionInput { cell: Cell { r0: size, ..self.cell.clone() }, ..*self }
    }
}

fn write_cell(cell: &Cell, bytes: &mut CanonicalBytes) {
    let Cell { r0, epsilon, xi_s, cue, material, shell } = cell;
    let Material { kappa, eta_b, eta_s, friction, tension, xi_ratio, gain, rigidity_gradient } = *material;
    let Shell { aspect, p0, w } = *shell;
    for value in [*r0, *epsilon, *xi_s, kappa, eta_b, eta_s, friction, tension, xi_ratio, gain, aspect, p0, w] {
        bytes.real(value);
    }
    bytes.choice(match rigidity_gradient {
        RigidityGradient::Full => 0,
        RigidityGradient::Dropped => 1,
    });
    write_cue(cue, bytes);
}

fn write_numerics(numerics: &Numerics, bytes: &mut CanonicalBytes) {
    let Numerics {
        stages,
        intervals,
        scheme,
        dt,
        first_step,
        time_tolerance,
        step_factor,
        t_max,
        noise,
        chi_symmetric,
    } = *numerics;
    bytes.count(stages as u64);
    bytes.count(intervals as u64);
    // What a scheme does not use makes no difference.
    bytes.real(if scheme == Scheme::Published { dt } else { 0.0 });
    for value in [first_step, time_tolerance, step_factor, t_max, noise, chi_symmetric] {
        bytes.real(value);
    }
}

/// The terms that do something, in their order: in another order the last digit of their sum may be another. A cue that
/// does nothing is none.
fn write_cue(cue: &Cue, bytes: &mut CanonicalBytes) {
    let cue = cue.simplified();
    // Every term says what it is, so that the number of them only has to part them from what follows.
    bytes.choice(cue.terms().len().min(255) as u8);
    for Term { field, profile, amplitude } in cue.terms() {
        bytes.choice(code(*field));
        bytes.choice(NAMES.iter().position(|name| *name == profile.name()).unwrap_or(NAMES.len()) as u8);
        let numbers = [profile.quantity(Quantity::U0), profile.quantity(Quantity::Omega), Some(*amplitude)];
        numbers.into_iter().flatten().for_each(|value| bytes.real(value));
        bytes.choice(u8::from(matches!(profile.width(), Some(Width::Length(_)))));
    }
}

/// The place of a field in the list of all of them.
fn code(field: Field) -> u8 {
    Field::ALL.iter().position(|other| *other == field).unwrap_or(Field::ALL.len()) as u8
}

/// Where the numbers begin in a payload.
const NUMBERS: usize = 8;

impl Record for Division {
    const FOLDER: &'static str = "divisions";

    fn encode(&self) -> [u8; PAYLOAD] {
        // Taken apart without `..`: a new field does not compile until it has its place.
        let Division {
            outcome,
            chi,
            chi_signed,
            u_furrow,
            t_end,
            daughters,
            growth_rate,
            slow_growth_rate,
            volume_drift,
            work: Work { steps, rejected, iterations, factorisations, remeshings },
        } = self;
        let mut payload = [0; PAYLOAD];
        payload[0] = match outcome {
            Outcome::Symmetric => 0,
            Outcome::Asymmetric => 1,
            Outcome::Failed => 2,
        };
        let present = [
            chi.is_some(),
            chi_signed.is_some(),
            u_furrow.is_some(),
            daughters.is_some(),
            growth_rate.is_some(),
            slow_growth_rate.is_some(),
        ];
        payload[1] = present.iter().enumerate().map(|(bit, &some)| u8::from(some) << bit).sum();
        let [below, above] = daughters.unwrap_or_default();
        let reals = [
            chi.unwrap_or_default(),
            chi_signed.unwrap_or_default(),
            u_furrow.unwrap_or_default(),
            below,
            above,
            growth_rate.unwrap_or_default(),
            slow_growth_rate.unwrap_or_default(),
            *t_end,
            *volume_drift,
        ];
        let counts = [*steps, *rejected, *iterations, *factorisations, *remeshings].map(|count| count as u32);
        let reals = reals.iter().flat_map(|real| real.to_bits().to_le_bytes());
        let bytes = reals.chain(counts.iter().flat_map(|count| count.to_le_bytes()));
        for (place, byte) in payload[NUMBERS..].iter_mut().zip(bytes) {
            *place = byte;
        }
        payload
    }

    fn decode(payload: &[u8; PAYLOAD]) -> Option<Division> {
        let outcome = match payload[0] {
            0 => Outcome::Symmetric,
            1 => Outcome::Asymmetric,
            2 => Outcome::Failed,
            _ => return None,
        };
        let flags = payload[1];
        let mut numbers = Numbers(&payload[NUMBERS..]);
        let [chi, chi_signed, u_furrow, below, above, growth_rate, slow_growth_rate, t_end, volume_drift] =
            std::array::from_fn(|_| f64::from_bits(u64::from_le_bytes(numbers.next())));
        let [steps, rejected, iterations, factorisations, remeshings] =
            std::array::from_fn(|_| u32::from_le_bytes(numbers.next()) as usize);
        let division = Division {
            outcome,
            chi: (flags & 1 != 0).then_some(chi),
            chi_signed: (flags & 2 != 0).then_some(chi_signed),
            u_furrow: (flags & 4 != 0).then_some(u_furrow),
            t_end,
            daughters: (flags & 8 != 0).then_some([below, above]),
            growth_rate: (flags & 16 != 0).then_some(growth_rate),
            slow_growth_rate: (flags & 32 != 0).then_some(slow_growth_rate),
            volume_drift,
            work: Work { steps, rejected, iterations, factorisations, remeshings },
        };
        // Nothing else stands for it, down to the bytes that hold nothing, and no division has numbers out of their range.
        (division.encode() == *payload && in_range(&division)).then_some(division)
    }

    /// The daughters' radii go with the cell's, so that volumes are handed down to rounding.
    fn scaled(&self, factor: f64) -> Division {
        let daughters = self.daughters.map(|radii| radii.map(|r0| r0 * factor));
        Division { daughters, ..self.clone() }
    }

    /// The size asymmetry χ. It rises most steeply at the upper edge of the asymmetric window, where dχ/d ln R0 is about
    /// 60: the default rounding shifts it by some 10⁻⁸ there.
    fn response(&self) -> Option<f64> {
        self.chi
    }
}

/// Whether the numbers of a record are those of some division.
fn in_range(division: &Division) -> bool {
    // The smaller daughter of a division that is all but none may have a volume below 0 by rounding.
    let share = |number: f64| (0.0..=1.0 + 1e-6).contains(&number);
    let positive = |number: f64| number.is_finite() && number >= 0.0;
    division.chi.is_none_or(share)
        && division.chi_signed.is_none_or(|chi| share(chi.abs()))
        && division.u_furrow.is_none_or(share)
        && division.daughters.is_none_or(|radii| radii.into_iter().all(positive))
        && division.growth_rate.is_none_or(f64::is_finite)
        && division.slow_growth_rate.is_none_or(f64::is_finite)
        && positive(division.t_end)
        && positive(division.volume_drift)
}

/// Reads numbers off the front of a slice that holds enough of them.
struct Numbers<'p>(&'p [u8]);

impl Numbers<'_> {
    fn next<const N: usize>(&mut self) -> [u8; N] {
        let mut bytes = [0; N];
        if let Some((head, rest)) = self.0.split_first_chunk() {
            bytes = *head;
            self.0 = rest;
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::{Key, SolverVersion};
    use proptest::{collection::vec, option, prelude::*};

    fn input(r0: f64) -> DivisionInput {
        DivisionInput { seed: 1, ..DivisionInput::new(Cell::new(r0)) }
    }

    fn key(input: &DivisionInput) -> Key {
        Key::new(input, SolverVersion::new(7))
    }

    /// The places where an input can differ, each as a setter.
    fn setters() -> Vec<fn(&mut DivisionInput, f64)> {
        vec![
            |i, x| i.cell.material.kappa = x,
            |i, x| i.cell.material.eta_b = x,
            |i, x| i.cell.material.eta_s = x,
            |i, x| i.cell.material.friction = x,
            |i, x| i.cell.material.tension = x,
            |i, x| i.cell.xi_s = x,
            |i, x| i.cell.material.xi_ratio = x,
            |i, x| i.cell.material.gain = x,
            |i, x| i.cell.shell.aspect = x,
            |i, x| i.cell.shell.p0 = x,
            |i, x| i.cell.shell.w = x,
            |i, x| i.cell.epsilon = x,
            |i, x| i.numerics.time_tolerance = x,
            |i, x| i.numerics.step_factor = x,
            |i, x| i.numerics.t_max = x,
            |i, x| i.numerics.chi_symmetric = x,
            |i, x| i.numerics.noise = x,
            |i, x| i.cell.r0 = x,
            |i, x| i.cell.cue = Cue::kappa_band(x, 0.1, 0.1),
            |i, x| i.cell.cue = Cue::kappa_band(0.1, x, 0.1),
            |i, x| i.cell.cue = Cue::kappa_band(0.1, 0.1, x),
        ]
    }

    fn bits(division: &Division) -> Vec<Option<u64>> {
        let d = division;
        let mut reals = vec![
            d.chi,
            d.chi_signed,
            d.u_furrow,
            d.growth_rate,
            d.slow_growth_rate,
            Some(d.t_end),
            Some(d.volume_drift),
        ];
        reals.extend([d.daughters.map(|[a, _]| a), d.daughters.map(|[_, p]| p)]);
        reals.into_iter().map(|real| real.map(f64::to_bits)).collect()
    }

    /// Mostly a number that a division may have anywhere, now and then any bits.
    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![30 => 0.0..1.0_f64, 1 => any::<u64>().prop_map(f64::from_bits)]
    }

    proptest! {
        #[test]
        fn equal_keys_mean_equal_values(place in 0..21_usize, a in -10.0..10.0_f64, b in -10.0..10.0_f64) {
            let set = setters()[place];
            let (mut left, mut right) = (input(2.0), input(2.0));
            set(&mut left, a);
            set(&mut right, b);
            prop_assert_eq!(key(&left) == key(&right), a == b);
            set(&mut right, a);
            prop_assert_eq!(key(&left), key(&right));
        }

        #[test]
        fn a_value_in_two_places_gives_two_keys(p in 0..18_usize, q in 0..18_usize, x in 20.0..30.0_f64) {
            let (mut left, mut right) = (input(2.0), input(2.0));
            setters()[p](&mut left, x);
            setters()[q](&mut right, x);
            prop_assert_eq!(key(&left) == key(&right), p == q || x == 25.0);
        }

        #[test]
        fn a_division_comes_back_bit_for_bit(
            outcome in 0..3_usize,
            reals in vec(number(), 4),
            maybe in vec(option::of(number()), 6),
            counts in any::<[u32; 5]>().prop_map(|counts| counts.map(|count| count as usize)),
        ) {
            let division = Division {
                outcome: [Outcome::Symmetric, Outcome::Asymmetric, Outcome::Failed][outcome],
                chi: maybe[0],
                chi_signed: maybe[1],
                u_furrow: maybe[2],
                t_end: reals[0],
                daughters: maybe[3].map(|_| [reals[1], reals[2]]),
                growth_rate: maybe[4],
                slow_growth_rate: maybe[5],
                volume_drift: reals[3],
                work: Work {
                    steps: counts[0],
                    rejected: counts[1],
                    iterations: counts[2],
                    factorisations: counts[3],
                    remeshings: counts[4],
                },
            };
            let read = Division::decode(&division.encode());
            prop_assert_eq!(read.is_some(), in_range(&division));
            let Some(read) = read else { return Ok(()) };
            prop_assert_eq!(bits(&read), bits(&division));
            prop_assert_eq!(read.outcome, division.outcome);
            prop_assert_eq!(read.work, division.work);
        }
    }

    #[test]
    fn minus_zero_is_zero() {
        let mut left = input(2.0);
        let mut right = input(2.0);
        left.cell.material.tension = 0.0;
        right.cell.material.tension = -0.0;
        assert_eq!(key(&left), key(&right));
    }

    #[test]
    fn counts_choices_and_seed_are_in_the_key() {
        let base = input(2.0);
        let mut variants = vec![base.clone(); 7];
        variants[0].numerics.stages += 1;
        variants[1].numerics.intervals += 2;
        variants[2].seed += 1;
        variants[3].cell.material.rigidity_gradient = RigidityGradient::Dropped;
        // One number as a width in u and in L_h, and for two fields.
        for (k, cue) in [(4, "kappa:u0=0.4,omega=0.1,amplitude=0.2"), (5, "kappa:u0=0.4,omega=0.1Lh,amplitude=0.2")] {
            variants[k].cell.cue = cue.parse().unwrap();
        }
        variants[6].cell.cue = "activity:u0=0.4,omega=0.1,amplitude=0.2".parse().unwrap();
        let mut keys: Vec<Key> = variants.iter().map(key).collect();
        keys.push(key(&base));
        keys.sort();
        keys.dedup();
        assert_eq!(keys.len(), 8);
        // A cue that does nothing is none.
        let idle = Cue::kappa_band(0.465, 0.0577, 0.0);
        assert_eq!(key(&DivisionInput { cell: base.cell.clone().with_cue(idle), ..base.clone() }), key(&base));
    }

    #[test]
    fn the_daughters_of_a_scaled_division_have_its_volume() {
        let mut division = Division::decode(&[0; PAYLOAD]).unwrap();
        division.daughters = Some([0.4_f64, 0.6].map(|share| 2.0 * share.cbrt()));
        let scaled = division.scaled(1.001);
        let volume: f64 = scaled.daughters.unwrap().iter().map(|r0| r0.powi(3)).sum();
        assert!((volume / 2.002_f64.powi(3) - 1.0).abs() < 1e-14);
        assert_eq!(Division { daughters: division.daughters, ..scaled }, division);
    }

    #[test]
    fn a_payload_with_no_outcome_is_no_division() {
        assert!(Division::decode(&[0xff; PAYLOAD]).is_none());
    }

    /// A number where the flags say that there is none, and bytes behind the last count.
    #[test]
    fn nothing_but_what_was_written_is_read() {
        let rest = Division::decode(&[0; PAYLOAD]).unwrap().encode();
        for place in [NUMBERS, PAYLOAD - 1, 2] {
            let mut payload = rest;
            payload[place] = 1;
            assert!(Division::decode(&payload).is_none(), "{place}");
        }
    }
}
