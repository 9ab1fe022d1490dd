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
    /** What is written when all names are. */
    this.later = [];
  }

  /** Draws the names of these cells and says how many there was room for. The marked ones come first, then founders. */
  draw(discs) {
    const { view, paint } = this;
    const few = view.found.size <= 60;
    const marked = (node) => node === view.selected || (few && view.found.has(node));
    this.discs = discs;
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
    this.later.forEach((write) => write());
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

  /** A name at the first place near its cell that is free, and for a founder the χ of its division. */
  beside(node) {
    const { view, paint } = this;
    paint.fillStyle = shade(view.colours[node.founder], this.ink);
    const font = node.isFounder ? `600 ${view.small ? 11 : 13}px system-ui, sans-serif` : NAME_FONT;
    paint.font = font;
    const wide = paint.measureText(node.cell.name).width;
    const place = this.places(node, wide).find((place) => this.writeAt(place, node.cell.name, font));
    if (!place) return;
    this.drawn += 1;
    const unequal = node.isFounder && node.cell.outcome === "asymmetric" && !node.cell.ended;
    // Above a cell the next line would be the cell itself.
    if (!unequal || view.small || view.minutes || place.above) return;
    this.later.push(() => {
      paint.fillStyle = shade(view.colours[node.founder], this.ink);
      const words = `χ ${number(node.cell.chi, 2)}`;
      paint.font = NAME_FONT;
      const length = paint.measureText(words).width;
      // On the left it ends where the name ends.
      const below = { x: place.x < view.px(node.x) ? place.x + wide - length : place.x, y: place.y + 13 };
      if (!this.hides(node, below, length)) this.writeAt(below, words, NAME_FONT);
    });
  }

  /** Where a name may be, the best first: on either side, above, below; rather not over another cell, and least of all in a gutter. */
  places(node, wide) {
    const { view } = this;
    const [x, y, away] = [view.px(node.x), view.py(view.level(node)), view.radius(node) + 5];
    const [low, high] = view.small ? [2, view.width - 2] : [GUTTERS[0], view.width - GUTTERS[1]];
    const left = { x: x - away - wide, y: y - 5 };
    const right = { x: x + away, y: y - 5 };
    const sides = this.room(node)[1] < 0 ? [left, right] : [right, left];
    const all = [...sides, { x: x - wide / 2, y: y - away - 1, above: true }, { x: x - wide / 2, y: y + away + (node.folded ? 32 : 13) }];
    const inGutter = ({ x }) => x < low || x + wide > high;
    const faults = new Map(all.map((place) => [place, 2 * inGutter(place) + this.hides(node, place, wide)]));
    return all.sort((a, b) => faults.get(a) - faults.get(b));
  }

  /** Whether text beside a cell would lie on another one. */
  hides(node, { x, y }, wide) {
    const { view } = this;
    return this.discs.some((other) => {
      const [across, down, radius] = [view.px(other.x), view.py(view.level(other)), view.radius(other)];
      return other !== node && across + radius > x && across - radius < x + wide && down + radius > y - 11 && down - radius < y + 1;
    });
  }

  /** Writes text at a place unless that is taken. */
  writeAt({ x, y }, text, font) {
    const { paint } = this;
    paint.font = font;
    paint.textAlign = "left";
    if (!this.take([x, y - 11, paint.measureText(text).width, 12])) return false;
    paint.strokeText(text, x, y);
    paint.fillText(text, x, y);
    return true;
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
