// "What if": sliders of a cell, its division while they move, and the cell's place on the phase diagram.

/** The cue's fields by what they do, for the list. */
const FIELDS = ["kappa", "activity", "xi_s", "xi_b", "eta_b", "eta_s", "viscosity", "friction", "tension"];

class WhatIf {
  constructor(solver, edges) {
    this.solver = solver;
    this.edges = edges;
    this.head = page.head;
    this.founder = {};
    this.physics = {};
    /** What the sliders are at: lengths in Lₕ. */
    this.values = {};
    this.diagram = new PhaseDiagram(element("phase"), (r0, xi) => {
      this.set("r0", r0);
      this.set("xi_s", xi);
      this.changed();
    });
    this.recording = null;
    new ResizeObserver(() => this.draw()).observe(element("what-if-cell"));
    element("cue-field").replaceChildren(...FIELDS.map((name) => make("option", name)));
    for (const input of element("what-if").querySelectorAll("[data-quantity]")) {
      input.addEventListener("input", () => this.moved(input));
    }
    for (const id of ["cue-on", "cue-field", "cue-profile"]) element(id).addEventListener("input", () => this.changed());
    // Before the sliders' own listeners are told: whoever moves one means it.
    element("cue-fields").addEventListener("input", ({ target }) => {
      if (target.id !== "cue-text") element("cue-text").value = "";
    }, { capture: true });
    element("cue-text").addEventListener("change", () => this.changed());
    element("what-if-reset").addEventListener("click", () => this.begin(this.start));
    this.dividing = new Latest(solver, (request, isLast) => this.divide(request, isLast));
    this.following = new Latest(edges, (epsilon) => this.followEdge(epsilon));
    element("what-if-settings").addEventListener("click", () => save("furrow.ron", this.configuration(), "text/plain"));
    element("what-if-picture").addEventListener("click", () => savePicture("furrow-cell.png", (canvas, size) => this.drawInto(canvas, size), element("what-if-cell")));
  }

  inputs(quantity) {
    return [...element("what-if").querySelectorAll(`[data-quantity="${quantity}"]`)];
  }

  /** What one of a quantity is in its inputs: R0 is in µm there where the lineage says how long Lₕ is. */
  unit(quantity) {
    return (quantity === "r0" && unitsOf(this.head.lineage).length_um) || 1;
  }

  /** Puts a value into a slider and the number beside it, which knows values between the slider's steps. */
  set(quantity, value) {
    const shown = Number((value * this.unit(quantity)).toFixed(4));
    for (const input of this.inputs(quantity)) input.value = shown;
    this.values[quantity] = Number(value.toFixed(6));
  }

  get(quantity) {
    return this.values[quantity];
  }

  moved(input) {
    const { quantity } = input.dataset;
    const value = Number(input.value);
    if (input.value === "" || !Number.isFinite(value)) return;
    for (const other of this.inputs(quantity)) if (other !== input) other.value = input.value;
    this.values[quantity] = Number((value / this.unit(quantity)).toFixed(6));
    this.changed();
  }

  /** Begins at a cell: {head, founder, r0, epsilon, xi_s, cue, name, physics}. */
  begin(start) {
    this.start = start;
    this.head = start.head ?? page.head;
    this.founder = start.founder ?? {};
    this.physics = start.physics ?? {};
    element("what-if-start").textContent = start.name ? `Starting from ${start.name}.` : "";
    this.widen(start);
    for (const quantity of ["r0", "epsilon", "xi_s"]) this.set(quantity, start[quantity]);
    this.putCue(start.cue);
    this.changed();
  }

  /** Makes room for a cell larger or more active than sliders and diagram reach. */
  widen({ r0, xi_s }) {
    for (const [axis, quantity, value] of [["r0", "r0", r0], ["xi", "xi_s", xi_s]]) {
      if (value > 0.9 * AXES[axis][1]) {
        AXES[axis][1] = Number((1.25 * value).toPrecision(2));
        if (axis === "r0") this.diagram.edge = null;
      }
      const [unit, slider] = [this.unit(quantity), this.inputs(quantity).find((input) => input.type === "range")];
      const [min, max] = AXES[axis].map((end) => end * unit);
      Object.assign(slider, { min, max, step: roundStep((max - min) / 1000) });
      for (const input of this.inputs(quantity)) input.dataset.unit = unit;
    }
    const { length_um } = unitsOf(this.head.lineage);
    element("r0-unit").replaceChildren(...(length_um ? ["µm"] : ["L", make("sub", "h")]));
    this.diagram.lengthUnit = length_um ?? null;
  }

