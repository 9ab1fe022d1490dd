// The phase diagram: activity over radius, with the edge at which the symmetric furrow loses its stability.

/** Ranges of the axes; cells that begin beyond them widen them. */
const AXES = { r0: [1, 6.5], xi: [0, 45] };
const PAD = { left: 44, right: 12, top: 14, bottom: 40 };

class PhaseDiagram {
  constructor(canvas, onPoint) {
    this.canvas = canvas;
    this.edge = null;
    this.printed = page.edge && { epsilon: page.edge.epsilon, pieces: [page.edge.points] };
    this.point = null;
    /** Lₕ in µm, where the axis of radii is in µm. */
    this.lengthUnit = null;
    new ResizeObserver(() => this.draw()).observe(canvas);
    const pick = (event) => {
      const [x, y] = [event.offsetX, event.offsetY];
      const at = ([low, high], share) => low + Math.min(1, Math.max(0, share)) * (high - low);
      const { width, height } = this.inner();
      // As fine as the sliders.
      const unit = this.lengthUnit ?? 1;
      const rounded = (value, decimals) => Number(value.toFixed(decimals));
      onPoint(rounded(unit * at(AXES.r0, (x - PAD.left) / width), 2) / unit, rounded(at(AXES.xi, 1 - (y - PAD.top) / height), 1));
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      pick(event);
    });
    canvas.addEventListener("pointermove", (event) => event.buttons && pick(event));
  }

  inner() {
    return { width: this.canvas.clientWidth - PAD.left - PAD.right, height: this.canvas.clientHeight - PAD.top - PAD.bottom };
  }

  draw() {
    const taken = sheet(this.canvas);
    if (!taken) return;
    const [{ paint }, ink, { width, height }] = [taken, theme(), this.inner()];
    const px = (r0) => PAD.left + ((r0 - AXES.r0[0]) / (AXES.r0[1] - AXES.r0[0])) * width;
    const py = (xi) => PAD.top + (1 - (xi - AXES.xi[0]) / (AXES.xi[1] - AXES.xi[0])) * height;
    paint.save();
    paint.beginPath();
    paint.rect(PAD.left, PAD.top, width, height);
    paint.clip();
    const edge = this.edge ?? this.printed;
    edge?.pieces.forEach((points, k) => this.drawRest(paint, points, edge.pieces[k + 1]?.[0][0], px, py, ink));
    // For comparison, the edge at the ε that the page begins with.
    const other = this.printed && this.edge && this.edge.epsilon !== this.printed.epsilon ? this.printed : null;
    other?.pieces.forEach((points) => this.drawEdge(paint, points, px, py, ink.faint, 1, [4, 3]));
    edge?.pieces.forEach((points) => this.drawEdge(paint, points, px, py, ink.text, 2, []));
    this.drawPoint(paint, px, py, ink);
    paint.restore();
    this.drawAxes(paint, px, py, ink);
    if (edge) this.drawLabels(paint, edge, other, px, py, ink);
  }

  /** Where the symmetric, weakly furrowed shape is stable: below a piece of the edge, up to the next piece. */
  drawRest(paint, points, next, px, py, ink) {
    paint.fillStyle = ink.stays;
    paint.beginPath();
    paint.moveTo(px(points[0][0]), py(0));
    for (const [r0, xi] of points) paint.lineTo(px(r0), py(xi));
    const [end, top] = points[points.length - 1];
    paint.lineTo(px(next ?? end), py(top));
    paint.lineTo(px(next ?? end), py(0));
    paint.fill();
  }

  /** Solid where the pitchfork is supercritical, broken where it is subcritical, unless `dash` says otherwise. */
  drawEdge(paint, points, px, py, colour, width, dash) {
    paint.strokeStyle = colour;
    paint.lineWidth = width;
    paint.setLineDash(dash);
    // Pieces of one strength are one line, so that a broken one is seen to be.
    const pale = (k) => !dash.length && points[k][2] !== null && points[k][2] < 0;
    for (let k = 1; k < points.length; ) {
      const [first, strength] = [k - 1, pale(k)];
      paint.globalAlpha = strength ? 0.5 : 1;
      while (k < points.length && pale(k) === strength) k += 1;
      drawLine(paint, ...points.slice(first, k).map(([r0, xi]) => [px(r0), py(xi)]));
    }
    paint.globalAlpha = 1;
    paint.setLineDash([]);
  }

  drawPoint(paint, px, py, ink) {
    if (!this.point) return;
    const { r0, xi, outcome } = this.point;
    const [x, y] = [px(Math.min(AXES.r0[1], Math.max(AXES.r0[0], r0))), py(Math.min(AXES.xi[1], Math.max(AXES.xi[0], xi)))];
    circle(paint, x, y, 7);
    paint.lineWidth = 3;
    paint.strokeStyle = paint.fillStyle = ink.accent;
    if (outcome === "symmetric") paint.fill();
    paint.stroke();
    if (outcome === "failed") drawLine(paint, [x - 7, y + 12], [x + 7, y + 12]);
  }

  drawAxes(paint, px, py, ink) {
    const { width, height } = this.inner();
    paint.strokeStyle = ink.faint;
    paint.lineWidth = 1;
    paint.strokeRect(PAD.left + 0.5, PAD.top + 0.5, width, height);
    paint.fillStyle = ink.faint;
    const unit = this.lengthUnit ?? 1;
    for (const tick of ticks(AXES.r0.map((end) => end * unit))) {
      paint.fillRect(px(tick / unit), PAD.top + height, 1, 4);
      write(paint, String(tick), px(tick / unit), PAD.top + height + 7, "center", { baseline: "top" });
    }
    write(paint, `R₀, in ${this.lengthUnit ? "µm" : "Lₕ"}`, PAD.left + width / 2, PAD.top + height + 23, "center", { baseline: "top" });
    for (const tick of ticks(AXES.xi)) {
      paint.fillRect(PAD.left - 4, py(tick), 4, 1);
      write(paint, String(tick), PAD.left - 7, py(tick), "right", { baseline: "middle" });
    }
    paint.save();
    paint.translate(12, PAD.top + height / 2);
    paint.rotate(-Math.PI / 2);
    write(paint, "ξₛ", 0, 0, "center", { baseline: "middle" });
    paint.restore();
  }

  drawLabels(paint, edge, other, px, py, ink) {
    paint.fillStyle = ink.faint;
    const style = { baseline: "middle", size: 12 };
    write(paint, "the furrow grows", px(AXES.r0[1]) - 10, PAD.top + 18, "right", style);
    write(paint, "at rest", px(AXES.r0[0]) + 10, PAD.top + this.inner().height - 14, "left", style);
    const here = edge.pieces.map((points) => this.threshold(points)).find((xi) => xi !== null) ?? null;
    const at = here === null ? "" : ` At this R0 it lies at ξₛ = ${here.toFixed(1)}.`;
    const epsilon = ({ epsilon }) => Number(epsilon.toFixed(4));
    const thin = other ? ` The thin broken line is the edge at ε = ${epsilon(other)}, for comparison.` : "";
    const line = edge.why ? `No edge of division was found at ε = ${epsilon(edge)}: ${edge.why}.` : `The line is the edge of division: pitchforks of cells without a cue at ε = ${epsilon(edge)}, pale where subcritical.`;
    element("phase-edge").textContent = line + at + thin;
  }

  /** The activity at which the edge passes the radius of the point, if it does. */
  threshold(points) {
    const r0 = this.point?.r0;
    for (let k = 1; k < points.length; k++) {
      const [a, b] = [points[k - 1], points[k]];
      if ((a[0] - r0) * (b[0] - r0) <= 0 && a[0] !== b[0]) return a[1] + ((b[1] - a[1]) * (r0 - a[0])) / (b[0] - a[0]);
    }
    return null;
  }
}

/** Round numbers along an axis. */
function ticks([low, high]) {
  const step = roundStep((high - low) / 8);
  const count = Math.floor(high / step) - Math.ceil(low / step) + 1;
  return Array.from({ length: count }, (_, k) => Number(((Math.ceil(low / step) + k) * step).toPrecision(6)));
}
