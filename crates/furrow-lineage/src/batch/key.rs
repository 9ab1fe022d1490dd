//! Identity of divisions: the hash of the canonical bytes of the input.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use furrow_cell::cue::{
    Coupling, Field, ParConstant, ParConstants, Profile, Quantity, Regulator, Side, Source, Term, Width,
};
use furrow_cell::law::{Constant, Expression, Law};
use furrow_cell::{Cell, Cue, Material, Numerics, RigidityGradient, Scheme, Shell};
use furrow_mechanics::division::DivisionInput;

/// Version of the solver. Stored divisions of another version are not used.
///
/// It increases with every change of a division's results, even in the last bit. The test `solver_version` compares the
/// bits of a dozen divisions with those stored for this version.
pub const SOLVER_VERSION: u32 = 8;

/// Version of the canonical bytes, padded to its original length, because shards of sweeps depend on it.
const LAYOUT: [u8; 12] = [1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];

/// Hash of everything that affects a division, except the solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Key([u8; 32]);

impl Key {
    /// The key of `input`; round its size first.
    pub fn new(input: &DivisionInput) -> Key {
        // The exhaustive pattern is a compile error until a new field is handled here and in the functions below.
        let DivisionInput { cell, numerics, seed } = input;
        let mut bytes = CanonicalBytes(Vec::with_capacity(256));
        bytes.0.extend_from_slice(&LAYOUT);
        // Hashing dominates look-ups, so the text is short: a cell without a cue fits into three blocks of the hash.
        bytes.0.extend_from_slice(b"division\xff");
        bytes.cell(cell);
        bytes.numerics(numerics);
        bytes.count(*seed);
        Key(*blake3::hash(&bytes.0).as_bytes())
    }

    /// The key's bytes.
    pub const fn as_bytes(&self) -> &[u8; 32] {
        &self.0
    }

    /// The key's leading eight bytes as a number, evenly spread.
    pub fn prefix(&self) -> u64 {
        let mut bytes = [0; 8];
        bytes.copy_from_slice(&self.0[..8]);
        u64::from_le_bytes(bytes)
    }
}

/// The bytes that are hashed: little-endian, with a unique form for each value.
struct CanonicalBytes(Vec<u8>);

impl CanonicalBytes {
    fn choice(&mut self, number: usize) {
        self.0.push(number.min(255) as u8);
    }

    fn count(&mut self, number: u64) {
        self.0.extend_from_slice(&number.to_le_bytes());
    }

    /// −0 is written as 0, and every NaN has the same bytes.
    fn reals(&mut self, values: impl IntoIterator<Item = f64>) {
        for value in values {
            let canonical = if value.is_nan() { f64::NAN } else { value + 0.0 };
            self.count(canonical.to_bits());
        }
    }

    fn cell(&mut self, cell: &Cell) {
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
        self.reals([*r0, *epsilon, *xi_s, kappa, eta_b, eta_s, friction, tension, xi_ratio, gain, aspect, p0, w]);
        self.choice(usize::from(rigidity_gradient == RigidityGradient::Dropped));
        // Default values are not written, so that older keys remain valid. A mark differs from any number of terms.
        let added =
            [(FLATTENED, flattening, 1.0), (CURLED, spontaneous_curvature, 0.0), (DRAGGED, normal_friction, 0.0)];
        for (mark, value, usual) in added {
            if value != usual {
                self.choice(mark);
                self.reals([value]);
            }
        }
        self.cue(&cell.simplified_cue());
        // Without a law nothing is written, so that keys of cells with the paper's law remain valid.
        if let Some(law) = law {
            self.law(law);
        }
        // Only the content of a table is written, because the shell already contains its aspect ratio.
        if let Some(profile) = shell_profile {
            let series = profile.factor().series();
            self.choice(PROFILED);
            self.count(series.len() as u64);
            self.reals(series.iter().copied());
        }
    }

    /// Writes a mark with which neither a regulator nor a discretisation begins, then everything except the law's name and units.
    fn law(&mut self, law: &Law) {
        self.choice(LAW);
        self.choice(usize::from(law.is_reversed()));
        for which in Expression::ALL {
            self.text(law.text(which).unwrap_or_default());
        }
        self.count(law.constants().count() as u64);
        for (name, Constant { value, .. }) in law.constants() {
            self.text(name);
            self.reals([*value]);
        }
    }