  /** A cue of one term fills the sliders; one of several, a regulator, or one that follows PAR stands as text. */
  putCue(cue) {
    element("cue-on").checked = cue !== "none";
    const usual = "kappa:band,u0=0.465,omega=0.0577,amplitude=0.1";
    const isSlid = /^(?!regulator)\w+:(band|step|gradient)(,\w+=[-.e\d]+)*$/.test(cue);
    element("cue-text").value = isSlid || cue === "none" ? "" : cue;
    const [field, profile] = (isSlid ? cue : usual).split(/[:,]/);
    element("cue-field").value = field;
    element("cue-profile").value = profile;
    for (const entry of [...usual.split(",").slice(1), ...(isSlid ? cue.split(",").slice(1) : [])]) {
      const [quantity, value] = entry.split("=");
      this.set(quantity, Number(value));
    }
  }

  /** The cue as the command line takes it: its text, or else what the sliders say. */
  cue() {
    if (!element("cue-on").checked) return "none";
    const text = element("cue-text").value.trim();
    if (text) return text;
    const profile = element("cue-profile").value;
    const place = profile === "gradient" ? "" : `u0=${this.get("u0")},omega=${this.get("omega")},`;
    return `${element("cue-field").value}:${profile},${place}amplitude=${this.get("amplitude")}`;
  }

  /** The cell that the sliders say, with its cue as text. */
  cell() {
    return { ...inShell(this.head.cell, this.founder), r0: this.get("r0"), epsilon: this.get("epsilon"), xi_s: this.get("xi_s"), cue: this.cue() };
  }

  /** A cell whose cue is text, as the solver reads it: with the lineage, which has names for cues. */
  asText(cell) {
    return { cell: { ...cell, cue: "none" }, cue: cell.cue, lineage: this.head.lineage };
  }

  changed() {
    const cell = this.cell();
    element("cue-fields").disabled = !element("cue-on").checked;
    for (const quantity of ["u0", "omega"]) for (const input of this.inputs(quantity)) input.disabled = element("cue-profile").value === "gradient";
    this.wait();
    this.diagram.point = { r0: cell.r0, xi: cell.xi_s, outcome: null };
    this.diagram.draw();
    // ε and ξ_s of the sliders count, whatever the founder says of these two.
    const { epsilon, xi_s, ...physics } = this.physics;
    this.dividing.ask({ cell, physics, asked: performance.now() });
    this.following.ask(cell.epsilon);
  }

  /** Until there is an answer for this cell, that of the last one does not stand as if it were. */
  wait() {
    const result = element("what-if-result");
    result.dataset.state = "computing";
    result.setAttribute("aria-busy", "true");
    const since = performance.now();
    clearInterval(this.clock);
    this.clock = setInterval(() => {
      const seconds = Math.floor((performance.now() - since) / 1000);
      result.classList.add("waits");
      element("outcome").className = "outcome";
      element("outcome").textContent = seconds < 1 ? "computing…" : `computing… ${seconds} s`;
    }, 150);
  }

  /** There is an answer, or a refusal. */
  arrived() {
    const result = element("what-if-result");
    clearInterval(this.clock);
    result.classList.remove("waits");
    result.setAttribute("aria-busy", "false");
    result.dataset.state = "done";
  }

  async divide({ cell, physics, asked }, isLast) {
    const { numerics, seed } = this.head;
    try {
      const found = await this.solver.ask("divide", { ...this.asText(cell), physics, numerics, seed, frames: "last" });
      this.recording = new Recording(found, this.head.lineage);
      this.diagram.point = { r0: cell.r0, xi: cell.xi_s, outcome: found.answer.outcome };
      this.tell(found.answer, cell, physics, performance.now() - asked);
      if (isLast() && found.answer.chi != null) this.tryAnotherSeed(found.answer, { cell, physics }, isLast);
    } catch (error) {
      if (!isLast()) return;
      this.refuse(error, cell);
    }
    if (isLast()) this.arrived();
    this.diagram.draw();
    this.draw();
  }

  /** The same cell with the next seed: says so where the noise decides how unequal the daughters are. */
  async tryAnotherSeed(first, { cell, physics }, isLast) {
    const { numerics } = this.head;
    const seed = this.head.seed + 1;
    const other = await this.solver.ask("divide", { ...this.asText(cell), physics, numerics, seed, frames: "last" }).then((found) => found.answer, () => null);
    if (!other || !isLast()) return;
    const apart = other.outcome !== first.outcome || Math.abs(other.chi - first.chi) > 1e-3;
    element("what-if-result").dataset.noise = apart ? "decides" : "does not decide";
    if (!apart || (other.outcome === "symmetric" && first.outcome === "symmetric")) return;
    const told = other.chi == null ? "it does not divide" : `χ = ${number(other.chi, 4)}`;
    element("what-if-shows").append(` The noise decides how unequal: ${told} with seed ${seed}.`);
  }

