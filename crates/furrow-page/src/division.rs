//! One division and the data of its film: contour, cue and active force at every step.

use furrow_bvp::{Gauss, Solution};
use furrow_cell::{Cell, CueError, Numerics};
use furrow_input::InputError;
use furrow_lineage::batch::Quantisation;
use furrow_lineage::{FounderPhysics, Lineage, parse_cue};
use furrow_mechanics::cortex::equations::{LENGTH, M, PSI, R, REGULATED, Z};
use furrow_mechanics::cortex::forces::own_stress;
use furrow_mechanics::cortex::observables::regulator_at;
use furrow_mechanics::cortex::{Cortex, Domain, Wall};
use furrow_mechanics::division::{DivisionInput, DivisionOptions, Frame, divide_with};
use furrow_mechanics::polarity::resolved;
use serde::Deserialize;
use serde_json::json;
use std::borrow::Cow;

use super::answer::{Answer, PageError};
use super::limits::check;

/// Equal parts in u of a contour that is drawn.
const PARTS: usize = 160;
/// Further points on either side of the furrow, and their reach in u.
const NEAR: (usize, f64) = (14, 0.04);
/// Arrows of the active force along a contour.
const ARROWS: usize = 36;
/// Arrows on either side of the furrow, which replace the regular ones there: their distances from it in u.
const ARROWS_NEAR: [f64; 4] = [0.009, 0.02, 0.034, 0.05];
/// Distance in u over which the active tension is differentiated.
const STEP: f64 = 1e-5;

/// The shapes of the division that the answer holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Wanted {
    /// After every step.
    #[default]
    All,
    /// The last one: enough to follow a slider.
    Last,
}

#[derive(Debug, Deserialize)]
struct Request {
    cell: Cell,
    numerics: Numerics,
    seed: u64,
    /// The changes that a cell's founder makes to the physics.
    #[serde(default)]
    physics: FounderPhysics,
    /// Relative step to which R0 is rounded, as before a division of a tree is solved.
    #[serde(default)]
    r0_step: f64,
    #[serde(default)]
    frames: Wanted,
    /// Replaces the cell's cue: a name of the lineage, or terms, as in `--cue`.
    cue: Option<String>,
    /// The lineage that defines names and units of cues.
    lineage: Option<Lineage>,
}

/// Computes a division and answers with its record and, as numbers, the drawing of its steps.
///
/// # Errors
/// The request cannot be read, the cell is outside the allowed ranges, or the division cannot be computed.
pub fn divide(request: &[u8]) -> Result<Answer, PageError> {
    let Request { mut cell, numerics, seed, physics, r0_step, frames: wanted, cue, lineage } =
        serde_json::from_slice(request)?;
    if let Some(text) = cue {
        let wrong = |error: CueError| InputError::not_allowed("--cue", error.field, error.value, error.allowed);
        cell.cue = lineage.map_or_else(|| text.parse().map_err(wrong), |lineage| parse_cue(&text, &lineage))?;
    }
    physics.apply(&mut cell);
    // A slider can leave the allowed ranges; the cells of a tree are as its lineage gives them.
    if wanted == Wanted::Last {
        check(&cell, &numerics)?;
    }
    cell.r0 = Quantisation::with_relative_step(r0_step).unwrap_or(Quantisation::EXACT).apply(cell.r0);
    let input = DivisionInput { cell, numerics, seed };
    let mut shapes: Vec<(f64, Solution)> = Vec::new();
    let mut frames = Vec::new();
    let mut observe = |frame: Frame<'_>| {
        if wanted == Wanted::Last {
            shapes.clear();
            frames.clear();
        }
        frames.push(json!({ "t": frame.t, "neck": frame.neck.map(|neck| neck.radius) }));
        shapes.push((frame.t, frame.shape.clone()));
    };
    let (division, _) = divide_with(&input, DivisionOptions::observed_by(&mut observe))?;
    let film = Film::new(&input, division.u_furrow());
    let mut numbers = Vec::new();
    for (t, shape) in &shapes {
        film.draw(shape, *t > 0.0, &mut numbers);
    }
    // The wall of the shell as r and z from the pole u = 0 to the other, in L_h; time, in τ, and radius of the neck, in
    // L_h, of each step. The numbers of a frame are (r, z, drawn cue) at each point, then (r, z, force along r, force
    // along z) at each arrow, then, with a regulator, φ at each point.
    let mut found = serde_json::to_value(&division)?;
    found["cue"] = json!(input.cell.cue);
    found["wall"] = json!(Wall::of(&film.cortex).contour());
    found["frames"] = json!(frames);
    found["points"] = json!(film.places.len());
    found["arrows"] = json!(film.arrows.len());
    found["regulated"] = json!(film.cortex.is_regulated());
    Ok(Answer { text: found.to_string(), numbers })
}

