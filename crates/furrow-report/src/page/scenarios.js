// Several trees side by side, small. A click on a cell of any opens it in the lineage below.

class Overview {
  constructor(frame, onGo) {
    this.figures = scenarios.map((scenario, k) => this.figure(scenario, k, onGo));
    frame.replaceChildren(...this.figures.map(({ figure }) => figure));
    frame.hidden = false;
    for (const heading of document.querySelectorAll("th[data-scenario]")) {
      const button = Object.assign(make("button", heading.textContent), { type: "button", className: "plain" });
      button.addEventListener("click", () => onGo(Number(heading.dataset.scenario), null));
      heading.replaceChildren(button);
    }
  }

  figure({ name, made, colours, tree }, k, onGo) {
    const figure = document.createElement("figure");
    const caption = document.createElement("figcaption");
    const button = Object.assign(make("button", `${k + 1} ${name}`), { type: "button" });
    button.addEventListener("click", () => onGo(k, null));
    const said = make("span", `${made}; ${tree.cells.length} cells`);
    said.className = "faint small";
    caption.append(button, said);
    const canvas = document.createElement("canvas");
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `The tree of ${name}, small`);
    figure.append(caption, canvas);
    const view = new LineageView(canvas, { small: true });
    view.show(new Tree(tree), colours);
    canvas.addEventListener("pointermove", (event) => view.hover(event));
    canvas.addEventListener("click", (event) => onGo(k, view.at(event.offsetX, event.offsetY)?.cell.name ?? null));
    return { figure, button, view };
  }

  /** Says which of them is in the lineage below, and which cell of it is open. */
  mark(shown, name = null) {
    this.figures.forEach(({ figure, button, view }, k) => {
      button.setAttribute("aria-pressed", String(k === shown));
      figure.classList.toggle("shown", k === shown);
      view.selected = k === shown ? view.tree.byName.get(name) ?? null : null;
      view.draw();
    });
    for (const heading of document.querySelectorAll("th[data-scenario]")) heading.classList.toggle("shown", Number(heading.dataset.scenario) === shown);
  }

  draw() {
    this.figures.forEach(({ view }) => view.draw());
  }
}
