//! What makes two divisions the same: quantised inputs in canonical bytes, hashed.

use crate::{
    cortex::{Cue, Numerics, Physics, RigidityGradient},
    division::DivisionInput,
};

/// Raised by hand when results change for a reason outside the solver's sources (a dependency, say).
const SOLVER_REVISION: u32 = 1;

/// Version of the canonical bytes below.
const KEY_LAYOUT: u32 = 1;

/// Identifies the code that computes a division. Results of different solvers are never mixed.
///
/// It is derived from the sources of the floors below the lineage at build time, so that editing the solver cannot
/// leave a stale result in a store.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SolverVersion(u64);

impl SolverVersion {
    /// The solver of this build.
    pub fn current() -> Self {
        // The build script prints decimal digits; were they anything else, zero is still one definite version.
        let fingerprint: u64 = env!("FURROW_SOLVER_FINGERPRINT").parse().unwrap_or(0);
        let mut hasher = blake3::Hasher::new();
        hasher.update(&KEY_LAYOUT.to_le_bytes());
        hasher.update(&SOLVER_REVISION.to_le_bytes());
        hasher.update(&fingerprint.to_le_bytes());
        let mut bytes = [0; 8];
        bytes.copy_from_slice(&hasher.finalize().as_bytes()[..8]);
        SolverVersion(u64::from_le_bytes(bytes))
    }

    /// A version with a given number, for stores of other solvers and tests.
    pub const fn new(number: u64) -> Self {
        SolverVersion(number)
    }

    /// The version as a number.
    pub const fn number(self) -> u64 {
        self.0
    }
}

/// How R0 is rounded before a division is looked up or solved: to a number of binary digits.
///
/// Radii that two cells reach by different roundings then share one division. Rounding to binary digits is exact and
/// idempotent, and uses no logarithm whose last digit could differ between machines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantisation {
    /// Binary digits kept after the leading one, 0 to 52; 52 keeps R0 as it is.
    digits: u32,
}

impl Quantisation {
    /// R0 as it is.
    pub const EXACT: Quantisation = Quantisation { digits: 52 };

    /// The default relative step, 2⁻³⁰ ≈ 9.3·10⁻¹⁰: far above rounding errors and far below what χ can tell (at the
    /// steepest place, the upper edge of the asymmetric window, d χ/d ln R0 is about 60).
    pub const DEFAULT: Quantisation = Quantisation { digits: 30 };

    /// The coarsest quantisation whose relative step does not exceed `step`; 0 is exact.
    ///
    /// # Errors
    /// A step that is negative, above ½ or not a number is refused and given back.
    pub fn with_relative_step(step: f64) -> Result<Self, f64> {
        if !(0.0..=0.5).contains(&step) {
            return Err(step);
        }
        let digits = (0..52).find(|&digits| Quantisation { digits }.relative_step() <= step).unwrap_or(52);
        Ok(Quantisation { digits })
    }

    /// Spacing of the quantised radii relative to R0, at most; 0 if exact.
    pub fn relative_step(self) -> f64 {
        if self.digits >= 52 { 0.0 } else { f64::from_bits((1023 - u64::from(self.digits)) << 52) }
    }

    /// The quantised radius: the nearest one on the grid, ties to even. Relative shift at most half the step.
    pub fn apply(self, r0: f64) -> f64 {
        if self.digits >= 52 || !r0.is_normal() {
            return r0;
        }
        let dropped = 52 - self.digits;
        let bits = r0.to_bits();
        let odd = (bits >> dropped) & 1;
        // Adding half a step less one, plus the oddness, rounds half to even; the carry may run into the exponent.
        let rounded = (bits + (1 << (dropped - 1)) - 1 + odd) >> dropped << dropped;
        let rounded = f64::from_bits(rounded);
        if rounded.is_finite() { rounded } else { r0 }
    }
}

impl Default for Quantisation {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Hash of everything a division depends on.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Key([u8; 32]);

impl Key {
    /// The key of `input` as it stands (quantise first) for `solver`.
    pub fn new(input: &DivisionInput, solver: SolverVersion) -> Key {
        Key(*blake3::hash(&canonical_bytes(input, solver)).as_bytes())
    }

