// The panel of one cell: its numbers, and its division computed and played.

class CellPanel {
  constructor(solver, { onGo, onExplore, onSize }) {
    this.solver = solver;
    this.onGo = onGo;
    this.onSize = onSize;
    this.node = null;
    /** Whose division was asked for last, whose is recorded, and whether it is to be played. */
    this.asked = this.recorded = null;
    this.plays = false;
    this.player = new Player({
      canvas: element("film"),
      button: element("play"),
      slider: element("scrub"),
      label: element("film-time"),
      note: element("film-note"),
      forces: element("forces"),
    });
    element("explore-cell").addEventListener("click", () => onExplore(this.node));
    element("film-picture").addEventListener("click", () => savePicture(`${this.node.cell.name}.png`, (canvas, size) => this.player.drawInto(canvas, size), element("film")));
    element("close-cell").addEventListener("click", () => this.close());
    this.computing = new Latest(solver, (request) => this.compute(request));
  }

  /** Shows the numbers of a cell, without computing anything. */
  show(head, node, spread = null) {
    const { cell } = node;
    this.node = node;
    this.head = head;
    if (element("cell-panel").hidden) {
      element("cell-panel").hidden = false;
      this.onSize();
    }
    element("cell-name").textContent = cell.name;
    const { founders } = head.lineage;
    const units = unitsOf(head.lineage);
    const rows = [
      ...(node.isFounder ? [] : [["founder", founders[node.founder].name]]),
      ["generation", String(cell.generation)],
      ["R0", lengthText(cell.r0, units)],
      ["volume", `${(100 * cell.volume_fraction).toFixed(3)} % of ${this.head.cells[0].name}`],
      ["cue", rounded(cell.cue)],
      ...Object.entries(cell.physics ?? {}).map(([name, value]) => [name, number(value, 6)]),
      ["division", cell.outcome ?? "not solved"],
    ];
    if (cell.chi != null) rows.push(["χ", number(cell.chi, 6)]);
    if (cell.u_furrow != null) rows.push(["furrow at u", number(cell.u_furrow, 4)]);
    if (cell.t_end != null) rows.push([cell.chi == null ? "at rest after" : "pinch-off after", timeText(cell.t_end, units)]);
    if (cell.birth_min !== undefined) rows.push(["born at", `${number(cell.birth_min, 1)} min`]);
    if (cell.division_min !== undefined) rows.push(["divides at", `${number(cell.division_min, 1)} min, ${number(cell.division_min - cell.birth_min, 1)} min old`]);
    if (cell.lifetime_extrapolated) rows.push(["", "extrapolated: the clock was fitted to cells of other sizes"]);
    rows.push(...neckRows(cell), ...phiRows(cell));
    if (spread) rows.push(...spreadRows(spread));
    const ended = endText(cell.ended);
    if (ended) rows.push(["ends", ended]);
    element("cell-numbers").replaceChildren(...rows.flatMap(([name, value]) => [make("dt", name), make("dd", value)]));
    const kin = [[node.mother, "mother"], ...node.daughters.map((daughter) => [daughter, "daughter"])].filter(([other]) => other);
    element("cell-kin").replaceChildren(...kin.map(([other, what]) => {
      const button = make("button", `${what} ${other.cell.name}`);
      button.type = "button";
      button.addEventListener("click", () => this.onGo(other));
      return button;
    }));
    element("said").textContent = `${cell.name}, generation ${cell.generation}, R0 ${number(cell.r0)}, ${cell.outcome ?? "not solved"}${cell.chi == null ? "" : `, chi ${number(cell.chi, 3)}`}`;
    if (this.recorded !== node) {
      this.recorded = null;
      this.player.show(null);
      const state = element("film-state");
      state.textContent = "";
      for (const key of Object.keys(state.dataset)) delete state.dataset[key];
    }
  }

  /** Computes the division of the cell that is shown, and plays it or shows it half way. */
  open({ playing = true } = {}) {
    if (!this.solver || !this.node) return;
    if (this.recorded === this.node) {
      if (playing) this.player.play();
      return;
    }
    this.plays = playing;
    if (this.asked === this.node) return;
    this.asked = this.node;
    element("film-state").textContent = "computing…";
    this.computing.ask({ head: this.head, node: this.node });
  }

  async compute({ head, node }) {
    try {
      const found = await this.solver.ask("divide", { ...divisionOf(head, node), frames: "all" });
      if (node !== this.node) return;
      this.recorded = node;
      this.tell(found, node.cell);
    } catch (error) {
      if (node === this.node && error.message !== "stopped") element("film-state").textContent = `Its division could not be computed: ${error.message}`;
    }
    if (this.asked === node) this.asked = null;
  }

  tell(found, cell) {
    const { answer, took } = found;
    // Where nothing tells one pole from the other the tree drew the side; the film shows that side.
    const mirrored = (cell.chi_signed ?? 0) * (answer.chi_signed ?? 0) < 0;
    this.player.show(new Recording(found, this.head.lineage, mirrored), this.plays);
    const state = element("film-state");
    state.textContent = `Computed here in ${took.toFixed(0)} ms: ${answer.outcome}${answer.chi == null ? "" : `, χ = ${number(answer.chi, 6)}`}. ${this.player.recording.colours()}`;
    Object.assign(state.dataset, { cell: cell.name, outcome: answer.outcome, chi: answer.chi ?? "", took, frames: answer.frames.length });
  }

  /** Scrolls to the panel where it is below the lineage, as on a telephone, or below the screen. */
  comeIntoView() {
    const { top } = element("cell-panel").getBoundingClientRect();
    if (top < Math.min(element("lineage").getBoundingClientRect().bottom, window.innerHeight)) return;
    const behavior = matchMedia("(prefers-reduced-motion: reduce)").matches ? "auto" : "smooth";
    element("cell-panel").scrollIntoView({ behavior, block: "start" });
  }

  close() {
    this.player.pause();
    element("cell-panel").hidden = true;
    this.onSize();
    this.node = null;
    lineage?.select(null, { quietly: true });
    lineage?.canvas.focus();
  }
}

/** Rows of what a founder is over seeds: medians, and 5–95 % in brackets. */
function spreadRows({ chi, rounds, cells }) {
  const text = (of, digits) => `${number(of.p50, digits)} (${number(of.p5, digits)}–${number(of.p95, digits)})`;
  const all = [["χ over seeds", chi, 3], ["mean rounds over seeds", rounds?.mean, 2], ["cells over seeds", cells, 0]];
  return all.filter(([, of]) => of).map(([name, of, digits]) => [name, text(of, digits)]);
}