/// Samples shapes at fixed places u.
struct Film {
    gauss: Gauss,
    cortex: Cortex,
    /// Places u of the points of a contour.
    places: Vec<f64>,
    /// Places u where arrows begin.
    arrows: Vec<f64>,
}

impl Film {
    fn new(input: &DivisionInput, furrow: Option<f64>) -> Film {
        let mut places: Vec<f64> = (0..=PARTS).map(|k| k as f64 / PARTS as f64).collect();
        if let Some(furrow) = furrow {
            let (count, reach) = NEAR;
            // Denser towards the furrow, where the contour turns within a thousandth of its length.
            let offset = |k: usize| reach * (k as f64 / count as f64).powi(2);
            places.extend((0..=count).flat_map(|k| [furrow - offset(k), furrow + offset(k)]));
            places.retain(|u| (0.0..=1.0).contains(u));
            places.sort_by(f64::total_cmp);
            places.dedup();
        }
        let gauss = Gauss::new(input.numerics.stages).unwrap_or_default();
        // The division has succeeded, so that the cue's position can be resolved.
        let cell = resolved(&input.cell).unwrap_or(Cow::Borrowed(&input.cell));
        Film { gauss, cortex: Cortex::new(&cell, Domain::Full, &[]), places, arrows: Self::arrows(furrow) }
    }

    /// Where arrows begin: evenly along the contour, and closer at the furrow, where the force is greatest.
    fn arrows(furrow: Option<f64>) -> Vec<f64> {
        let mut arrows: Vec<f64> = (0..ARROWS).map(|k| (k as f64 + 0.5) / ARROWS as f64).collect();
        if let Some(furrow) = furrow {
            let [.., farthest] = ARROWS_NEAR;
            arrows.retain(|u| (u - furrow).abs() > 1.2 * farthest);
            arrows.push(furrow);
            arrows.extend(ARROWS_NEAR.iter().flat_map(|near| [furrow - near, furrow + near]));
            // Not at a pole, where r = 0 is a divisor.
            arrows.retain(|u| (0.005..=0.995).contains(u));
        }
        arrows
    }

    /// Adds the numbers of a shape. Before the activity is switched on there is neither cue nor active force.
    fn draw(&self, shape: &Solution, active: bool, numbers: &mut Vec<f32>) {
        let (mut state, n) = ([0.0; REGULATED], shape.components);
        let length = shape.scalars[LENGTH];
        let terms = self.cortex.cell.cue.terms();
        for &u in &self.places {
            shape.eval(&self.gauss, u, &mut state[..n]);
            let cue: f64 = if active { terms.iter().map(|term| term.at(u, length)[0]).sum() } else { 0.0 };
            numbers.extend([state[R], state[Z], cue].map(|v| v as f32));
        }
        for &u in &self.arrows {
            let [along_r, along_z] = if active { self.active_force(shape, u) } else { [0.0; 2] };
            shape.eval(&self.gauss, u, &mut state[..n]);
            numbers.extend([state[R], state[Z], along_r, along_z].map(|v| v as f32));
        }
        let phi = |u: &f64| regulator_at(&self.gauss, shape, Domain::Full, *u);
        numbers.extend(self.places.iter().filter_map(phi).map(|phi| phi as f32));
    }

