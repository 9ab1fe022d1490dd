// The lineage on a canvas: pan, zoom, fold, and a cell under the pointer or the keyboard. Only what is in view is drawn, and
// what is too small to be told apart is drawn as one line, so that ten thousand cells are as quick as a hundred.

const ROW = { least: 22, most: 92 };
const MARGIN = { left: 44, right: 66, top: 42, bottom: 26 };
/** Radius of the first cell's disc, in CSS pixels. */
const LARGEST = 17;

class LineageView {
  constructor(canvas, { onSelect, onOpen }) {
    this.canvas = canvas;
    this.paint = canvas.getContext("2d");
    this.onSelect = onSelect;
    this.onOpen = onOpen;
    this.selected = null;
    this.found = new Set();
    this.zoom = 1;
    this.panX = 0;
    this.panY = 0;
    this.pointers = new Map();
    this.queued = false;
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.listen();
  }

  show(tree) {
    this.tree = tree;
    this.colours = page.colours;
    this.fit();
  }

  resize() {
    const { clientWidth, clientHeight } = this.canvas;
    const ratio = window.devicePixelRatio || 1;
    this.width = clientWidth;
    this.height = clientHeight;
    this.canvas.width = Math.round(clientWidth * ratio);
    this.canvas.height = Math.round(clientHeight * ratio);
    this.ratio = ratio;
    this.draw();
  }

  /** Pixels from one column to the next. */
  get gap() {
    return (this.zoom * (this.width - MARGIN.left - MARGIN.right)) / Math.max(1, this.tree.columns - 1);
  }

  /** Pixels from one generation to the next: they grow more slowly than columns, which there are more of. */
  get row() {
    const fitted = (this.height - MARGIN.top - MARGIN.bottom) / Math.max(1, this.tree.depth);
    const least = Math.min(ROW.most, Math.max(ROW.least, fitted));
    return Math.min(ROW.most, least * Math.sqrt(this.zoom));
  }

  px(column) {
    return MARGIN.left + this.panX + column * this.gap;
  }

  py(generation) {
    return MARGIN.top + this.panY + generation * this.row;
  }

  fit() {
    this.zoom = 1;
    this.panX = this.panY = 0;
    this.draw();
  }

  /** Zooms by a factor and keeps what is at (x, y) there. */
  zoomAt(factor, x, y) {
    const most = Math.max(1, (60 * this.tree.columns) / this.width);
    const column = (x - MARGIN.left - this.panX) / this.gap;
    const generation = (y - MARGIN.top - this.panY) / this.row;
    this.zoom = Math.min(most, Math.max(1, this.zoom * factor));
    this.panX = x - MARGIN.left - column * this.gap;
    this.panY = y - MARGIN.top - generation * this.row;
    this.hold();
    this.draw();
  }

  pan(dx, dy) {
    this.panX += dx;
    this.panY += dy;
    this.hold();
    this.draw();
  }

  /** Keeps some of the tree in view. */
  hold() {
    const inner = this.width - MARGIN.left - MARGIN.right;
    this.panX = Math.min(0, Math.max(this.panX, inner - inner * this.zoom));
    const tall = MARGIN.top + MARGIN.bottom + this.row * this.tree.depth;
    this.panY = Math.min(0, Math.max(this.panY, Math.min(0, this.height - tall)));
  }

  /** Brings a node into view and marks it. */
  select(node, { quietly = false } = {}) {
    this.selected = node;
    if (node) {
      const [x, y] = [this.px(node.x), this.py(node.cell.generation)];
      const edge = 28;
      if (x < edge || x > this.width - edge) this.panX += this.width / 2 - x;
      if (y < edge || y > this.height - edge) this.panY += this.height / 2 - y;
      this.hold();
    }
    this.draw();
    if (!quietly) this.onSelect(node);
  }

  /** Zooms in until all below a node fills the view, or until its neighbours stand apart. */
  approach(node) {
    const wanted = Math.min(9, (0.8 * this.width) / (node.to - node.from + 1));
    if (this.gap < wanted) this.zoomAt(wanted / this.gap, this.px(node.x), this.py(node.cell.generation));
    this.panX += this.width / 2 - this.px(node.x);
    this.hold();
    this.select(node);
  }

  /** Radius of a node's disc: as wide as the cell, where there is room for it. */
  radius(node) {
    const room = Math.max(this.gap * (node.to - node.from + 1), 0);
    const full = (LARGEST * Math.pow(this.zoom, 0.2) * node.cell.r0) / this.tree.largest;
    return Math.max(0.6, Math.min(full, 0.46 * room, 0.42 * this.row));
  }

  draw() {
    if (this.queued) return;
    this.queued = true;
    requestAnimationFrame(() => {
      this.queued = false;
      if (this.tree && this.width > 0) this.drawNow();
    });
  }