    /// The key with the given bytes.
    pub const fn from_bytes(bytes: [u8; 32]) -> Key {
        Key(bytes)
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

impl std::fmt::Display for Key {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl std::fmt::Debug for Key {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Key({self})")
    }
}

/// The bytes a key is the hash of: little-endian, fixed order, versioned, −0 written as 0.
///
/// Every struct is taken apart without `..`: a new field does not compile until it is given its place here.
fn canonical_bytes(input: &DivisionInput, solver: SolverVersion) -> Vec<u8> {
    let DivisionInput { physics, numerics, r0, cue, seed } = *input;
    let Physics {
        kappa,
        eta_b,
        eta_s,
        friction,
        tension,
        xi_s,
        xi_ratio,
        gain,
        aspect,
        p0,
        w,
        r0: _, // the first cell's radius; this cell's is `input.r0`
        epsilon,
        rigidity_gradient,
    } = physics;
    let Numerics { stages, intervals, time_tolerance, step_factor, t_max, chi_symmetric } = numerics;

    let mut bytes = Vec::with_capacity(256);
    bytes.extend_from_slice(b"furrow division");
    bytes.extend_from_slice(&KEY_LAYOUT.to_le_bytes());
    bytes.extend_from_slice(&solver.number().to_le_bytes());
    for value in [kappa, eta_b, eta_s, friction, tension, xi_s, xi_ratio, gain, aspect, p0, w, epsilon] {
        push_real(&mut bytes, value);
    }
    bytes.push(match rigidity_gradient {
        RigidityGradient::Full => 0,
        RigidityGradient::Dropped => 1,
    });
    bytes.extend_from_slice(&(stages as u64).to_le_bytes());
    bytes.extend_from_slice(&(intervals as u64).to_le_bytes());
    for value in [time_tolerance, step_factor, t_max, chi_symmetric, r0] {
        push_real(&mut bytes, value);
    }
    match cue {
        Cue::None => bytes.push(0),
        Cue::Kappa { u0, omega, amplitude } => {
            bytes.push(1);
            for value in [u0, omega, amplitude] {
                push_real(&mut bytes, value);
            }
        }
    }
    bytes.extend_from_slice(&seed.to_le_bytes());
    bytes
}

fn push_real(bytes: &mut Vec<u8>, value: f64) {
    let canonical = if value.is_nan() {
        f64::NAN
    } else {
        value + 0.0 // −0 + 0 = 0
    };
    bytes.extend_from_slice(&canonical.to_bits().to_le_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn input(r0: f64) -> DivisionInput {
        DivisionInput { physics: Physics::GAO2026, numerics: Numerics::default(), r0, cue: Cue::None, seed: 1 }
    }

    fn key(input: &DivisionInput) -> Key {
        Key::new(input, SolverVersion::new(7))
    }

    /// The places where an input can differ, each as a setter.
    fn setters() -> Vec<fn(&mut DivisionInput, f64)> {
        vec![
            |i, x| i.physics.kappa = x,
            |i, x| i.physics.eta_b = x,
            |i, x| i.physics.eta_s = x,
            |i, x| i.physics.friction = x,
            |i, x| i.physics.tension = x,
            |i, x| i.physics.xi_s = x,
            |i, x| i.physics.xi_ratio = x,
            |i, x| i.physics.gain = x,
            |i, x| i.physics.aspect = x,
            |i, x| i.physics.p0 = x,
            |i, x| i.physics.w = x,
            |i, x| i.physics.epsilon = x,
            |i, x| i.numerics.time_tolerance = x,
            |i, x| i.numerics.step_factor = x,
            |i, x| i.numerics.t_max = x,
            |i, x| i.numerics.chi_symmetric = x,
            |i, x| i.r0 = x,
            |i, x| i.cue = Cue::Kappa { u0: x, omega: 0.1, amplitude: 0.1 },
            |i, x| i.cue = Cue::Kappa { u0: 0.1, omega: x, amplitude: 0.1 },
            |i, x| i.cue = Cue::Kappa { u0: 0.1, omega: 0.1, amplitude: x },
        ]
    }

    proptest! {
        #[test]
        fn equal_keys_mean_equal_values(place in 0..20_usize, a in -10.0..10.0_f64, b in -10.0..10.0_f64) {
            let set = setters()[place];
            let (mut left, mut right) = (input(2.0), input(2.0));
            set(&mut left, a);
            set(&mut right, b);
            prop_assert_eq!(key(&left) == key(&right), a == b);
            set(&mut right, a);
            prop_assert_eq!(key(&left), key(&right));
        }

        #[test]
        fn a_value_in_two_places_gives_two_keys(p in 0..17_usize, q in 0..17_usize, x in 20.0..30.0_f64) {
            let (mut left, mut right) = (input(2.0), input(2.0));
            setters()[p](&mut left, x);
            setters()[q](&mut right, x);
            prop_assert_eq!(key(&left) == key(&right), p == q || x == 25.0);
        }

        #[test]
        fn quantising_twice_is_quantising_once(r0 in 1e-3..1e3_f64, digits in 0..=52_u32) {
            let quantisation = Quantisation { digits };
            let once = quantisation.apply(r0);
            prop_assert_eq!(quantisation.apply(once).to_bits(), once.to_bits());
            prop_assert!((once - r0).abs() <= 0.5 * quantisation.relative_step() * r0);
        }

        #[test]
        fn quantisation_keeps_the_order(a in 1e-3..1e3_f64, b in 1e-3..1e3_f64, digits in 0..=52_u32) {
            let quantisation = Quantisation { digits };
            prop_assert!(a > b || quantisation.apply(a) <= quantisation.apply(b));
        }
    }

    #[test]
    fn minus_zero_is_zero_and_the_first_cells_radius_is_no_matter() {
        let mut left = input(2.0);
        let mut right = input(2.0);
        left.physics.tension = 0.0;
        right.physics.tension = -0.0;
        right.physics.r0 = 3.0;
        assert_eq!(key(&left), key(&right));
    }

    #[test]
    fn counts_choices_seed_and_solver_are_in_the_key() {
        let base = input(2.0);
        let mut variants = vec![base; 5];
        variants[0].numerics.stages += 1;
        variants[1].numerics.intervals += 2;
        variants[2].seed += 1;
        variants[3].physics.rigidity_gradient = RigidityGradient::Dropped;
        variants[4].cue = Cue::Kappa { u0: 0.465, omega: 0.0577, amplitude: 0.0 };
        let mut keys: Vec<Key> = variants.iter().map(key).collect();
        keys.push(key(&base));
        keys.push(Key::new(&base, SolverVersion::new(8)));
        keys.sort();
        keys.dedup();
        assert_eq!(keys.len(), 7);
    }

    #[test]
    fn radii_a_rounding_apart_share_a_key_and_distinct_radii_do_not() {
        let q = Quantisation::DEFAULT;
        let r0 = 5.4 * 0.5_f64.cbrt();
        assert_eq!(q.apply(r0).to_bits(), q.apply(r0.next_up()).to_bits());
        assert_ne!(q.apply(r0).to_bits(), q.apply(r0 * (1.0 + 2e-9)).to_bits());
        assert_eq!(Quantisation::EXACT.apply(r0).to_bits(), r0.to_bits());
    }

    #[test]
    fn a_step_is_rounded_down_to_a_power_of_two_and_nonsense_is_refused() {
        let q = Quantisation::with_relative_step(1e-9).unwrap();
        assert_eq!(q, Quantisation::DEFAULT);
        assert!(q.relative_step() <= 1e-9);
        assert_eq!(Quantisation::with_relative_step(0.0).unwrap(), Quantisation::EXACT);
        assert_eq!(Quantisation::with_relative_step(0.25).unwrap().relative_step(), 0.25);
        assert!(Quantisation::with_relative_step(-1e-9).is_err());
        assert!(Quantisation::with_relative_step(0.6).is_err());
        assert!(Quantisation::with_relative_step(f64::NAN).is_err());
    }

    #[test]
    fn non_finite_radii_pass_through_quantisation() {
        for r0 in [f64::NAN, f64::INFINITY, 0.0, -0.0, f64::MAX] {
            let got = Quantisation { digits: 3 }.apply(r0);
            assert!(got.to_bits() == r0.to_bits());
        }
    }
}
