// A division as a film: the contour in its shell, the cue and its regulator as bands on it, arrows of active force. The axis of division lies
// across, the pole u = 0 on the right.

/** A part with less than this of the volume is a thread of the neck, not a lobe. */
const THREAD = 0.01;

/** What the solver answered, as frames of numbers. */
class Recording {
  constructor({ answer, numbers }, lineage, mirrored = false) {
    this.answer = answer;
    this.poles = poles(lineage);
    this.units = unitsOf(lineage);
    this.sign = mirrored ? -1 : 1;
    const { points, arrows, frames } = answer;
    const ends = [3 * points, 3 * points + 4 * arrows, 3 * points + 4 * arrows + (answer.regulated ? points : 0)];
    this.frames = frames.map((frame, k) => {
      const [contour, forces, phi] = ends.map((end, part) => numbers.subarray(k * ends[2] + (ends[part - 1] ?? 0), k * ends[2] + end));
      return { t: frame.t, neck: frame.neck, contour, arrows: forces, phi };
    });
    this.end = frames[frames.length - 1].t;
    this.strongest = Math.max(...this.frames.map(({ contour }) => this.most(contour, 3, (c, i) => Math.abs(c[i + 2]))), 0);
    this.strongestPhi = Math.max(...this.frames.map(({ phi }) => this.most(phi, 1, (all, i) => Math.abs(all[i]))), 0);
    this.reference = this.typicalForce();
    this.pace();
  }

  most(numbers, stride, value) {
    let most = 0;
    for (let i = 0; i < numbers.length; i += stride) most = Math.max(most, value(numbers, i));
    return most;
  }

  /** A force that nine arrows in ten stay below. */
  typicalForce() {
    const forces = [];
    for (const { arrows } of this.frames) for (let i = 0; i < arrows.length; i += 4) forces.push(Math.hypot(arrows[i + 2], arrows[i + 3]));
    forces.sort((a, b) => a - b);
    return forces[Math.floor(0.9 * forces.length)] || 1;
  }

  /** Places of the frames in the film, from 0 to 1: even in time, unless nearly all of the time is spent waiting at a shape
   *  that hardly changes; then half of it even in change. */
  pace() {
    const change = this.frames.map(({ contour }, k) => {
      if (k === 0) return 0;
      const before = this.frames[k - 1].contour;
      let sum = 0;
      for (let i = 0; i < contour.length; i += 3) sum += Math.hypot(contour[i] - before[i], contour[i + 1] - before[i + 1]);
      return sum;
    });
    const total = change.reduce((sum, part) => sum + part, 0) || 1;
    let done = 0;
    const changed = change.map((part) => (done += part) / total);
    const time = this.frames.map(({ t }) => (this.end > 0 ? t / this.end : 1));
    const at = (share) => time[changed.findIndex((part) => part >= share)] ?? 1;
    this.even = at(0.95) - at(0.05) > 0.1;
    this.places = this.even ? time : time.map((part, k) => (part + changed[k]) / 2);
  }

  /** Parts into which waists cut the last contour, from left to right: the share of the volume of each. */
  parts() {
    const { contour } = this.frames[this.frames.length - 1];
    const places = [];
    for (let i = 0; i < contour.length; i += 3) places.push([this.sign * contour[i + 1], Math.max(0, contour[i])]);
    if (places[0][0] > places[places.length - 1][0]) places.reverse();
    const cuts = waists(places.map(([, r]) => r));
    const volumes = new Array(cuts.length + 1).fill(0);
    for (let k = 1, part = 0; k < places.length; k++) {
      const [[z, r], [before, s]] = [places[k], places[k - 1]];
      volumes[part] += ((z - before) * (r * r + r * s + s * s)) / 3;
      if (k === cuts[part]) part += 1;
    }
    const whole = volumes.reduce((sum, volume) => sum + volume, 0);
    return volumes.map((volume) => volume / whole);
  }