    fn text(&mut self, text: &str) {
        self.count(text.len() as u64);
        self.0.extend_from_slice(text.as_bytes());
    }

    /// The terms with an effect, in their order, since the last digit of their sum may depend on the order.
    fn cue(&mut self, cue: &Cue) {
        // Every term contains its kind, so the number of terms is needed only to separate them from the following fields.
        self.choice(cue.terms().len());
        for Term { field, profile, amplitude, side } in cue.terms() {
            self.choice(Field::ALL.iter().position(|other| other == field).unwrap_or(Field::ALL.len()));
            self.choice(profile_choice(profile));
            self.spread(profile, *amplitude);
            if let Some(Side { at, spread }) = side {
                self.choice(ONE_SIDED);
                self.reals([*at, *spread]);
            }
        }
        // Without a regulator nothing is written, so that keys of cues without a regulator remain valid.
        if let Some(regulator) = cue.regulator() {
            self.regulator(regulator);
        }
    }

    /// Writes a mark with which no discretisation begins, then every number. Kinds and counts precede the numbers.
    fn regulator(&mut self, regulator: &Regulator) {
        let Regulator { source, turnover, diffusion, diluted, couplings } = regulator;
        self.choice(REGULATOR);
        self.choice(source.map_or(NO_SOURCE, |source| profile_choice(&source.profile)));
        if let Some(Source { profile, amplitude }) = source {
            self.spread(profile, *amplitude);
        }
        self.reals([*turnover, *diffusion]);
        self.choice(usize::from(*diluted));
        self.choice(couplings.len());
        for Coupling { field, strength, half } in couplings {
            self.choice(*field as usize);
            self.choice(usize::from(half.is_some()));
            self.reals([Some(*strength), *half].into_iter().flatten());
        }
    }

    /// The numbers of A f and the unit of its width.
    fn spread(&mut self, profile: &Profile, amplitude: f64) {
        let numbers = [profile.quantity(Quantity::U0), profile.quantity(Quantity::Omega), Some(amplitude)];
        self.reals(numbers.into_iter().flatten());
        if let Profile::Par { far, constants, length_um, .. } = profile {
            self.choice(usize::from(*far));
            // Nothing is written for the published constants, so that earlier keys remain valid.
            if *constants != ParConstants::GOEHRING2011 || length_um.is_some() {
                let numbers = ParConstant::ALL.into_iter().map(|constant| constants.get(constant));
                self.choice(usize::from(constants.n_p));
                self.reals(numbers.chain([*length_um]).map(|number| number.unwrap_or(0.0)));
            }
        }
        self.choice(usize::from(matches!(profile.width(), Some(Width::Length(_)))));
    }

    fn numerics(&mut self, numerics: &Numerics) {
        let (counts, scheme, mut reals) = numbers(numerics);
        let [stages, intervals, surface @ ..] = counts;
        self.count(stages as u64);
        self.count(intervals as u64);
        // The first step depends on the scheme: `dt`, or `first_step`.
        reals[if scheme == Scheme::Published { 1 } else { 0 }] = 0.0;
        self.reals(reals);
        // Nothing is written for axisymmetric divisions, so that earlier keys remain valid.
        if numerics.modes > 0 {
            self.count(SURFACE_VERSION);
            surface.into_iter().for_each(|number| self.count(number as u64));
        }
    }
}

/// Version of the solver without axial symmetry, which changes more often than [`SOLVER_VERSION`].
const SURFACE_VERSION: u64 = 4;

/// Marks a shell of another profile than an ellipse.
const PROFILED: usize = 249;

/// Marks a normal friction.
const DRAGGED: usize = 250;

/// Marks a spontaneous curvature.
const CURLED: usize = 251;

/// Marks a shell that is not round.
const FLATTENED: usize = 252;

/// Marks the side of a one-sided term. Otherwise the next term's field, the regulator or the number of stages follows.
const ONE_SIDED: usize = 253;

