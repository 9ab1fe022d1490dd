//! A regulator of the cortex, as part of a cue: a substance with advection, diffusion and turnover.

use serde::{Deserialize, Serialize};

use super::{Field, ParConstant, Profile, Quantity};
use crate::Number;

/// The source of a regulator, A f(u), relative to its resting concentration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Source<D = f64> {
    /// The profile f along the contour.
    pub profile: Profile<D>,
    /// Amplitude A.
    pub amplitude: D,
}

/// The effect of a regulator on one field: X = X0·(1 + B h), but B h is added to tension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling<D = f64> {
    /// The field.
    pub field: Field,
    /// Strength B, for tension in κ0/L_h².
    pub strength: D,
    /// h is φ; with a half-saturation K it is c²/(K² + c²), c = 1 + φ.
    pub half: Option<D>,
}

impl<D: Number> Coupling<D> {
    /// B h and B times its first two derivatives at φ.
    pub fn at(&self, phi: D) -> [D; 3] {
        let Some(half) = self.half else { return [self.strength * phi, self.strength, D::from(0.0)] };
        let (c, square) = (phi + 1.0, half * half);
        let share = (c * c + square).recip();
        let slope = c * square * share * share * 2.0;
        let bend = (square - c * c * 3.0) * square * share * share * share * 2.0;
        [c * c * share, slope, bend].map(|h| self.strength * h)
    }
}

/// A regulator with areal concentration c on the cortex, relative to its resting value, φ = c − 1. It is advected by the flow,
/// diffuses, turns over, and modulates fields of the cortex.
#[derive(Clone, Debug, PartialEq)]
pub struct Regulator<D = f64> {
    /// Its source; without a source its resting state is uniform.
    pub source: Option<Source<D>>,
    /// Turnover k, in 1/τ.
    pub turnover: D,
    /// Diffusion D, in L_h²/τ.
    pub diffusion: D,
    /// Whether it is a concentration, which converging flow increases, rather than a label of the material.
    pub diluted: bool,
    /// Its effects, at most one per field.
    pub couplings: Vec<Coupling<D>>,
}

/// A number of a regulator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RegulatorQuantity {
    /// A number of its source.
    Source(Quantity),
    /// Turnover k.
    Turnover,
    /// Diffusion D.
    Diffusion,
    /// Strength B of the coupling to a field.
    Strength(Field),
    /// Half-saturation K of the coupling to a field.
    Half(Field),
}

impl RegulatorQuantity {
    /// All numbers, in the order of the printed text.
    pub fn all() -> impl Iterator<Item = RegulatorQuantity> {
        let source = Quantity::ALL.into_iter().map(RegulatorQuantity::Source);
        let own = [RegulatorQuantity::Turnover, RegulatorQuantity::Diffusion];
        let of = |field| [RegulatorQuantity::Strength(field), RegulatorQuantity::Half(field)];
        source.chain(own).chain(Field::ALL.into_iter().flat_map(of))
    }

    /// Its name on the command line: `turnover`, for a coupling the field, `kappa`, and for a half-saturation `kappa.half`.
    pub fn name(self) -> &'static str {
        const HALVES: [&str; 9] = [
            "kappa.half",
            "activity.half",
            "xi_s.half",
            "xi_b.half",
            "eta_b.half",
            "eta_s.half",
            "viscosity.half",
            "friction.half",
            "tension.half",
        ];
        match self {
            RegulatorQuantity::Source(quantity) => quantity.name(),
            RegulatorQuantity::Turnover => "turnover",
            RegulatorQuantity::Diffusion => "diffusion",
            RegulatorQuantity::Strength(field) => field.name(),
            RegulatorQuantity::Half(field) => HALVES[field as usize],
        }
    }

    /// The number with a given name.
    pub fn named(name: &str) -> Option<RegulatorQuantity> {
        let of_par = || Some(RegulatorQuantity::Source(Quantity::Par(ParConstant::named(name)?)));
        RegulatorQuantity::all().find(|quantity| quantity.name() == name).or_else(of_par)
    }
}

