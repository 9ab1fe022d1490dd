// Names in the lineage, none over another: those of founders, of marked cells, and of all cells that have room.

/** More would not be read, and cost time to place. */
const MOST_NAMES = 500;
const NAME_FONT = "11px system-ui, sans-serif";

class Labels {
  constructor(view, ink) {
    this.view = view;
    this.paint = view.paint;
    this.ink = ink;
    this.taken = [];
    this.drawn = 0;
  }

  /** Draws the names of these cells and says how many there was room for. The marked ones come first, then founders. */
  draw(discs) {
    const { view, paint } = this;
    const few = view.found.size <= 60;
    const marked = (node) => node === view.selected || (few && view.found.has(node));
    const rank = (node) => 2 * marked(node) + node.isFounder;
    paint.textBaseline = "alphabetic";
    paint.lineJoin = "round";
    paint.lineWidth = 4;
    paint.strokeStyle = this.ink.ground;
    for (const node of [...discs].sort((a, b) => rank(b) - rank(a) || a.index - b.index)) {
      if (this.taken.length > MOST_NAMES) break;
      const apart = !view.small && view.gap > NAMED;
      if (node.isFounder || node === view.selected || (!apart && rank(node) > 0)) this.beside(node);
      else if (apart) this.ifThereIsRoom(node);
    }
    return this.drawn;
  }

  /** The last division of each founder's descendants, as a line below them with its minute; of founders without founders below. */
  lastDivisions(discs) {
    const { view, paint } = this;
    paint.textBaseline = "alphabetic";
    paint.textAlign = "right";
    paint.font = "10px system-ui, sans-serif";
    for (const node of discs) {
      if (!node.isFounder || node.foundersBelow || node.last === null || node.folded) continue;
      const [from, to, y] = [view.px(node.from) - 5, view.px(node.to) + 5, view.py(view.tree.levelAt(node.last.division_min))];
      paint.strokeStyle = paint.fillStyle = shade(view.colours[node.founder], this.ink);
      paint.lineWidth = 1.2;
      paint.setLineDash([5, 4]);
      drawLine(paint, [from, y], [to, y]);
      paint.setLineDash([]);
      const words = `${node.cell.name}: last ${node.last.division_min.toFixed(0)} min${node.last.lifetime_extrapolated ? "*" : ""}`;
      const wide = paint.measureText(words).width;
      // Nothing of the founder is below.
      if (!this.take([to - wide, y + 9, wide, 11])) continue;
      paint.lineWidth = 3;
      paint.lineJoin = "round";
      paint.strokeStyle = this.ink.ground;
      paint.strokeText(words, to, y + 18);
      paint.fillText(words, to, y + 18);
    }
  }

  /** A name beside a cell where its row has room for it, else below a cell that has nothing else below it. */
  ifThereIsRoom(node) {
    const { view, paint } = this;
    const x = view.px(node.x);
    if (x < GUTTERS[0] || x > view.width - GUTTERS[1]) return;
    paint.font = NAME_FONT;
    const wide = paint.measureText(node.cell.name).width;
    const [room] = this.room(node);
    if (room * view.gap > wide + 2 * view.radius(node) + 12) this.beside(node);
    else if (node.folded || !node.daughters.length) this.below(node, wide);
  }

  /** Columns to the neighbour that is farther off, and on which side it is: -1 on the left, 1 on the right. */
  room(node) {
    const row = this.view.tree.generations[node.cell.generation];
    const [before, after] = [row[node.place - 1], row[node.place + 1]];
    const left = before ? node.x - before.x : Infinity;
    const right = after ? after.x - node.x : Infinity;
    if (left === right) return [left, node.mother !== null && node.x < node.mother.x ? -1 : 1];
    return left > right ? [left, -1] : [right, 1];
  }

  beside(node) {
    const { view, paint } = this;
    const radius = view.radius(node);
    const [x, y] = [view.px(node.x), view.py(view.level(node))];
    const bold = `600 ${view.small ? 11 : 13}px system-ui, sans-serif`;
    const lines = [[node.cell.name, node.isFounder ? bold : NAME_FONT]];
    if (!view.small && !view.minutes && node.isFounder && node.cell.outcome === "asymmetric" && !node.cell.ended) lines.push([`χ ${number(node.cell.chi, 2)}`, NAME_FONT]);
    paint.fillStyle = shade(view.colours[node.founder], this.ink);
    paint.font = lines[0][1];
    const left = this.side(x, radius + 5, paint.measureText(node.cell.name).width, this.room(node)[1]) < 0;
    const at = left ? x - radius - 5 : x + radius + 5;
    paint.textAlign = left ? "right" : "left";
    lines.forEach(([text, font], k) => {
      paint.font = font;
      const wide = paint.measureText(text).width;
      if (!this.take([left ? at - wide : at, y - 16 + 13 * k, wide, 12])) return;
      paint.strokeText(text, at, y - 5 + 13 * k);
      paint.fillText(text, at, y - 5 + 13 * k);
      this.drawn += k === 0;
    });
  }

  /** The preferred side, unless the name would run into a gutter there and not on the other. */
  side(x, away, wide, preferred) {
    const [low, high] = this.view.small ? [2, this.view.width - 2] : [GUTTERS[0], this.view.width - GUTTERS[1]];
    const fits = { "-1": x - away - wide >= low, 1: x + away + wide <= high };
    return fits[preferred] || !fits[-preferred] ? preferred : -preferred;
  }

  below(node, wide) {
    const { view, paint } = this;
    const [x, y] = [view.px(node.x), view.py(view.level(node)) + view.radius(node) + (node.folded ? 24 : 7)];
    if (!this.take([x - 5, y, 10, wide])) return;
    paint.save();
    paint.translate(x - 4, y);
    paint.rotate(Math.PI / 2);
    paint.textAlign = "left";
    paint.fillStyle = shade(view.colours[node.founder], this.ink);
    paint.strokeText(node.cell.name, 0, 0);
    paint.fillText(node.cell.name, 0, 0);
    paint.restore();
    this.drawn += 1;
  }

  /** Takes a box [x, y, width, height] unless a part of it is taken. */
  take(box) {
    const free = this.taken.every(([x, y, w, h]) => x > box[0] + box[2] || x + w < box[0] || y > box[1] + box[3] || y + h < box[1]);
    if (free) this.taken.push(box);
    return free;
  }
}