  drawNow() {
    const { paint } = this;
    const ink = theme();
    paint.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    paint.clearRect(0, 0, this.width, this.height);
    this.drawRows(ink);
    const lines = new Map();
    const discs = [];
    this.collect(this.tree.root, lines, discs);
    for (const [key, path] of lines) {
      const [founder, width] = key.split(" ");
      paint.strokeStyle = shade(this.colours[founder], ink);
      paint.globalAlpha = 0.55;
      paint.lineWidth = Number(width);
      paint.stroke(path);
    }
    paint.globalAlpha = 1;
    for (const node of discs) this.drawDisc(node, ink);
    this.drawLabels(discs, ink);
    this.drawNumbers(ink);
    this.visible = discs;
  }

  drawRows(ink) {
    const { paint } = this;
    paint.strokeStyle = ink.line;
    paint.lineWidth = 1;
    for (let g = 0; g <= this.tree.depth; g++) {
      const y = this.py(g);
      if (y < 0 || y > this.height) continue;
      paint.beginPath();
      paint.moveTo(26, y);
      paint.lineTo(this.width - 34, y);
      paint.stroke();
    }
  }

  /** Generations and their numbers of cells, in gutters over whatever has been moved there. */
  drawNumbers(ink) {
    const { paint } = this;
    paint.globalAlpha = 0.86;
    paint.fillStyle = ink.ground;
    paint.fillRect(0, 0, 26, this.height);
    paint.fillRect(this.width - 40, 0, 40, this.height);
    paint.globalAlpha = 1;
    paint.fillStyle = ink.faint;
    paint.font = "11px system-ui, sans-serif";
    paint.textBaseline = "middle";
    for (let g = 0; g <= this.tree.depth; g++) {
      const y = this.py(g);
      if (y < -10 || y > this.height + 10) continue;
      paint.textAlign = "left";
      paint.fillText(String(g), 8, y);
      paint.textAlign = "right";
      paint.fillText(String(this.tree.generations[g]?.length ?? 0), this.width - 8, y);
    }
    paint.textAlign = "left";
    paint.fillText("generation", 8, this.py(0) - 26);
    paint.textAlign = "right";
    paint.fillText("cells", this.width - 8, this.py(0) - 26);
  }

  /** Lines by colour and width, and the discs in view. */
  collect(root, lines, discs) {
    const stack = [root];
    const row = this.row;
    const line = (founder, width) => {
      const key = `${founder} ${width}`;
      if (!lines.has(key)) lines.set(key, new Path2D());
      return lines.get(key);
    };
    while (stack.length) {
      const node = stack.pop();
      const [left, right] = [this.px(node.from), this.px(node.to)];
      if (right < -40 || left > this.width + 40) continue;
      const [x, y] = [this.px(node.x), this.py(node.cell.generation)];
      if (right - left < 0.8 && node.daughters.length && !node.folded && node !== root) {
        // All of it is under one pixel.
        const path = line(node.founder, 1);
        path.moveTo(x, y);
        path.lineTo(x, this.py(node.deepest));
        continue;
      }
      discs.push(node);
      if (node.folded) continue;
      for (const daughter of node.daughters) {
        const [to, down] = [this.px(daughter.x), y + row];
        const width = Math.max(0.5, Math.round(0.52 * this.radius(daughter)) / 2);
        const path = line(daughter.founder, width);
        path.moveTo(x, y);
        path.bezierCurveTo(x, y + 0.42 * row, to, down - 0.42 * row, to, down);
        stack.push(daughter);
      }
    }
  }

  drawDisc(node, ink) {
    const { paint } = this;
    const [x, y] = [this.px(node.x), this.py(node.cell.generation)];
    const radius = this.radius(node);
    const colour = shade(this.colours[node.founder], ink);
    paint.beginPath();
    paint.arc(x, y, radius, 0, 2 * Math.PI);
    if (node.cell.ended) {
      paint.fillStyle = ink.ground;
      paint.fill();
      paint.lineWidth = Math.min(1, radius / 2);
      paint.strokeStyle = colour;
      paint.stroke();
      paint.beginPath();
      paint.moveTo(x - radius, y + radius + 2.5);
      paint.lineTo(x + radius, y + radius + 2.5);
      paint.lineWidth = Math.min(1.6, radius);
      paint.stroke();
    } else if (node.cell.outcome === "symmetric") {
      paint.fillStyle = colour;
      paint.fill();
    } else {
      const ring = 0.42 * radius;
      paint.fillStyle = ink.ground;
      paint.fill();
      paint.beginPath();
      paint.arc(x, y, radius - ring / 2, 0, 2 * Math.PI);
      paint.lineWidth = ring;
      paint.strokeStyle = colour;
      paint.stroke();
    }
    if (node.folded) this.drawFolded(node, x, y + radius, ink);
    if (this.found.has(node)) this.ring(x, y, radius + 3.5, ink.found, 2);
    if (node === this.selected) this.ring(x, y, radius + 4, ink.accent, 2.5);
  }

