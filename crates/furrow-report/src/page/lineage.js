// The drawing of a lineage on a canvas, moved and zoomed. Only what is in view is drawn, and what is too small to be told apart is drawn as one line, so that ten thousand cells are as quick as a hundred.

const ROW = { least: 22, most: 140 };
const MARGIN = { left: 44, right: 66, top: 42, bottom: 26 };
/** Radius of the first cell's disc, in CSS pixels. */
const LARGEST = 17;
/** Columns this far apart have room for names that run downwards. */
const NAMED = 12.5;
/** Widths of the gutters on the left and on the right, with generations and their numbers of cells. */
const GUTTERS = [26, 40];
/** What differs in one of several small drawings. */
const SMALL = { rows: { least: 6, most: 40 }, margin: { left: 16, right: 16, top: 22, bottom: 12 }, largest: 10 };

class LineageView {
  constructor(canvas, { small = false } = {}) {
    this.canvas = canvas;
    this.paint = canvas.getContext("2d");
    this.small = small;
    Object.assign(this, small ? SMALL : { rows: ROW, margin: MARGIN, largest: LARGEST });
    this.width = this.height = 0;
    this.selected = null;
    this.found = new Set();
    /** Whether cells are drawn at their births in minutes, instead of their generations. */
    this.minutes = false;
    this.zoom = 1;
    this.panX = 0;
    this.panY = 0;
    this.queued = false;
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  show(tree, colours) {
    this.tree = tree;
    this.colours = colours;
    this.found = new Set();
    this.fit();
  }

  /** Takes the size that the canvas has now: the part of the tree in view stays there. */
  measure() {
    const { clientWidth, clientHeight } = this.canvas;
    const ratio = window.devicePixelRatio || 1;
    if (clientWidth === this.width && clientHeight === this.height && ratio === this.ratio) return;
    if (this.width > 0 && clientWidth > 0) this.panX *= this.inner(clientWidth) / this.inner(this.width);
    Object.assign(this, { width: clientWidth, height: clientHeight, ratio });
    this.canvas.width = Math.round(clientWidth * ratio);
    this.canvas.height = Math.round(clientHeight * ratio);
    if (this.tree) this.hold();
  }

  inner(width) {
    return Math.max(1, width - this.margin.left - this.margin.right);
  }

  /** Pixels from one column to the next. */
  get gap() {
    return (this.zoom * this.inner(this.width)) / Math.max(1, this.tree.columns - 1);
  }

  /** Room below the last generation, for names that run downwards if there are any. */
  get bottom() {
    return this.margin.bottom + (!this.small && this.gap > NAMED ? 6.2 * this.tree.longest : 0);
  }

  /** Pixels from one generation to the next: they grow more slowly than columns, which there are more of. */
  get row() {
    const fitted = (this.height - this.margin.top - this.bottom) / Math.max(1, this.tree.depth);
    const least = Math.min(this.rows.most, Math.max(this.rows.least, fitted));
    return Math.min(this.rows.most, least * Math.sqrt(this.zoom));
  }

  px(column) {
    return this.margin.left + this.panX + column * this.gap;
  }

  /** Pixels downwards by rows: generations, or minutes scaled to the same height. */
  py(level) {
    return this.margin.top + this.panY + level * this.row;
  }

  /** The row of a node. */
  level(node) {
    return this.minutes ? this.tree.levelAt(node.cell.birth_min) : node.cell.generation;
  }

  fit() {
    this.zoom = 1;
    this.panX = this.panY = 0;
    this.draw();
  }

  /** The closest that is of use: names of neighbouring cells side by side. */
  get mostZoom() {
    return Math.max(1, (90 * this.tree.columns) / Math.max(1, this.width));
  }

  /** Zooms by a factor and keeps what is at (x, y) there. */
  zoomAt(factor, x, y) {
    const column = (x - this.px(0)) / this.gap;
    const level = (y - this.py(0)) / this.row;
    this.zoom = Math.min(this.mostZoom, Math.max(1, this.zoom * factor));
    this.put(column, level, x, y);
  }

  /** Moves a place of the tree to (x, y), as far as the tree stays in view. */
  put(column, level, x, y) {
    this.panX = x - this.margin.left - column * this.gap;
    this.panY = y - this.margin.top - level * this.row;
    this.hold();
    this.draw();
  }

  /** What is in view, to come back to. */
  view() {
    const { zoom, panX, panY } = this;
    return { zoom, panX, panY };
  }

  restore(view) {
    Object.assign(this, view);
    this.hold();
    this.draw();
  }

  pan(dx, dy) {
    this.panX += dx;
    this.panY += dy;
    this.hold();
    this.draw();
  }

  /** Keeps much of the tree in view. Its edge may come to the middle, or a cell near it could not stay where it is. */
  hold() {
    const inner = this.inner(this.width);
    const slack = inner * Math.min(0.5, this.zoom - 1);
    this.panX = Math.min(slack, Math.max(this.panX, inner - inner * this.zoom - slack));
    const tall = this.margin.top + this.bottom + this.row * this.tree.depth;
    this.panY = Math.min(0, Math.max(this.panY, Math.min(0, this.height - tall)));
  }

  /** Folds or unfolds cells; a node and the scale of the drawing stay as they are. */
  keeping(node, change) {
    const [x, y, gap] = [this.px(node.x), this.py(this.level(node)), this.gap];
    change();
    if (this.zoom > 1) this.zoom = Math.min(this.mostZoom, Math.max(1, (this.zoom * gap) / this.gap));
    this.put(node.x, this.level(node), x, y);
  }

  /** Radius of a node's disc when it was last drawn. */
  radius(node) {
    return node.radius ?? 0;
  }

  /** Sizes a disc: as wide as the cell, as far as there is room for it and in the scale of its mother's, which is never smaller. */
  size(node) {
    const row = this.tree.generations[node.cell.generation];
    const beside = [row[node.place - 1], row[node.place + 1]].filter((other) => other).map((other) => Math.abs(other.x - node.x));
    const room = this.gap * Math.min(...beside);
    const full = (this.largest * Math.pow(this.zoom, 0.2) * node.cell.r0) / this.tree.largest;
    const fits = Math.min(0.46 * room, 0.42 * this.row, this.roomBelow(node)) / full;
    node.scale = Math.min(node.mother?.scale ?? 1, Math.max(0, fits));
    node.radius = Math.max(0.6, node.scale * full);
  }

  /** Largest radius with which a disc does not meet its daughters'. */
  roomBelow(node) {
    if (node.folded) return Infinity;
    const away = (daughter) => Math.hypot(this.px(daughter.x) - this.px(node.x), this.py(this.level(daughter)) - this.py(this.level(node)));
    return 0.48 * Math.min(...node.daughters.map(away));
  }

  draw() {
    if (this.queued) return;
    this.queued = true;
    requestAnimationFrame(() => {
      this.queued = false;
      this.measure();
      if (this.tree && this.width > 0) this.drawNow();
    });
  }

  /** The drawing as it is in view, as a canvas with so many pixels for one of the screen. */
  picture(ratio) {
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [this.width * ratio, this.height * ratio];
    const shown = { paint: this.paint, ratio: this.ratio };
    Object.assign(this, { paint: canvas.getContext("2d"), ratio });
    this.drawNow();
    Object.assign(this, shown);
    return canvas;
  }

  drawNow() {
    const { paint } = this;
    const ink = theme();
    paint.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    paint.fillStyle = ink.ground;
    paint.fillRect(0, 0, this.width, this.height);
    this.drawRows(ink);
    const lines = new Map();
    const discs = [];
    this.collect(this.tree.root, lines, discs);
    for (const [key, path] of lines) {
      const [founder, width, dashes] = key.split(" ");
      paint.strokeStyle = shade(this.colours[founder], ink);
      paint.globalAlpha = 0.55;
      paint.lineWidth = Number(width);
      paint.setLineDash(dashes ? [4, 3] : []);
      paint.stroke(path);
    }
    paint.setLineDash([]);
    paint.globalAlpha = 1;
    for (const node of discs) this.drawDisc(node, ink);
    if (!this.small) this.drawNumbers(ink);
    const labels = new Labels(this, ink);
    if (this.minutes && !this.small) labels.lastDivisions(discs);
    this.canvas.dataset.names = labels.draw(discs);
    this.visible = discs;
  }

  drawRows(ink) {
    const { paint } = this;
    paint.strokeStyle = ink.line;
    paint.lineWidth = 1;
    for (const { level } of this.marks()) {
      const y = this.py(level);
      if (y < 0 || y > this.height) continue;
      drawLine(paint, [this.small ? 4 : GUTTERS[0], y], [this.width - (this.small ? 4 : GUTTERS[1]), y]);
    }
  }

  /** The rows with a line: generations with their numbers of cells, or round minutes with the cells alive then. */
  marks() {
    if (this.minutes) return this.tree.minuteMarks(this.row);
    return Array.from({ length: this.tree.depth + 1 }, (_, g) => ({ level: g, name: String(g), cells: this.tree.counts[g] }));
  }

  /** Rows and their numbers of cells, in gutters over whatever has been moved there. */
  drawNumbers(ink) {
    const { paint } = this;
    paint.globalAlpha = 0.86;
    paint.fillStyle = ink.ground;
    paint.fillRect(0, 0, GUTTERS[0], this.height);
    paint.fillRect(this.width - GUTTERS[1], 0, GUTTERS[1], this.height);
    paint.globalAlpha = 1;
    paint.fillStyle = ink.faint;
    const both = ([left, right], x, y) => {
      write(paint, left, x, y, "left", { baseline: "middle" });
      write(paint, right, this.width - 8, y, "right", { baseline: "middle" });
    };
    for (const { level, name, cells } of this.marks()) {
      const y = this.py(level);
      if (y >= -10 && y <= this.height + 10) both([name, String(cells)], this.minutes ? 2 : 8, y);
    }
    both(this.minutes ? ["minutes", "alive"] : ["generation", "cells"], 8, this.py(0) - 26);
  }

  /** Lines by colour and width, and the discs in view. */
  collect(root, lines, discs) {
    const stack = [root];
    const row = this.row;
    const line = (founder, width, dashes = "") => {
      const key = `${founder} ${width} ${dashes}`;
      if (!lines.has(key)) lines.set(key, new Path2D());
      return lines.get(key);
    };
    while (stack.length) {
      const node = stack.pop();
      const [left, right] = [this.px(node.from), this.px(node.to)];
      if (right < -40 || left > this.width + 40) continue;
      const [x, y] = [this.px(node.x), this.py(this.level(node))];
      if (right - left < 0.8 && node.daughters.length && !node.folded && node !== root) {
        // All of it is under one pixel.
        const path = line(node.founder, 1);
        path.moveTo(x, y);
        path.lineTo(x, this.py(this.minutes ? this.tree.levelAt(node.latest) : node.deepest));
        continue;
      }
      discs.push(node);
      this.size(node);
      if (node.folded) continue;
      for (const daughter of node.daughters) {
        const [to, down] = [this.px(daughter.x), this.minutes ? this.py(this.level(daughter)) : y + row];
        this.size(daughter);
        const width = Math.max(0.5, Math.round(0.52 * this.radius(daughter)) / 2);
        const path = line(daughter.founder, width, this.minutes && node.cell.lifetime_extrapolated ? "dashes" : "");
        path.moveTo(x, y);
        if (this.minutes) {
          // A cell's life runs straight down, its division across.
          path.lineTo(x, down);
          path.lineTo(to, down);
        } else path.bezierCurveTo(x, y + 0.42 * row, to, down - 0.42 * row, to, down);
        stack.push(daughter);
      }
    }
  }

  drawDisc(node, ink) {
    const { paint } = this;
    const [x, y] = [this.px(node.x), this.py(this.level(node))];
    const radius = this.radius(node);
    const colour = shade(this.colours[node.founder], ink);
    const isFilled = !node.cell.ended && node.cell.outcome === "symmetric";
    circle(paint, x, y, radius);
    paint.fillStyle = isFilled ? colour : ink.ground;
    paint.fill();
    if (node.cell.ended) {
      this.ring(x, y, radius, colour, Math.min(1, radius / 2));
      paint.lineWidth = Math.min(1.6, radius);
      drawLine(paint, [x - radius, y + radius + 2.5], [x + radius, y + radius + 2.5]);
    } else if (!isFilled) this.ring(x, y, 0.79 * radius, colour, 0.42 * radius);
    if (node.folded) this.drawFolded(node, x, y + radius, ink);
    if (this.found.has(node)) this.ring(x, y, radius + 3.5, ink.found, 2);
    if (node === this.selected) this.ring(x, y, radius + 4, ink.accent, 2.5);
  }

  ring(x, y, radius, colour, width) {
    const { paint } = this;
    circle(paint, x, y, radius);
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
    write(paint, `+${node.below}`, x, y + 10, "center", { baseline: "top", size: 10 });
  }

  /** The node under a point; the nearest one that is near enough. */
  at(x, y) {
    let best = null;
    let least = Infinity;
    for (const node of this.visible ?? []) {
      const distance = Math.hypot(this.px(node.x) - x, this.py(this.level(node)) - y) - this.radius(node);
      if (distance < least) [best, least] = [node, distance];
    }
    return least < 10 ? best : null;
  }

  hover(event) {
    const node = this.at(event.offsetX, event.offsetY);
    this.canvas.style.cursor = node ? "pointer" : this.small ? "default" : "grab";
    this.canvas.title = node ? `${node.cell.name}: R0 = ${number(node.cell.r0)}, ${node.cell.outcome ?? "not solved"}${node.cell.chi == null ? "" : `, χ = ${number(node.cell.chi)}`}${lifeText(node.cell)}` : "";
  }
}