/// Marks the beginning of a regulator. Without one the number of stages of the discretisation follows, which is small.
const REGULATOR: usize = 255;

/// Marks the beginning of the cell's law.
const LAW: usize = 254;

/// Written instead of a profile for a regulator without a source.
const NO_SOURCE: usize = 5;

/// Number of a profile in the keys of stored divisions. It must not change; a new profile gets the next free number, 6.
fn profile_choice(profile: &Profile) -> usize {
    match profile {
        Profile::Band { .. } => 0,
        Profile::Step { .. } => 1,
        Profile::Gradient => 2,
        Profile::Par { band: false, .. } => 3,
        Profile::Par { band: true, .. } => 4,
    }
}

/// All parameters of a discretisation: stages, intervals, modes, elements and contact (0 or 1), the scheme, the reals from
/// `dt` to `chi_symmetric`.
pub(super) fn numbers(numerics: &Numerics) -> ([usize; 5], Scheme, [f64; 8]) {
    // There is no `..`, so that a new field is a compile error until it is handled.
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
        noise_time,
        chi_symmetric,
        modes,
        elements,
        contact,
    } = *numerics;
    let reals = [dt, first_step, time_tolerance, step_factor, t_max, noise, noise_time, chi_symmetric];
    ([stages, intervals, modes, elements, usize::from(contact)], scheme, reals)
}

/// A table by key.
pub(super) type KeyMap<V> = HashMap<Key, V, BuildHasherDefault<PrefixHasher>>;

/// Uses the key itself as the hash.
#[derive(Debug, Default)]
pub(super) struct PrefixHasher(u64);

