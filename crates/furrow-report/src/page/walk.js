// The lineage under the pointer, the fingers and the keyboard: moved, zoomed, folded, and a cell of it selected.

class LineageWalk extends LineageView {
  constructor(canvas, { onSelect, onOpen }) {
    super(canvas);
    this.onSelect = onSelect;
    this.onOpen = onOpen;
    this.pointers = new Map();
    this.listen();
  }

  /** Brings a node into view and marks it. */
  select(node, { quietly = false } = {}) {
    this.selected = node;
    // The panel beside the lineage opens now, and takes its room.
    if (!quietly) this.onSelect(node);
    this.measure();
    if (node) {
      const [x, y] = [this.px(node.x), this.py(this.level(node))];
      const edge = 28;
      if (x < edge || x > this.width - edge) this.panX += this.width / 2 - x;
      if (y < edge || y > this.height - edge) this.panY += this.height / 2 - y;
      this.hold();
    }
    this.draw();
  }

  /** Zooms in until all below a node fills the view, or until its neighbours stand apart. */
  approach(node) {
    this.measure();
    const wanted = Math.min(14, (0.8 * this.width) / (node.to - node.from + 1));
    if (this.gap < wanted) this.zoomAt(wanted / this.gap, this.px(node.x), this.py(this.level(node)));
    this.panX += this.width / 2 - this.px(node.x);
    this.hold();
    this.select(node);
  }

  listen() {
    const { canvas, pointers } = this;
    let moved = 0;
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, [event.offsetX, event.offsetY]);
      if (pointers.size === 1) moved = 0;
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) {
        this.hover(event);
        return;
      }
      const now = [event.offsetX, event.offsetY];
      moved += Math.hypot(now[0] - before[0], now[1] - before[1]);
      if (pointers.size === 2) this.pinch(event.pointerId, before, now);
      else if (moved > 5) this.pan(now[0] - before[0], now[1] - before[1]);
      pointers.set(event.pointerId, now);
    });
    const release = (event) => {
      const was = pointers.size;
      pointers.delete(event.pointerId);
      if (event.type !== "pointerup" || was > 1 || moved > 5) return;
      const node = this.at(event.offsetX, event.offsetY);
      if (node) {
        this.select(node);
        this.onOpen(node);
      }
    };
    canvas.addEventListener("pointerup", release);
    canvas.addEventListener("pointercancel", release);
    canvas.addEventListener("dblclick", (event) => {
      const node = this.at(event.offsetX, event.offsetY);
      if (node) this.toggle(node);
      else this.zoomAt(2, event.offsetX, event.offsetY);
    });
    // A page is scrolled over a tree that nobody has turned to.
    canvas.addEventListener("wheel", (event) => {
      if (document.activeElement !== canvas && !event.ctrlKey && !event.metaKey) return;
      event.preventDefault();
      this.zoomAt(Math.exp(-event.deltaY * (event.deltaMode === 1 ? 0.05 : 0.0016)), event.offsetX, event.offsetY);
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  pinch(moving, before, now) {
    const [other] = [...this.pointers].filter(([id]) => id !== moving).map(([, place]) => place);
    const [was, is] = [before, now].map(([x, y]) => Math.hypot(x - other[0], y - other[1]));
    if (was > 0) this.zoomAt(is / was, (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
  }

  toggle(node) {
    this.keeping(node, () => this.tree.fold(node, !node.folded));
    this.selectShown();
  }

  unfold() {
    this.keeping(this.selected ?? this.tree.root, () => this.tree.foldFrom(Infinity));
  }

  /** Where the selected cell is folded away, the one that it is folded into is selected. */
  selectShown() {
    let node = this.selected;
    for (let above = node?.mother; above; above = above.mother) if (above.folded) node = above;
    if (node !== this.selected) this.select(node);
  }

  key(event) {
    const node = this.selected ?? this.tree.root;
    const row = this.tree.generations[node.cell.generation] ?? [];
    const { place } = node;
    const steps = {
      ArrowUp: () => node.mother,
      ArrowDown: () => (node.folded ? null : node.daughters[0]),
      ArrowLeft: () => row[place - 1],
      ArrowRight: () => row[place + 1],
      Home: () => this.tree.root,
    };
    const middle = [this.width / 2, this.height / 2];
    const acts = {
      Enter: () => { this.select(node); this.onOpen(node); },
      " ": () => this.toggle(node),
      "+": () => this.zoomAt(1.4, ...middle),
      "=": () => this.zoomAt(1.4, ...middle),
      "-": () => this.zoomAt(1 / 1.4, ...middle),
      0: () => this.fit(),
    };
    if (steps[event.key]) this.select(this.selected ? steps[event.key]() ?? node : node);
    else if (acts[event.key]) acts[event.key]();
    else return;
    event.preventDefault();
  }
}
