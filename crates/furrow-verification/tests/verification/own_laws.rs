//! Laws of active stress as text: virtual power on computed shapes with the law stated again here, and derivatives against
//! differences on random states.

use furrow_cell::{Cell, Law, Parameter};
use furrow_mechanics::cortex::equations::{Carried, PHI, PSI, R};
use furrow_mechanics::cortex::{Cortex, Domain};
use furrow_verification::contour::{Computed, Place};
use furrow_verification::report::within;
use furrow_verification::states::{Draws, moving, resting, uneven_cell};
use furrow_verification::virtual_power::{Motion, motions, power};

use crate::differences::largest_error;

/// A law as text, and the same in Rust: T_uu and T_φφ at a place, M of C with its integral, and the normal force. Numbers of the
/// cell are g ξ_s and g ξ_b at the place.
struct Stated {
    text: &'static str,
    stress: fn(&Place, [f64; 2]) -> [f64; 2],
    moment: fn(f64) -> [f64; 2],
    force: fn(&Place) -> f64,
}

fn nothing(_: f64) -> [f64; 2] {
    [0.0; 2]
}

/// The paper's stress.
fn paper(place: &Place, [xi_s, xi_b]: [f64; 2]) -> [f64; 2] {
    let [c1, c2] = place.curvature;
    let (deviator, isotropic) = (0.5 * xi_s * (c1 - c2), xi_b * (c1 + c2));
    [isotropic + deviator, isotropic - deviator]
}

const LAWS: [Stated; 4] = [
    // Curvature, place and fields.
    Stated {
        text: r#"Law(name: "a", constants: { "h": (value: 3.0) },
            stress_uu: "gain*(xi_s*(c1 - c2)/2 + xi_b*C)*exp(-(C/h)^2) + 0.1*xi_s*r^2*tanh(u)/(1 + s^2) + 0.04*xi_s*sin(z) + 0.3*kappa*sqrt(friction)",
            stress_phiphi: "gain*(xi_b*C - xi_s*(c1 - c2)/2)*exp(-(C/h)^2) + 0.1*xi_s*r^2*tanh(u)/(1 + s^2) + 0.04*xi_s*sin(z) + 0.3*kappa*sqrt(friction)",
            normal_force: "0.02*xi_s*c1*c2 - 0.1*cos(pi*u)")"#,
        stress: |place, xi| {
            let ([c1, c2], gain) = (place.curvature, GAIN);
            let fade = (-((c1 + c2) / 3.0).powi(2)).exp();
            let s = place.u * place.length;
            let there = 0.1 * place.r * place.r * place.u.tanh() / (1.0 + s * s) + 0.04 * place.z.sin();
            let pull = xi[0] / gain * there;
            paper(place, xi).map(|t| t * fade + pull + 0.3 * place.here.kappa * place.here.friction.sqrt())
        },
        moment: nothing,
        force: |place| {
            let xi_s = place.here.xi_s / GAIN;
            0.02 * xi_s * place.curvature[0] * place.curvature[1] - 0.1 * (std::f64::consts::PI * place.u).cos()
        },
    },
    // Rates of strain, not linearly.
    Stated {
        text: r#"Law(name: "b", constants: { "n": (value: 0.4) },
            stress_uu: "gain*(xi_s*(c1 - c2)/2 + xi_b*C) + n*tanh(2*S_uu + S_phiphi) + n*S_uu^3",
            stress_phiphi: "gain*(xi_b*C - xi_s*(c1 - c2)/2) + n*tanh(2*S_phiphi + S_uu) + n*S_phiphi^3")"#,
        stress: |place, xi| {
            let [a, b] = place.strain;
            let [uu, pp] = paper(place, xi);
            [uu + 0.4 * ((2.0 * a + b).tanh() + a.powi(3)), pp + 0.4 * ((2.0 * b + a).tanh() + b.powi(3))]
        },
        moment: nothing,
        force: |_| 0.0,
    },
    // A moment of the curvature.
    Stated {
        text: r#"Law(name: "c", stress_uu: "gain*(xi_s*(c1 - c2)/2 + xi_b*C)", stress_phiphi: "gain*(xi_b*C - xi_s*(c1 - c2)/2)",
            moment: "0.2*C + 0.05*C^3 - 0.4")"#,
        stress: paper,
        moment: |c| [0.2 * c + 0.05 * c.powi(3) - 0.4, 0.1 * c * c + 0.0125 * c.powi(4) - 0.4 * c],
        force: |_| 0.0,
    },
    // A regulator, and its product with a painted field.
    Stated {
        text: r#"Law(name: "d", stress_uu: "gain*(1 + phi)^2*xi_s*(c1 - c2)/2", stress_phiphi: "-gain*(1 + phi)^2*xi_s*(c1 - c2)/2")"#,
        stress: |place, xi| {
            let factor = (1.0 + place.phi).powi(2);
            paper(place, [xi[0], 0.0]).map(|t| t * factor)
        },
        moment: nothing,
        force: |_| 0.0,
    },
];

/// Gain of [`uneven_cell`]s.
const GAIN: f64 = 0.5;