impl Hasher for PrefixHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        // `[u8; 32]` hashes its length first, then its bytes.
        for chunk in bytes.chunks_exact(8).take(1) {
            self.0 = chunk.iter().rev().fold(0, |word, &byte| (word << 8) | u64::from(byte));
        }
    }

    fn write_usize(&mut self, _length: usize) {}
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::batch::fake::input;
    use furrow_cell::Parameter;

    /// The parameters of a cell in a round shell.
    const NUMBERS: [Parameter; 14] = {
        use Parameter::*;
        [XiS, XiRatio, Gain, R0, Epsilon, Aspect, P0, W, Kappa, EtaB, EtaS, Friction, Tension, SpontaneousCurvature]
    };

    /// Sets one of the numbers of an input: 14 of the cell, six of the numerics, three of a cue.
    fn set(input: &mut DivisionInput, place: usize, x: f64) {
        let DivisionInput { cell, numerics, .. } = input;
        match place {
            0..14 => NUMBERS[place].set(cell, x),
            14 => numerics.time_tolerance = x,
            15 => numerics.step_factor = x,
            16 => numerics.t_max = x,
            17 => numerics.chi_symmetric = x,
            18 => numerics.noise = x,
            22 => numerics.noise_time = x,
            19 => cell.cue = Cue::kappa_band(x, 0.1, 0.1),
            20 => cell.cue = Cue::kappa_band(0.1, x, 0.1),
            _ => cell.cue = Cue::kappa_band(0.1, 0.1, x),
        }
    }

    proptest! {
        #[test]
        fn equal_keys_mean_equal_values(place in 0..23_usize, a in -10.0..10.0_f64, b in -10.0..10.0_f64) {
            let (mut left, mut right) = (input(2.0), input(2.0));
            set(&mut left, place, a);
            set(&mut right, place, b);
            prop_assert_eq!(Key::new(&left) == Key::new(&right), a == b);
            set(&mut right, place, a);
            prop_assert_eq!(Key::new(&left), Key::new(&right));
        }

        #[test]
        fn a_value_in_two_places_gives_two_keys(p in 0..19_usize, q in 0..19_usize, x in 20.0..30.0_f64) {
            let (mut left, mut right) = (input(2.0), input(2.0));
            set(&mut left, p, x);
            set(&mut right, q, x);
            prop_assert_eq!(Key::new(&left) == Key::new(&right), p == q || x == 25.0);
        }
    }

    #[test]
    fn zeros_of_either_sign_and_all_nans_are_the_same() {
        let key = |r0| Key::new(&input(r0));
        assert_eq!(key(0.0), key(-0.0));
        assert_eq!(key(f64::NAN), key(-f64::NAN));
        assert_ne!(key(0.0), key(f64::MIN_POSITIVE));
    }

    /// Stored divisions and shards of sweeps depend on them.
    #[test]
    fn cues_without_a_regulator_have_the_keys_that_they_had_before_there_was_one() {
        for (cue, prefix) in [
            ("none", 0x5fb3_e2b3_b233_4808),
            ("kappa:u0=0.465,omega=0.0577,amplitude=0.1", 0xc8bb_ffd7_64b2_9679),
            ("kappa:step,u0=0.4,omega=0.1Lh,amplitude=0.2+tension:gradient,amplitude=0.3", 0x4e08_4e19_ebeb_c2c2),
        ] {
            let cell = input(2.0).cell.with_cue(cue.parse().unwrap());
            assert_eq!(Key::new(&DivisionInput { cell, ..input(2.0) }).prefix(), prefix, "{cue}");
        }
    }

    /// The key contains texts and constants, but not the law's name and the units of its constants.
    #[test]
    fn constants_of_polarity_are_in_the_key_where_they_differ_from_the_published_ones() {
        let key = |text: &str| {
            let cell = Cell::new(4.0).with_cue(format!("kappa:par,amplitude=0.1{text}").parse().unwrap());
            Key::new(&DivisionInput::new(cell))
        };
        assert_eq!(key(""), key(",k_ap=0.19,psi=shape,n_p=1"));
        let all = ["", ",k_ap=0.2", ",k_pa=0.2", ",psi=0.2", ",n_p=2", ",length_um=2", ",u0=1"].map(key);
        for (k, one) in all.iter().enumerate() {
            assert!(!all[..k].contains(one), "{k}");
        }
    }

    #[test]
    fn laws_differ_by_their_texts_and_constants() {
        let law = |name: &str, text: &str, constants: &str| {
            let text = format!(
                "Law(name: \"{name}\", constants: {{ {constants} }}, stress_uu: \"{text}\", stress_phiphi: \"{text}\")"
            );
            furrow_cell::Law::parse(&text, "law.ron").unwrap()
        };
        let key = |law| Key::new(&DivisionInput { cell: input(2.0).cell.with_law(law), ..input(2.0) });
        let (text, a) = ("a*xi_s*C*(1 + 0*u)", "\"a\": (value: 0.5)");
        let mut keys = vec![
            Key::new(&input(2.0)),
            key(law("x", text, a)),
            key(law("x", text, a).mirrored()),
            key(law("x", text, "\"a\": (value: 0.6)")),
            key(law("x", &format!("{text} + 0*b"), "\"a\": (value: 0.5), \"b\": (value: 0.5)")),
            key(law("x", "a*xi_s*C", a)),
        ];
        assert_eq!(keys[1], key(law("y", text, "\"a\": (value: 0.5, unit: \"1/L_h\")")));
        keys.sort();
        keys.dedup();
        assert_eq!(keys.len(), 6);
    }

    #[test]
    fn counts_choices_and_seed_are_in_the_key() {
        let base = input(2.0);
        let mut variants = vec![base.clone(); 7];
        variants[0].numerics.stages += 1;
        variants[1].numerics.intervals += 2;
        variants[2].seed += 1;
        variants[3].cell.material.rigidity_gradient = RigidityGradient::Dropped;
        // The same number as a width in u and in L_h, and for two fields.
        for (k, cue) in [(4, "kappa:u0=0.4,omega=0.1,amplitude=0.2"), (5, "kappa:u0=0.4,omega=0.1Lh,amplitude=0.2")] {
            variants[k].cell.cue = cue.parse().unwrap();
        }
        variants[6].cell.cue = "activity:u0=0.4,omega=0.1,amplitude=0.2".parse().unwrap();
        let mut keys: Vec<Key> = variants.iter().map(Key::new).collect();
        keys.push(Key::new(&base));
        keys.sort();
        keys.dedup();
        assert_eq!(keys.len(), 8);
        // The key depends on the content of a shell's table, not on its name.
        let table = |name: &str, wide: f64| {
            let rows = (0..=20).map(|k| {
                let (sin, cos) = (f64::from(k) * std::f64::consts::PI / 20.0).sin_cos();
                format!("{},{}\n", 1.505 * cos, if k % 20 == 0 { 0.0 } else { sin * (1.0 + wide * cos * cos) })
            });
            let text = format!("z,r\n{}", rows.collect::<String>());
            let profile = furrow_cell::ShellProfile::from_table(text.as_bytes(), name, name).unwrap();
            Key::new(&DivisionInput { cell: base.cell.clone().with_shell_profile(profile), ..base.clone() })
        };
        assert_eq!(table("a", 0.1), table("b", 0.1));
        assert!(table("a", 0.1) != table("a", 0.2) && table("a", 0.1) != Key::new(&base));
        // The key depends on every number of a regulator, its kind, and whether there is a source.
        let cues = [
            "band,u0=0.4,omega=0.1,amplitude=1,turnover=10,diffusion=1,kappa=0.2,tension=3,tension.half=2",
            "band,u0=0.41,omega=0.1,amplitude=1,turnover=10,diffusion=1,kappa=0.2,tension=3,tension.half=2",
            "band,u0=0.4,omega=0.11,amplitude=1,turnover=10,diffusion=1,kappa=0.2,tension=3,tension.half=2",
            "band,u0=0.4,omega=0.1Lh,amplitude=1,turnover=10,diffusion=1,kappa=0.2,tension=3,tension.half=2",
            "band,u0=0.4,omega=0.1,amplitude=1.1,turnover=10,diffusion=1,kappa=0.2,tension=3,tension.half=2",
            "band,u0=0.4,omega=0.1,amplitude=1,turnover=11,diffusion=1,kappa=0.2,tension=3,tension.half=2",
            "band,u0=0.4,omega=0.1,amplitude=1,turnover=10,diffusion=1.1,kappa=0.2,tension=3,tension.half=2",
            "band,u0=0.4,omega=0.1,amplitude=1,turnover=10,diffusion=1,kappa=0.21,tension=3,tension.half=2",
            "band,u0=0.4,omega=0.1,amplitude=1,turnover=10,diffusion=1,kappa=0.2,tension=3.1,tension.half=2",
            "band,u0=0.4,omega=0.1,amplitude=1,turnover=10,diffusion=1,kappa=0.2,tension=3,tension.half=2.1",
            "band,u0=0.4,omega=0.1,amplitude=1,turnover=10,diffusion=1,kappa=0.2,tension=3",
            "band,u0=0.4,omega=0.1,amplitude=1,turnover=10,diffusion=1,kappa=0.2,friction=3,friction.half=2",
            "band,u0=0.4,omega=0.1,amplitude=1,turnover=10,diffusion=1,diluted=false,kappa=0.2,tension=3,tension.half=2",
            "step,u0=0.4,omega=0.1,amplitude=1,turnover=10,diffusion=1,kappa=0.2,tension=3,tension.half=2",
            "none,turnover=10,diffusion=1,kappa=0.2,tension=3,tension.half=2",
        ];
        let with = |cue: &str| {
            Key::new(&DivisionInput { cell: base.cell.clone().with_cue(cue.parse().unwrap()), ..base.clone() })
        };
        let mut keys: Vec<Key> = cues.iter().map(|cue| with(&format!("regulator:{cue}"))).collect();
        keys.extend([
            Key::new(&base),
            with("tension:gradient,amplitude=0.1+regulator:none,turnover=10,diffusion=1,kappa=0.2"),
        ]);
        keys.sort();
        keys.dedup();
        assert_eq!(keys.len(), cues.len() + 2);
        // A cue without effect, or a regulator that acts on no field, has the key of no cue.
        assert_eq!(with("regulator:gradient,amplitude=0.5,turnover=10,diffusion=1,kappa=0"), Key::new(&base));
        let idle = Cue::kappa_band(0.465, 0.0577, 0.0);
        let idle = DivisionInput { cell: base.cell.clone().with_cue(idle), ..base.clone() };
        assert_eq!(Key::new(&idle), Key::new(&base));
    }
}