  /** What the colours along the contour mean, where there is a cue. */
  colours() {
    const shown = (value) => [1, -1].map((sign) => Math.max(...this.frames.map((frame) => value(frame, sign)), 0));
    const signs = shown(({ contour }, sign) => this.most(contour, 3, (c, i) => sign * c[i + 2])).map((most) => most > 0);
    const told = [];
    if (signs[0] && signs[1]) told.push("The band is the cue: orange where it raises its field, blue where it lowers it.");
    else if (signs[0] || signs[1]) told.push(`The ${signs[0] ? "orange" : "blue"} band is the cue, which ${signs[0] ? "raises" : "lowers"} its field.`);
    const [above, below] = shown(({ phi }, sign) => this.most(phi, 1, (all, i) => sign * all[i]));
    const parts = [above > 0 ? `orange above 0, to ${Number(above.toPrecision(2))}` : "", below > 0 ? `blue below 0, to −${Number(below.toPrecision(2))}` : ""].filter((part) => part);
    if (parts.length) told.push(`The ${told.length ? "outer " : ""}band is the regulator φ: ${parts.join(", ")}.`);
    return told.join(" ");
  }

  /** What the last contour shows, in words. */
  shows() {
    const cut = this.parts();
    const parts = cut.filter((part) => part >= THREAD);
    const [left, right] = this.poles;
    const share = (part) => `${(100 * part).toFixed(0)} %`;
    const shell = "in its shell (broken line)";
    if (this.answer.chi == null) {
      const waists = ["", ", with one shallow furrow", ", with two shallow furrows"][parts.length - 1] ?? "";
      return `Shown is the cell at rest ${shell}, undivided${waists}.`;
    }
    const { u_furrow: u } = this.answer;
    // The contour begins at u = 0, on the right unless it is mirrored.
    const posterior = this.sign > 0 ? u : 1 - u;
    const begin = `Shown is the cell at pinch-off ${shell}: the furrow at u = ${number(u, 3)}`;
    if (parts.length < 3) {
      const thread = cut.length > parts.length ? " Between them is the thread that is left of the neck." : "";
      return `${begin} cuts it in two, on the left ${left} (${share(parts[0])} of the volume), on the right ${right} (${share(parts[1] ?? 0)}).${thread}`;
    }
    const [first, other] = posterior < 0.5 ? [`right, ${right},`, "left"] : [`left, ${left},`, "right"];
    return `${begin} is the first of ${parts.length - 1} to pinch off. The contour has ${parts.length} parts, from the left ${parts.map(share).join(", ")} of the volume: the one on the ${first} is one daughter, the others together are the one on the ${other}.`;
  }

  /** The frame at a place, between two steps as if everything moved straight from one to the other. */
  at(place) {
    const { frames, places } = this;
    let after = places.findIndex((other) => other >= place);
    if (after < 0) after = frames.length - 1;
    if (after === 0) return frames[0];
    const [a, b] = [frames[after - 1], frames[after]];
    const share = (place - places[after - 1]) / (places[after] - places[after - 1] || 1);
    const between = (from, to) => from.map((value, i) => value + share * (to[i] - value));
    return {
      t: a.t + share * (b.t - a.t),
      neck: a.neck !== null && b.neck !== null ? a.neck + share * (b.neck - a.neck) : share > 0.5 ? b.neck : a.neck,
      contour: between(a.contour, b.contour),
      phi: between(a.phi, b.phi),
      arrows: after === 1 && share < 1 ? a.arrows : between(a.arrows, b.arrows),
    };
  }
}