impl Regulator {
    /// The numbers that it has.
    pub fn quantities(&self) -> impl Iterator<Item = RegulatorQuantity> {
        RegulatorQuantity::all().filter(|quantity| self.quantity(*quantity).is_some())
    }

    /// The same regulator with its couplings in the order of [`Field::ALL`].
    pub(super) fn sorted(mut self) -> Regulator {
        self.couplings.sort_by_cached_key(|coupling| coupling.field as usize);
        self
    }

    /// The regulator with all its strengths multiplied by `factor`.
    pub(super) fn scaled(&self, factor: f64) -> Regulator {
        let scaled = |coupling: &Coupling| Coupling { strength: factor * coupling.strength, ..*coupling };
        Regulator { couplings: self.couplings.iter().map(scaled).collect(), ..self.clone() }
    }

    /// The same regulator without couplings of strength 0 and without a source of amplitude 0. `None` if it acts on no field and no law
    /// uses it, or if it is a label without a source, for which φ = 0.
    pub(super) fn simplified(&self, named: bool) -> Option<Regulator> {
        let acts = |coupling: &&Coupling| coupling.strength != 0.0;
        let couplings: Vec<Coupling> = self.couplings.iter().filter(acts).copied().collect();
        // The rate of the source is k A f.
        let source = self.source.filter(|source| source.amplitude != 0.0 && self.turnover != 0.0);
        ((named || !couplings.is_empty()) && (self.diluted || self.turnover != 0.0)).then(|| Regulator {
            source,
            couplings,
            ..self.clone()
        })
    }

    /// The same regulator with converted numbers; the conversion also gets the kind of each number.
    pub fn map<E>(&self, mut number: impl FnMut(RegulatorQuantity, f64) -> E) -> Regulator<E> {
        use RegulatorQuantity::{Diffusion, Half, Strength, Turnover};
        Regulator {
            source: self.source.map(|source| Source {
                profile: source.profile.map(|quantity, v| number(RegulatorQuantity::Source(quantity), v)),
                amplitude: number(RegulatorQuantity::Source(Quantity::Amplitude), source.amplitude),
            }),
            turnover: number(Turnover, self.turnover),
            diffusion: number(Diffusion, self.diffusion),
            diluted: self.diluted,
            couplings: (self.couplings.iter())
                .map(|coupling| Coupling {
                    field: coupling.field,
                    strength: number(Strength(coupling.field), coupling.strength),
                    half: coupling.half.map(|half| number(Half(coupling.field), half)),
                })
                .collect(),
        }
    }

    /// A number of the regulator; `None` if it lacks this number.
    pub fn quantity(&self, quantity: RegulatorQuantity) -> Option<f64> {
        self.clone().quantity_mut(quantity).copied()
    }

    /// Mutable access to such a number.
    pub(crate) fn quantity_mut(&mut self, quantity: RegulatorQuantity) -> Option<&mut f64> {
        let mut couplings = self.couplings.iter_mut();
        match quantity {
            RegulatorQuantity::Source(Quantity::Amplitude) => self.source.as_mut().map(|source| &mut source.amplitude),
            RegulatorQuantity::Source(other) => self.source.as_mut()?.profile.quantity_mut(other),
            RegulatorQuantity::Turnover => Some(&mut self.turnover),
            RegulatorQuantity::Diffusion => Some(&mut self.diffusion),
            RegulatorQuantity::Strength(field) => {
                couplings.find(|coupling| coupling.field == field).map(|coupling| &mut coupling.strength)
            }
            RegulatorQuantity::Half(field) => {
                couplings.find(|coupling| coupling.field == field).and_then(|coupling| coupling.half.as_mut())
            }
        }
    }

    /// The mirror image of the regulator, u → 1 − u.
    pub fn mirrored(&self) -> Regulator {
        let source = self.source.map(|Source { profile, amplitude }| {
            let (profile, sign) = profile.mirrored();
            Source { profile, amplitude: sign * amplitude }
        });
        Regulator { source, ..self.clone() }
    }
}
