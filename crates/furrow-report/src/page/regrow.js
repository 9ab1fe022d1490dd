// A founder tree grown anew inside the page, under another cue or with the numbers of the sliders.

class Regrow {
  constructor(whatIf, { onTree, onBack }) {
    this.whatIf = whatIf;
    this.onTree = onTree;
    this.solver = new Solver();
    this.from(page.head, null, "");
    element("regrow").addEventListener("click", () => this.grow());
    element("regrow-stop").addEventListener("click", () => this.solver.stop());
    element("regrow-back").addEventListener("click", onBack);
  }

  /** Begins anew from a tree of the page, if there is one, and what it was grown from. */
  from(head, original, name) {
    Object.assign(this, { head, original, name });
    const names = Object.keys(head.lineage.cues ?? {});
    const options = [["", "as the lineage gives them"], ["none", "none"], ...names.map((name) => [name, name]), ["?", "the cue of the sliders"]];
    element("regrow-cue").replaceChildren(...options.map(([value, text]) => Object.assign(make("option", text), { value })));
    for (const id of ["regrow-back", "regrow-table", "regrow-rounds"]) element(id).hidden = true;
    element("regrow-state").textContent = "";
  }

  request() {
    const { lineage, cell, numerics, seed, r0_step } = this.head;
    const request = { lineage, cell, numerics, seed, r0_step };
    const cue = element("regrow-cue").value;
    if (cue === "?") request.cue = this.whatIf.cue();
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
      this.show(answer, (await this.solver.ask("told", answer)).answer, request, seconds);
      Object.assign(state.dataset, { state: "done", cells: answer.cells.length, seconds, founders: JSON.stringify(answer.founders) });
    } catch (error) {
      state.textContent = error.message === "stopped" ? "stopped" : `The tree could not be grown: ${error.message}`;
      state.dataset.state = "failed";
    }
    bar.hidden = true;
    element("regrow").disabled = false;
    element("regrow-stop").hidden = true;
  }

  show(tree, told, request, seconds) {
    const cell = request.cell;
    const cue = request.cue === undefined ? "the lineage's cues" : request.cue === "none" ? "no cue" : `the cue ${request.cue}`;
    const title = `Grown here in ${seconds.toFixed(1)} s with ${cue}, ε = ${cell.epsilon}, ξₛ = ${cell.xi_s}: ${tree.cells.length} cells`;
    element("regrow-state").textContent = title + (this.original ? `; ${this.name} has ${this.original.cells.length}` : "");
    element("regrow-back").textContent = `Back to ${this.name}`;
    element("regrow-back").hidden = !this.original;
    this.onTree(tree, title, told);
    this.compare(tree);
  }

  /** Rounds of the founders as grown here beside those of the report and the observed ones. */
  compare(tree) {
    const before = new Map((this.original?.founders ?? []).map((row) => [row.name, row]));
    const rounds = (of) => (of ? [of.min, of.mean?.toFixed(2), of.max].map((count) => count ?? "–").join(" / ") : "–");
    const cells = (row) => row?.rounds?.terminal ?? "–";
    const head = ["founder", "R0", "division", "χ", "grown here", "cells"];
    if (this.original) head.push(this.name, "cells");
    const observed = tree.founders.some((row) => row.observed);
    if (observed) head.push("observed", "cells");
    const lines = tree.founders.map((row) => {
      const line = [row.name, number(row.r0, 3), row.outcome ?? "–", number(row.chi, 3), rounds(row.rounds), cells(row)];
      if (this.original) line.push(rounds(before.get(row.name)?.rounds), cells(before.get(row.name)));
      if (observed) line.push(rounds(row.observed), row.observed?.terminal ?? "–");
      return line;
    });
    const table = element("regrow-table");
    table.hidden = false;
    table.querySelector("thead").replaceChildren(rowOf(head, "th"));
    table.querySelector("tbody").replaceChildren(...lines.map((line) => rowOf(line, "td")));
    element("regrow-rounds").hidden = false;
  }
}

function rowOf(texts, kind) {
  const row = document.createElement("tr");
  row.append(...texts.map((text) => make(kind, String(text))));
  return row;
}