  /** Nothing of the last cell is left beside the reason why there is no answer for this one. */
  refuse(error, cell) {
    this.recording = null;
    element("what-if-cell").hidden = true;
    element("outcome").textContent = error.refused ? "refused" : "no answer";
    element("outcome").className = "outcome failed";
    element("what-if-numbers").replaceChildren(make("dt", "because"), make("dd", error.message));
    element("what-if-shows").textContent = element("command").textContent = "";
    element("what-if-command").hidden = true;
    for (const id of ["what-if-settings", "what-if-picture"]) element(id).disabled = true;
    Object.assign(element("what-if-result").dataset, { outcome: error.refused ? "refused" : "error", chi: "", r0: cell.r0, epsilon: cell.epsilon });
  }

  tell(answer, cell, physics, took) {
    element("what-if-cell").hidden = false;
    const outcome = element("outcome");
    outcome.textContent = answer.outcome;
    outcome.className = `outcome ${answer.outcome}`;
    const units = unitsOf(this.head.lineage);
    const rows = [];
    if (answer.chi == null) {
      rows.push(["at rest after", timeText(answer.t_end, units)]);
      if (answer.growth_rate != null) rows.push(["growth rate", `${number(answer.growth_rate)} /τ`]);
    } else {
      rows.push(["χ", number(answer.chi, 5)], ["furrow at u", number(answer.u_furrow, 4)], ["pinch-off after", timeText(answer.t_end, units)]);
      const length = (r0) => (units.length_um ? `${number(r0 * units.length_um, 2)} µm` : number(r0, 3));
      rows.push(["daughters R0", answer.daughters.map(length).join(" (u = 0), ") + " (u = 1)"]);
    }
    rows.push(...neckRows(answer), ...phiRows(answer));
    rows.push(["answered in", `${took.toFixed(0)} ms`]);
    element("what-if-numbers").replaceChildren(...rows.flatMap(([name, value]) => [make("dt", name), make("dd", value)]));
    Object.assign(element("what-if-result").dataset, {
      outcome: answer.outcome, chi: answer.chi ?? "", took, r0: cell.r0, epsilon: cell.epsilon, xi: cell.xi_s,
    });
    const chance = cell.cue === "none" && answer.outcome === "asymmetric" ? ` No cue tells the poles apart: chance decides which side is the larger, and here it is that of seed ${this.head.seed}.` : "";
    element("what-if-shows").textContent = [this.recording.shows() + chance, this.recording.colours()].join(" ");
    // Other lineages may call another cue so, or none.
    this.cueGiven = answer.cue;
    element("command").textContent = this.command({ ...cell, cue: this.cueGiven }, physics);
    element("what-if-command").hidden = false;
    for (const id of ["what-if-settings", "what-if-picture"]) element(id).disabled = false;
  }

  /** The same on the command line. */
  command(cell, physics) {
    const options = [`--r0 ${cell.r0}`, `--epsilon ${cell.epsilon}`, `--xi ${cell.xi_s}`];
    if (cell.cue !== "none") options.push(`--cue ${quoted(cell.cue)}`);
    if (this.head.seed) options.push(`--seed ${this.head.seed}`);
    return ["furrow divide", ...options, ...settingOptions(under(cell, physics), this.head.numerics, ["r0", "epsilon", "xi_s"])].join(" ");
  }

  /** The cell of the sliders as a configuration file. */
  configuration() {
    const { epsilon, xi_s, ...physics } = this.physics;
    const cell = under(this.cell(), physics);
    const cue = cell.cue === "none" ? "" : ` --cue ${quoted(this.cueGiven)}`;
    return configuration(cell, this.head.numerics, ["A cell of the interactive page of furrow. Its division:", `  furrow divide --config furrow.ron --r0 ${cell.r0}${cue} --seed ${this.head.seed}`]);
  }

  draw() {
    this.drawInto(element("what-if-cell"));
  }

  drawInto(canvas, size) {
    if (this.recording) drawCell(canvas, this.recording, this.recording.frames[0], { forces: false, size });
    else canvas.getContext("2d").clearRect(0, 0, canvas.width, canvas.height);
  }

  /** The edge at this ε, computed beside. Until it is there the diagram says of which ε its line is. */
  async followEdge(epsilon) {
    if (this.diagram.edge?.epsilon === epsilon || !(epsilon > 0 && epsilon < 1)) return;
    const { cell, numerics } = this.head;
    try {
      const { answer } = await this.edges.ask("edge", { cell: { ...cell, epsilon }, numerics, range: AXES.r0 });
      this.diagram.edge = { epsilon, pieces: answer.pieces };
      // Beyond the top of the diagram nothing of it could be seen.
      this.widen({ r0: 0, xi_s: Math.min(...answer.pieces.flat().map(([, xi]) => xi)) });
    } catch (error) {
      if (error.message === "stopped") return;
      this.diagram.edge = { epsilon, pieces: [], why: error.message };
    }
    this.diagram.draw();
  }
}

/** The cell with what its founder changes. */
function under(cell, physics) {
  const [material, shell] = [{ ...cell.material }, { ...cell.shell }];
  for (const [name, value] of Object.entries(physics)) (name in shell ? shell : material)[name] = value;
  return { ...cell, material, shell };
}