  ring(x, y, radius, colour, width) {
    const { paint } = this;
    paint.beginPath();
    paint.arc(x, y, radius, 0, 2 * Math.PI);
    paint.lineWidth = width;
    paint.strokeStyle = colour;
    paint.stroke();
  }

  /** How many cells are folded away below a node. */
  drawFolded(node, x, y, ink) {
    const { paint } = this;
    paint.fillStyle = ink.faint;
    paint.beginPath();
    paint.moveTo(x, y + 2);
    paint.lineTo(x - 4, y + 8);
    paint.lineTo(x + 4, y + 8);
    paint.fill();
    paint.font = "10px system-ui, sans-serif";
    paint.textAlign = "center";
    paint.textBaseline = "top";
    paint.fillText(`+${node.below}`, x, y + 10);
  }

  /** Names of founders, and of all cells where there is room: none over another. The marked cells come first. */
  drawLabels(discs, ink) {
    const few = this.found.size <= 60;
    const marked = (node) => node === this.selected || (few && this.found.has(node));
    const all = this.gap > 46;
    const rank = (node) => 2 * marked(node) + node.isFounder;
    const named = discs.filter((node) => all || rank(node) > 0).sort((a, b) => rank(b) - rank(a) || a.index - b.index);
    const taken = [];
    this.paint.textBaseline = "alphabetic";
    this.paint.lineJoin = "round";
    for (const node of named.slice(0, 400)) this.drawLabel(node, taken, ink);
  }

  drawLabel(node, taken, ink) {
    const { paint } = this;
    const radius = this.radius(node);
    const [x, y] = [this.px(node.x), this.py(node.cell.generation)];
    const left = this.roomier(node) < 0;
    const at = left ? x - radius - 5 : x + radius + 5;
    const lines = [[node.cell.name, `${node.isFounder ? "600 13px" : "11px"} system-ui, sans-serif`]];
    if (node.isFounder && node.cell.outcome === "asymmetric" && !node.cell.ended) lines.push([`χ ${number(node.cell.chi, 2)}`, "11px system-ui, sans-serif"]);
    paint.textAlign = left ? "right" : "left";
    paint.strokeStyle = ink.ground;
    paint.lineWidth = 4;
    paint.fillStyle = shade(this.colours[node.founder], ink);
    lines.forEach(([text, font], k) => {
      paint.font = font;
      const wide = paint.measureText(text).width;
      const box = [left ? at - wide : at, y - 16 + 13 * k, wide, 12];
      const free = taken.every(([bx, by, bw, bh]) => bx > box[0] + box[2] || bx + bw < box[0] || by > box[1] + box[3] || by + bh < box[1]);
      if (!free) return;
      taken.push(box);
      paint.strokeText(text, at, y - 5 + 13 * k);
      paint.fillText(text, at, y - 5 + 13 * k);
    });
  }

  /** On which side of a node there is more room for its name: -1 on the left, 1 on the right. */
  roomier(node) {
    const row = this.tree.generations[node.cell.generation];
    const place = row.indexOf(node);
    const [before, after] = [row[place - 1], row[place + 1]];
    const left = before ? node.x - before.x : Infinity;
    const right = after ? after.x - node.x : Infinity;
    if (left === right) return node.mother !== null && node.x < node.mother.x ? -1 : 1;
    return left > right ? -1 : 1;
  }

  /** The node under a point; the nearest one that is near enough. */
  at(x, y) {
    let best = null;
    let least = Infinity;
    for (const node of this.visible ?? []) {
      const distance = Math.hypot(this.px(node.x) - x, this.py(node.cell.generation) - y) - this.radius(node);
      if (distance < least) [best, least] = [node, distance];
    }
    return least < 10 ? best : null;
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

  hover(event) {
    const node = this.at(event.offsetX, event.offsetY);
    this.canvas.style.cursor = node ? "pointer" : "grab";
    this.canvas.title = node ? `${node.cell.name}: R0 = ${number(node.cell.r0)}, ${node.cell.outcome ?? "not solved"}${node.cell.chi == null ? "" : `, χ = ${number(node.cell.chi)}`}` : "";
  }

  pinch(moving, before, now) {
    const [other] = [...this.pointers].filter(([id]) => id !== moving).map(([, place]) => place);
    const [was, is] = [before, now].map(([x, y]) => Math.hypot(x - other[0], y - other[1]));
    if (was > 0) this.zoomAt(is / was, (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
  }

  toggle(node) {
    this.tree.fold(node, !node.folded);
    this.hold();
    this.draw();
  }

  key(event) {
    const node = this.selected ?? this.tree.root;
    const row = this.tree.generations[node.cell.generation] ?? [];
    const place = row.indexOf(node);
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
