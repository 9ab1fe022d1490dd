// A founder tree grown anew inside the page, under another cue or with the numbers of the sliders.

class Regrow {
  constructor(whatIf, onTree, original) {
    this.whatIf = whatIf;
    this.onTree = onTree;
    this.original = original;
    this.solver = new Solver();
    const names = Object.keys(page.head.lineage.cues ?? {});
    const options = [["", "as the lineage gives them"], ["none", "none"], ...names.map((name) => [name, name]), ["?", "the cue of the sliders"]];
    element("regrow-cue").replaceChildren(...options.map(([value, text]) => Object.assign(make("option", text), { value })));
    element("regrow").addEventListener("click", () => this.grow());
    element("regrow-stop").addEventListener("click", () => this.solver.stop());
    element("regrow-back").addEventListener("click", () => this.back());
  }

  request() {
    const { lineage, cell, numerics, seed, r0_step } = page.head;
    const request = { lineage, cell, numerics, seed, r0_step };
    const cue = element("regrow-cue").value;
    if (cue === "?") request.cue = cueText(this.whatIf.cue());
    else if (cue !== "") request.cue = cue;
    if (element("regrow-sliders").checked) {
      const { epsilon, xi_s } = this.whatIf.cell();
      request.cell = { ...cell, epsilon, xi_s };
    }
    return request;
  }

  async grow() {
    const state = element("regrow-state");
    const request = this.request();
    element("regrow").disabled = true;
    element("regrow-stop").hidden = false;
    const bar = element("regrow-bar");
    bar.hidden = false;
    bar.removeAttribute("value");
    state.textContent = "growing…";
    state.dataset.state = "growing";
    const start = performance.now();
    try {
      const { answer } = await this.solver.ask("regrow", request, ({ solved, waiting }) => {
        state.textContent = `${solved} divisions solved, ${waiting} known to wait`;
      });
      const seconds = (performance.now() - start) / 1000;
      this.show(answer, request, seconds);
      Object.assign(state.dataset, { state: "done", cells: answer.cells.length, seconds, founders: JSON.stringify(answer.founders) });
    } catch (error) {
      state.textContent = error.message === "stopped" ? "stopped" : `The tree could not be grown: ${error.message}`;
      state.dataset.state = "failed";
    }
    bar.hidden = true;
    element("regrow").disabled = false;
    element("regrow-stop").hidden = true;
  }

  show(tree, request, seconds) {
    const cell = request.cell;
    const cue = request.cue === undefined ? "the lineage's cues" : request.cue === "none" ? "no cue" : `the cue ${request.cue}`;
    const title = `Grown here in ${seconds.toFixed(1)} s with ${cue}, ε = ${cell.epsilon}, ξ_s = ${cell.xi_s}: ${tree.cells.length} cells`;
    element("regrow-state").textContent = title + (this.original ? `; the report has ${this.original.cells.length}` : "");
    element("regrow-back").hidden = !this.original;
    this.onTree(tree, title);
    this.compare(tree);
  }

  /** Rounds of the founders as grown here beside those of the report and the observed ones. */
  compare(tree) {
    const before = new Map((this.original?.founders ?? []).map((row) => [row.name, row]));
    const rounds = (row) => (row?.rounds ? `${row.rounds.min} / ${row.rounds.mean.toFixed(2)} / ${row.rounds.max}` : "–");
    const cells = (row) => row?.rounds?.terminal ?? "–";
    const head = ["founder", "R0", "division", "χ", "grown here", "cells"];
    if (this.original) head.push("report", "cells");
    const observed = tree.founders.some((row) => row.observed);
    if (observed) head.push("observed", "cells");
    const seen = (row) => (row.observed ? `${row.observed.min} / ${row.observed.mean.toFixed(2)} / ${row.observed.max}` : "–");
    const lines = tree.founders.map((row) => {
      const line = [row.name, number(row.r0, 3), row.outcome ?? "–", number(row.chi, 3), rounds(row), cells(row)];
      if (this.original) line.push(rounds(before.get(row.name)), cells(before.get(row.name)));
      if (observed) line.push(seen(row), row.observed?.terminal ?? "–");
      return line;
    });
    const table = element("regrow-table");
    table.hidden = false;
    table.querySelector("thead").replaceChildren(rowOf(head, "th"));
    table.querySelector("tbody").replaceChildren(...lines.map((line) => rowOf(line, "td")));
    element("regrow-rounds").hidden = false;
  }

  back() {
    element("regrow-back").hidden = true;
    element("regrow-table").hidden = true;
    element("regrow-rounds").hidden = true;
    element("regrow-state").textContent = "";
    this.onTree(this.original, null);
  }
}

function rowOf(texts, kind) {
  const row = document.createElement("tr");
  row.append(...texts.map((text) => make(kind, String(text))));
  return row;
}