/// A cell of each law with the cues it goes with.
fn cells(xi_s: f64) -> Vec<(&'static Stated, Cell)> {
    let painted = "activity:band,u0=0.44,omega=0.3,amplitude=0.2+kappa:band,u0=0.44,omega=0.3,amplitude=0.1";
    let both = "xi_s:band,u0=0.47,omega=0.2,amplitude=0.3+regulator:none,turnover=4,diffusion=0.7,activity=0";
    let carried = "regulator:band,u0=0.44,omega=0.3,amplitude=0.5,turnover=4,diffusion=0.7,kappa=0.2";
    let cues = [
        ["none", painted],
        ["none", "viscosity:gradient,amplitude=0.25"],
        ["none", "friction:gradient,amplitude=0.3"],
        [carried, both],
    ];
    let of = |(law, cues): (&'static Stated, [&str; 2])| {
        cues.map(|cue| {
            let mut cell = uneven_cell(2.0, xi_s, cue).unwrap();
            cell.material.gain = GAIN;
            (law, cell.with_law(Law::parse(law.text, "law.ron").unwrap()))
        })
    };
    LAWS.iter().zip(cues).flat_map(of).collect()
}

/// The power of a law on a virtual motion.
fn active(law: &Stated, state: &Computed, motion: impl Fn(f64) -> Motion) -> f64 {
    let mut sum = 0.0;
    for (k, place) in state.places().iter().enumerate() {
        let Motion { outwards: [n, n_u, n_uu], along: [v, v_u] } = motion(place.u);
        let (length, [c1, c2], cot) = (state.length(), place.curvature, place.normal[1] / place.r);
        let strain = [v_u / length + c1 * n, cot * v + c2 * n];
        let noise = state.noise.get(k).copied().unwrap_or(1.0);
        let [uu, pp] = (law.stress)(place, [place.here.xi_s, place.here.xi_b]);
        let [moment, integral] = (law.moment)(c1 + c2);
        let laplacian = n_uu / (length * length) + cot * n_u / length;
        let bent = moment * (-laplacian - (c1 * c1 + c2 * c2) * n) - integral * (v_u / length + cot * v);
        let pushed = noise * ((law.force)(place) * n - uu * strain[0] - pp * strain[1]);
        sum += place.area * (bent - pushed);
    }
    sum
}

/// The largest imbalance of a state over all motions, relative to the largest of all powers.
fn worst(law: &Stated, state: &Computed) -> f64 {
    // Without the law and its activity, the powers of everything else.
    let mut passive = state.clone();
    (passive.cell.law, passive.cell.xi_s) = (None, 0.0);
    let of = |motion: &dyn Fn(f64) -> Motion| {
        let others = power(&passive, motion);
        let own = active(law, state, motion);
        let size = others.parts().iter().fold(own.abs(), |most: f64, part| most.max(part.abs()));
        [(others.parts().iter().sum::<f64>() + own).abs(), size]
    };
    let all: Vec<[f64; 2]> = motions().iter().map(|motion| of(&**motion)).collect();
    let most = |k: usize| all.iter().fold(0.0f64, |most, pair| most.max(pair[k]));
    most(0) / most(1)
}

#[test]
fn forces_of_own_laws_do_no_work_at_rest_and_in_motion() {
    let mut largest = 0.0f64;
    for (law, cell) in cells(8.0) {
        let state = resting(&cell).unwrap();
        println!("{} {}: {:.1e}", cell.law.as_ref().unwrap().name(), cell.cue, worst(law, &state));
        largest = largest.max(worst(law, &state));
    }
    for (law, cell) in cells(18.0) {
        let state = moving(&cell, 5).unwrap();
        println!("{} {} moving: {:.1e}", cell.law.as_ref().unwrap().name(), cell.cue, worst(law, &state));
        largest = largest.max(worst(law, &state));
    }
    within("virtual power of own laws", largest, 1e-8);
}

#[test]
fn jacobians_of_own_laws_are_their_differences() {
    let (mut draws, mut largest) = (Draws(11), 0.0f64);
    for (_, cell) in cells(21.0) {
        let mut free = vec![Parameter::XiS, Parameter::R0, Parameter::Kappa, Parameter::Gain, Parameter::EtaS];
        free.extend(cell.law.iter().flat_map(|law| law.parameters()));
        free.extend(Parameter::of_cue(&cell.cue));
        let mut cortex = Cortex::new(&cell, Domain::Full, &free);
        (cortex.rate, cortex.past, cortex.noise) = (3.0, vec![[1.1, -0.2]], vec![1.03]);
        cortex.carried_past = vec![Carried { amount: 8.3, r_u: 5.1, z_u: -2.7 }];
        let n = cortex.components();
        for _ in 0..3 {
            let mut y: Vec<f64> = (0..n).map(|_| draws.between(-1.0, 1.0)).collect();
            y.iter_mut().skip(PHI).for_each(|phi| *phi *= 0.5);
            (y[R], y[PSI]) = (draws.between(0.5, 2.0), draws.between(0.1, 3.0));
            let mut p = vec![draws.between(6.0, 8.0), draws.between(0.0, 3.0)];
            p.extend(free.iter().map(|parameter| parameter.get(&cell)));
            largest = largest.max(largest_error(&mut cortex, &y, &p, 1e-4));
        }
    }
    within("own laws by differences", largest, 1e-6);
}