/** Indices at which radii have a minimum that is a furrow: a tenth below what is on either side of it. */
function waists(radii) {
  const found = [];
  let [top, low, at] = [0, Infinity, -1];
  radii.forEach((radius, k) => {
    if (at < 0 || radius < low) [low, at] = [radius, k];
    if (radius > top && low >= 0.9 * top) [top, low, at] = [radius, radius, k];
    // Behind a minimum: it is one if the contour has come up again.
    if (low < 0.9 * top && radius * 0.9 > low) {
      found.push(at);
      [top, low, at] = [radius, radius, k];
    }
  });
  return found;
}

/** Draws a frame of a recording into a canvas. */
function drawCell(canvas, recording, frame, { forces = true, size = null } = {}) {
  const taken = sheet(canvas, size);
  if (!taken) return;
  const [{ paint, width, height }, ink] = [taken, theme()];
  paint.fillStyle = ink.ground;
  paint.fillRect(0, 0, width, height);
  const { wall } = recording.answer;
  const [b, a] = [0, 1].map((c) => Math.max(...wall.map((place) => Math.abs(place[c]))));
  // A contour may leave its shell, which is soft, by a little.
  const scale = Math.min((width - 44) / (2.24 * a), (height - 44) / (2.24 * b));
  const px = (z) => width / 2 + recording.sign * scale * z;
  const py = (r) => height / 2 - 6 - scale * r;

  paint.strokeStyle = ink.line;
  paint.setLineDash([2, 4]);
  drawLine(paint, [px(-1.1 * a), py(0)], [px(1.1 * a), py(0)]);
  paint.setLineDash([6, 4]);
  paint.strokeStyle = ink.shell;
  paint.lineWidth = 1.2;
  const around = [...wall, ...wall.map(([r, z]) => [-r, z]).reverse()];
  drawLine(paint, ...around.map(([r, z]) => [px(z), py(r)]));
  paint.setLineDash([]);

  const { contour, phi } = frame;
  const outline = new Path2D();
  for (let i = 0; i < contour.length; i += 3) outline.lineTo(px(contour[i + 1]), py(contour[i]));
  for (let i = contour.length - 3; i >= 0; i -= 3) outline.lineTo(px(contour[i + 1]), py(-contour[i]));
  outline.closePath();
  paint.fillStyle = ink.cell;
  paint.fill(outline);
  // Of two bands under the contour the wider shows outside the other.
  const band = (value, strongest, width) => drawBand(paint, contour, { value, strongest, width }, px, py, ink);
  if (recording.strongestPhi > 0) band((k) => phi[k], recording.strongestPhi, recording.strongest > 0 ? 18 : 9);
  if (recording.strongest > 0) band((k) => contour[3 * k + 2], recording.strongest, 8);
  paint.strokeStyle = ink.text;
  paint.lineWidth = 1.8;
  paint.lineJoin = "round";
  paint.stroke(outline);
  if (forces) drawForces(paint, recording, frame.arrows, px, py, ink);
  drawScale(paint, scale, recording.units, width, height, ink);
  // What the two ends of the axis are.
  const [left, right] = recording.poles;
  write(paint, `← ${left}`, 10, 16);
  write(paint, `${right} →`, width - 10, 16, "right");
  canvas.setAttribute("aria-label", `The cell's contour in its shell: ${left} on the left, ${right} on the right`);
}

/** A value of each point as a band under the contour: as strong as the value is there, in another colour where it is below 0. */
function drawBand(paint, contour, { value, strongest, width }, px, py, ink) {
  paint.lineCap = "butt";
  paint.lineWidth = width;
  // Stretches of about the same strength are one line, so that no seams are seen.
  const steps = 10;
  const last = contour.length / 3 - 1;
  const level = (k) => Math.round((steps * (value(k) + value(k + 1))) / 2 / strongest);
  for (let k = 0; k < last; ) {
    const strength = level(k);
    let end = k + 1;
    while (end < last && level(end) === strength) end += 1;
    if (strength !== 0) {
      paint.strokeStyle = strength > 0 ? ink.cue : ink.lowers;
      paint.globalAlpha = Math.abs(strength) / steps;
      for (const side of [1, -1]) {
        drawLine(paint, ...Array.from({ length: end - k + 1 }, (_, j) => [px(contour[3 * (k + j) + 1]), py(side * contour[3 * (k + j)])]));
      }
    }
    k = end;
  }
  paint.globalAlpha = 1;
}