    /// Active tensions T^a_uu = X_s(½C − c2) + X_b C and T^a_φφ = −X_s(½C − c2) + X_b C at u, or by the cell's own law.
    fn active_tensions(&self, shape: &Solution, u: f64) -> [f64; 2] {
        let (mut state, n) = ([0.0; REGULATED], shape.components);
        shape.eval(&self.gauss, u, &mut state[..n]);
        if let Some([stress, _]) = own_stress(&self.cortex, u, &state[..n], shape.scalars[LENGTH]) {
            return stress;
        }
        let here = self.cortex.constants().of_state(u, &state[..n], shape.scalars[LENGTH]);
        let mean = here.mean(state[M]);
        let deviator = here.xi_s * (0.5 * mean - state[PSI].sin() / state[R]);
        [deviator + here.xi_b * mean, here.xi_b * mean - deviator]
    }

    /// Whether the law uses rates of strain.
    fn needs_motion(&self) -> bool {
        self.cortex.constants().law.as_ref().is_some_and(|law| law.viscous)
    }

    /// Active force density div T^a at u, along r and z. With the outward normal n = (sinψ, cosψ) and the tangent
    /// t = (cosψ, −sinψ) it is (∂_s T^a_uu + (cosψ/r)(T^a_uu − T^a_φφ)) t − (c1 T^a_uu + c2 T^a_φφ) n.
    fn active_force(&self, shape: &Solution, u: f64) -> [f64; 2] {
        let (mut state, n) = ([0.0; REGULATED], shape.components);
        shape.eval(&self.gauss, u, &mut state[..n]);
        let length = shape.scalars[LENGTH];
        let (sin, cos) = state[PSI].sin_cos();
        let c2 = sin / state[R];
        let c1 = match own_stress(&self.cortex, u, &state[..n], length) {
            // The rates of strain are not known from one shape.
            Some(_) if self.needs_motion() => return [0.0; 2],
            Some([_, [mean, _]]) => mean - c2,
            None => self.cortex.constants().of_state(u, &state[..n], length).mean(state[M]) - c2,
        };
        let [t_u, t_phi] = self.active_tensions(shape, u);
        let [before, after] = [u - STEP, u + STEP].map(|u| self.active_tensions(shape, u)[0]);
        let tangential = (after - before) / (2.0 * STEP * length) + cos / state[R] * (t_u - t_phi);
        let normal = -(c1 * t_u + c2 * t_phi);
        [tangential * cos + normal * sin, normal * cos - tangential * sin]
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use furrow_cell::Cue;
    use furrow_mechanics::cortex::equations::COMPONENTS;
    use furrow_mechanics::division::divide as divide_alone;
    use serde_json::Value;

    /// Numbers of a point and of an arrow.
    const OF_EACH: [usize; 2] = [3, 4];

    fn asked(cell: &Cell, frames: &str) -> (Value, Vec<f32>) {
        let request = json!({ "cell": cell, "numerics": Numerics::default(), "seed": 0, "frames": frames });
        let answer = divide(request.to_string().as_bytes()).unwrap();
        (serde_json::from_str(&answer.text).unwrap(), answer.numbers)
    }

    /// The wall of an egg is wider towards the pole u = 0, at z > 0, and ends at both poles.
    #[test]
    fn the_wall_is_that_of_the_profile() {
        let wall =
            |cell: &Cell| -> Vec<[f64; 2]> { serde_json::from_value(asked(cell, "last").0["wall"].take()).unwrap() };
        let row = |k: usize| {
            let (sin, cos) = (k as f64 * PI / 24.0).sin_cos();
            format!("{},{}\n", 1.505 * cos, if k.is_multiple_of(24) { 0.0 } else { sin * (1.0 + 0.2 * cos).sqrt() })
        };
        let table = format!("z,r\n{}", (0..=24).map(row).collect::<String>());
        let egg = furrow_cell::ShellProfile::from_table(table.as_bytes(), "egg", "egg.csv").unwrap();
        let cell = Cell::new(2.5);
        let widest = |wall: &[[f64; 2]]| {
            wall.iter().copied().fold([0.0; 2], |most, place| if place[0] > most[0] { place } else { most })
        };
        let [_, z] = widest(&wall(&cell.clone().with_shell_profile(egg)));
        assert!(z > 0.2, "{z}");
        let ellipse = wall(&cell);
        let [along, across] =
            [cell.shell.aspect, 1.0].map(|axis| axis * (cell.r0.powi(3) / (cell.epsilon * cell.shell.aspect)).cbrt());
        assert!((widest(&ellipse)[0] / across - 1.0).abs() < 1e-12 && widest(&ellipse)[1].abs() < 1e-12);
        assert!((ellipse[0][1] / along - 1.0).abs() < 1e-12 && (ellipse[48][1] / along + 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_record_equals_the_division() {
        let cell = Cell::gao2026_thresholds(2.0).with_cue(Cue::published());
        let (found, numbers) = asked(&cell, "all");
        let alone = divide_alone(&DivisionInput::new(cell)).unwrap();
        assert_eq!(found["chi"].as_f64(), alone.chi());
        let [contour, arrows] = ["points", "arrows"].map(|name| found[name].as_u64().unwrap() as usize);
        let (contour, arrows) = (OF_EACH[0] * contour, OF_EACH[1] * arrows);
        let of_frame = contour + arrows;
        let frames = found["frames"].as_array().unwrap();
        assert_eq!(numbers.len(), frames.len() * of_frame);
        assert!(numbers.iter().all(|number| number.is_finite()));
        // Pinch-off lies within the last step.
        assert!((frames.last().unwrap()["t"].as_f64().unwrap() - alone.t_end).abs() < 1e-3 * alone.t_end);
        // From pole to pole, at every step.
        for frame in numbers.chunks_exact(of_frame) {
            assert!(frame[0].abs() < 1e-6 && frame[contour - OF_EACH[0]].abs() < 1e-6);
        }
    }

    /// φ is 0 at the start; at the furrow it ends near the recorded value at pinch-off, which lies within the last
    /// step.
    #[test]
    fn a_regulator_is_sent_with_every_frame_and_its_text_is_read() {
        let text = "regulator:step,u0=0.4,omega=0.1,amplitude=1,turnover=10,diffusion=1,activity=0.3";
        let cell = Cell::gao2026_thresholds(3.0).with_cue(text.parse().unwrap());
        let (found, numbers) = asked(&cell, "all");
        let [points, arrows] = ["points", "arrows"].map(|name| found[name].as_u64().unwrap() as usize);
        let of_frame = (OF_EACH[0] + 1) * points + OF_EACH[1] * arrows;
        assert_eq!(found["regulated"], true);
        assert_eq!(numbers.len(), found["frames"].as_array().unwrap().len() * of_frame);
        let phi = |frame: &[f32]| frame[of_frame - points..].to_vec();
        assert!(phi(&numbers[..of_frame]).iter().all(|phi| *phi == 0.0));
        let film = Film::new(&DivisionInput::new(cell.clone()), found["u_furrow"].as_f64());
        let furrow = film.places.iter().position(|u| Some(*u) == found["u_furrow"].as_f64()).unwrap();
        let times: Vec<f64> = found["frames"].as_array().unwrap().iter().map(|f| f["t"].as_f64().unwrap()).collect();
        let [before, last] =
            [2, 1].map(|k| (times[times.len() - k], &numbers[numbers.len() - k * of_frame..][..of_frame]));
        let [from, to] = [before.1, last.1].map(|frame| f64::from(phi(frame)[furrow]));
        let share = (found["t_end"].as_f64().unwrap() - before.0) / (last.0 - before.0);
        let at_end = from + share * (to - from);
        assert!((at_end - found["phi"].as_f64().unwrap()).abs() < 1e-5, "{at_end} {}", found["phi"]);
        let ask = |cue: &str| {
            let plain = Cell::gao2026_thresholds(3.0);
            divide(
                json!({ "cell": plain, "numerics": Numerics::default(), "seed": 0, "cue": cue }).to_string().as_bytes(),
            )
        };
        assert_eq!(ask(text).unwrap().numbers, numbers);
        let refused = ask("regulator:none,turnover=10,diffusion=0.01,activity=0.3").unwrap_err();
        assert!(refused.to_string().starts_with("--cue: regulator.diffusion = 0.01: must be"), "{refused}");
    }

    #[test]
    fn a_cue_may_be_a_name_of_the_lineage() {
        let lineage = Lineage::c_elegans().unwrap();
        let ask = |cue: &str| {
            let request = json!({ "cell": Cell::gao2026_thresholds(1.5), "numerics": Numerics::default(), "seed": 0, "frames": "last", "cue": cue, "lineage": lineage });
            divide(request.to_string().as_bytes())
        };
        let found: Value = serde_json::from_str(&ask("germline").unwrap().text).unwrap();
        assert_eq!(found["cue"], json!(Cue::published()));
        assert_eq!(ask("germline").unwrap().numbers, ask("kappa:u0=0.465,omega=0.0577,amplitude=0.1").unwrap().numbers);
        let refused = ask("germlin").unwrap_err().to_string();
        assert!(refused.starts_with("--cue: cue = \"germlin\": must be none, germline, or terms"), "{refused}");
    }

    #[test]
    fn the_last_frame_alone_is_the_last_of_all() {
        let cell = Cell::gao2026_thresholds(1.5);
        let ((all, every), (last, one)) = (asked(&cell, "all"), asked(&cell, "last"));
        assert_eq!(last["frames"].as_array().unwrap().len(), 1);
        assert_eq!(all["outcome"], last["outcome"]);
        assert_eq!(every[every.len() - one.len()..], one);
    }

    /// On a sphere everything is known: C = 2/R, both tensions are X_b C, and the force is −X_b C² along the normal.
    #[test]
    fn a_sphere_is_pressed_by_its_isotropic_activity() {
        let radius = 2.0;
        let cell = Cell::gao2026_thresholds(radius);
        let film = Film::new(&DivisionInput::new(cell), None);
        let gauss = Gauss::default();
        let mesh = furrow_bvp::mesh::uniform(0.0, 1.0, 48);
        let sphere = Solution::from_fn(&gauss, &mesh, COMPONENTS, &[PI * radius, 0.0], |u, state| {
            let (sin, cos) = (PI * u).sin_cos();
            state.fill(0.0);
            (state[R], state[Z], state[M], state[PSI]) = (radius * sin, radius * cos, 2.0 / radius, PI * u);
        })
        .unwrap();
        let xi_b = film.cortex.constants().uniform.xi_b;
        for u in [0.1, 0.37, 0.5, 0.8] {
            let [along_r, along_z] = film.active_force(&sphere, u);
            let (sin, cos) = (PI * u).sin_cos();
            let expected = -xi_b * (2.0 / radius).powi(2);
            assert!((along_r - expected * sin).abs() < 1e-6 && (along_z - expected * cos).abs() < 1e-6);
        }
    }

    /// A cue that follows PAR polarity is drawn at its resolved position.
    #[test]
    fn a_cue_that_follows_par_is_drawn() {
        let cell = Cell::new(5.4).with_cue("kappa:par_band,amplitude=0.1".parse().unwrap());
        let film = Film::new(&DivisionInput::new(cell), None);
        let shape = furrow_mechanics::equilibria::passive(&film.cortex.cell, &Numerics::default()).unwrap().0;
        let mut numbers = Vec::new();
        film.draw(&furrow_mechanics::cortex::symmetry::unfold(&shape), true, &mut numbers);
        let painted = numbers[..3 * film.places.len()].chunks_exact(3).map(|point| point[2]).fold(0.0, f32::max);
        assert!((painted - 0.1).abs() < 1e-3, "{painted}");
    }
}