function drawForces(paint, recording, arrows, px, py, ink) {
  const most = 18;
  paint.strokeStyle = paint.fillStyle = ink.force;
  paint.lineWidth = 1.1;
  for (let i = 0; i < arrows.length; i += 4) {
    const [r, z, alongR, alongZ] = arrows.slice(i, i + 4);
    const force = Math.hypot(alongR, alongZ);
    const length = Math.min(1.5 * most, (most * force) / recording.reference);
    if (length < 2) continue;
    for (const side of [1, -1]) {
      const [dx, dy] = [(recording.sign * length * alongZ) / force, (-side * length * alongR) / force];
      const [x, y] = [px(z), py(side * r)];
      drawLine(paint, [x, y], [x + dx, y + dy]);
      const [ux, uy] = [dx / length, dy / length];
      const head = Math.min(4, length / 2);
      paint.beginPath();
      paint.moveTo(x + dx + ux, y + dy + uy);
      paint.lineTo(x + dx - head * ux + 0.5 * head * uy, y + dy - head * uy - 0.5 * head * ux);
      paint.lineTo(x + dx - head * ux - 0.5 * head * uy, y + dy - head * uy + 0.5 * head * ux);
      paint.fill();
    }
  }
}

/** Least length of a scale bar, in CSS pixels. */
const BAR = 36;

/** A bar of 1, 2 or 5 times a power of ten, in µm or in Lₕ; `scale` is the pixels of one Lₕ. */
function drawScale(paint, scale, { length_um }, width, height, ink) {
  const pixels = scale / (length_um ?? 1);
  const length = roundStep(BAR / pixels);
  paint.strokeStyle = paint.fillStyle = ink.faint;
  paint.lineWidth = 1.5;
  drawLine(paint, [12, height - 10], [12 + length * pixels, height - 10]);
  write(paint, `${length} ${length_um ? "µm" : "Lₕ"}`, 12, height - 15);
  write(paint, "axis of division", width - 12, height - 12, "right");
}

/** The film of a cell in its panel. */
class Player extends Playing {
  constructor({ canvas, button, slider, label, note, forces }) {
    super(button, slider);
    Object.assign(this, { canvas, label, note, forces });
    this.recording = null;
    forces.addEventListener("change", () => this.draw());
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  show(recording, playing = false) {
    this.recording = recording;
    this.slider.disabled = this.button.disabled = element("film-picture").disabled = recording === null;
    this.note.textContent = recording && !recording.even ? "Most of the time is spent waiting at a shape that hardly changes: the film runs faster there." : "";
    this.seek(0);
    if (!recording) {
      this.pause();
      this.label.textContent = "";
    } else if (playing && !matchMedia("(prefers-reduced-motion: reduce)").matches) {
      this.play();
    } else {
      this.pause();
      this.seek(0.75);
    }
  }

  play() {
    if (this.recording) super.play();
  }

  drawInto(canvas, size) {
    drawCell(canvas, this.recording, this.recording.at(this.place), { forces: this.forces.checked, size });
  }

  draw() {
    if (!this.recording) {
      const { canvas } = this;
      canvas.getContext("2d").clearRect(0, 0, canvas.width, canvas.height);
      return;
    }
    const frame = this.recording.at(this.place);
    this.drawInto(this.canvas);
    const neck = frame.neck === null ? "no waist yet" : `neck ${lengthText(frame.neck, this.recording.units, 3)}`;
    this.label.textContent = `t = ${timeText(frame.t, this.recording.units)}, ${neck}`;
    this.slider.setAttribute("aria-valuetext", this.label.textContent);
  }
}
