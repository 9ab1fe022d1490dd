// The film of a division as a lit surface that can be turned.

/** Numbers beside the film: field of a frame, name, unit. */
/** Room for the name of a pole beside the cell, and the distance of its middle from the pole, in pixels. */
const NAMES = 78;
const ASIDE = 46;
const NUMBERS = [["t", "t", "τ"], ["neck_radius", "neck radius", "Lₕ"], ["neck_offset", "neck offset", "Lₕ"], ["chi", "χ", ""], ["length", "contour length", "Lₕ"], ["pressure", "pressure", "κ₀/Lₕ³"]];

const VERTEX = `
attribute vec3 at, normal; attribute float value; uniform mat3 turn; uniform vec3 scale; varying vec3 n; varying float v;
void main() { gl_Position = vec4(scale * (turn * at), 1.0); n = turn * normal; v = value; }`;
/** Light from above, from the left and from the viewer's side; what has the colour `line` is not lit. */
const FRAGMENT = `
precision highp float; uniform vec3 low, zero, high; uniform vec4 line; varying vec3 n; varying float v;
void main() {
  vec3 m = normalize(n);
  vec3 colour = mix(zero, v < 0.0 ? low : high, min(abs(v), 1.0));
  float lamp = max(0.0, 0.8 * dot(m, vec3(-0.38, 0.66, 0.65)) + 0.2);
  float shine = pow(max(0.0, dot(m, vec3(-0.209, 0.363, 0.908))), 32.0);
  float rim = pow(1.0 - clamp(m.z, 0.0, 1.0), 3.0);
  vec3 lit = mix(colour * (0.64 + 0.1 * m.y + 0.4 * lamp), vec3(0.15, 0.33, 0.48), 0.4 * rim);
  gl_FragColor = line.a > 0.0 ? line : vec4(mix(lit, vec3(1.0), 0.2 * shine), 1.0);
}`;

/** The frames: points and values as the solver gave them, to 16 bits. */
async function unpackedFrames({ rows, columns, unit, steps }) {
  const bytes = new Uint8Array(await unpacked("film-frames"));
  const half = bytes.length / 2;
  let next = 0;
  return rows.map((count) => {
    const parts = Array.from({ length: 4 }, () => new Int16Array(count * columns));
    for (const part of parts) {
      const bend = new Int16Array(count);
      for (let column = 0; column < columns; column++) {
        for (let row = 0, [before, last] = [0, 0]; row < count; row++, next++) {
          const coded = bytes[next] | (bytes[half + next] << 8);
          bend[row] += (coded >>> 1) ^ -(coded & 1);
          part[row * columns + column] = bend[row] + 2 * last - before;
          [before, last] = [last, part[row * columns + column]];
        }
      }
    }
    const at = new Float32Array(3 * count * columns);
    at.forEach((_, k) => (at[k] = unit * parts[k % 3][(k - (k % 3)) / 3]));
    return { count, at, value: Float32Array.from(parts[3], (value) => value / steps) };
  });
}

/** Normals of a grid, outwards, by the neighbours of each point; at a pole the mean of its points. */
function normals(at, rows, columns) {
  const out = new Float32Array(at.length);
  for (let row = 0; row < rows; row++) {
    // A pole has no neighbours around it.
    const ring = Math.min(Math.max(row, 1), rows - 2);
    const [above, below] = [Math.max(row - 1, 0), Math.min(row + 1, rows - 1)];
    let mean = [0, 0, 0];
    for (let column = 0; column < columns; column++) {
      const point = (row, column) => 3 * (row * columns + ((column + columns) % columns));
      const between = (from, to) => [0, 1, 2].map((c) => at[to + c] - at[from + c]);
      const [a, b] = [between(point(above, column), point(below, column)), between(point(ring, column - 1), point(ring, column + 1))];
      const cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
      const size = Math.hypot(...cross) || 1;
      cross.forEach((x, c) => (mean[c] += out[point(row, column) + c] = x / size));
    }
    if (row === 0 || row === rows - 1) out.subarray(3 * row * columns, 3 * (row + 1) * columns).forEach((_, k, pole) => (pole[k] = mean[k % 3]));
  }
  return out;
}

/** Rings around the shell as pairs of points; its half axes are along x, y and z, and each ring has its r and z in units of them. */
function shellLines([a, b, c], rings) {
  const lines = [];
  for (const [r, z] of rings) {
    const place = (k) => [a * r * Math.cos((k * Math.PI) / 60), b * r * Math.sin((k * Math.PI) / 60), c * z];
    for (let k = 0; k < 120; k++) lines.push(...place(k), ...place(k + 1));
  }
  return new Float32Array(lines);
}

/** Triangles of a grid; those of fewer rows come first. */
function triangles(rows, columns) {
  const out = [];
  for (let k = 0; k < (rows - 1) * columns; k++) {
    const beside = k % columns === columns - 1 ? k + 1 - columns : k + 1;
    out.push(k, k + columns, beside, beside, k + columns, beside + columns);
  }
  return new Uint32Array(out);
}

class Turned extends Playing {
  constructor(data, frames) {
    super(element("play"), element("scrub"));
    Object.assign(this, { data, frames, canvas: element("surface"), zoom: 1, fingers: new Map() });
    this.shown = NUMBERS.filter(([field]) => data.frames.some((frame) => field in frame));
    const entry = ([, name, unit]) => [Object.assign(document.createElement("dt"), { textContent: unit ? `${name}, ${unit}` : name }), document.createElement("dd")];
    element("numbers").append(...this.shown.flatMap(entry));
    this.prepare();
    // Without WebGL nothing of it would be of use.
    this.canvas.closest("section").hidden = false;
    this.hear();
    this.turnBack();
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  /** Programs and buffers of the canvas; they are lost with its context, as on telephones in the background. */
  prepare() {
    // Kept, so that the picture can be saved from the browser's menu.
    const gl = (this.gl = this.canvas.getContext("webgl2", { preserveDrawingBuffer: true }));
    if (!gl) throw new Error("it has no WebGL 2, or WebGL is turned off");
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    gl.useProgram(program);
    gl.enable(gl.DEPTH_TEST);
    this.place3 = ["at", "normal", "value"].map((name) => gl.getAttribLocation(program, name));
    this.uniform = (name) => gl.getUniformLocation(program, name);
    this.buffers = Array.from({ length: 4 }, () => gl.createBuffer());
    ["low", "zero", "high"].forEach((name, k) => gl.uniform3fv(this.uniform(name), this.data.colours[k].map((part) => part / 255)));
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles(Math.max(...this.data.rows), this.data.columns), gl.STATIC_DRAW);
    this.lines = shellLines(this.data.shell, this.data.rings);
  }

  /** Gives the program a number or more for each vertex. */
  give(k, numbers, size) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[k]);
    gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.DYNAMIC_DRAW);
    gl.enableVertexAttribArray(this.place3[k]);
    gl.vertexAttribPointer(this.place3[k], size, gl.FLOAT, false, 0, 0);
  }

  hear() {
    const { canvas, fingers } = this;
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => {
      this.prepare();
      this.draw();
    });
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      fingers.set(event.pointerId, event);
    });
    for (const kind of ["pointerup", "pointercancel"]) canvas.addEventListener(kind, ({ pointerId }) => fingers.delete(pointerId));
    canvas.addEventListener("pointermove", (event) => {
      const before = fingers.get(event.pointerId);
      if (!before) return;
      const apart = () => ((a, b) => Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY))(...fingers.values());
      const was = fingers.size === 2 ? apart() : 0;
      fingers.set(event.pointerId, event);
      if (was > 0) this.zoomBy(apart() / was);
      else if (fingers.size === 1) this.turnBy(0.008 * (event.clientX - before.clientX), 0.008 * (event.clientY - before.clientY));
    });
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoomBy(Math.exp(-0.0015 * event.deltaY));
    }, { passive: false });
    element("back").addEventListener("click", () => this.turnBack());
    document.addEventListener("keydown", (event) => this.key(event));
  }

  key(event) {
    const { key, target } = event;
    const onPicture = target === this.canvas;
    const [right, down] = [(key === "ArrowRight") - (key === "ArrowLeft"), (key === "ArrowDown") - (key === "ArrowUp")];
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (key === " " && target.tagName !== "BUTTON") this.button.click();
    else if (onPicture && (right || down)) this.turnBy(0.1 * right, 0.1 * down);
    else if (onPicture && ["+", "=", "-"].includes(key)) this.zoomBy(key === "-" ? 1 / 1.2 : 1.2);
    else if (onPicture && key === "Home") this.turnBack();
    else if (right) {
      this.pause();
      this.seek(Math.min(1, Math.max(0, (this.number() + right) / (this.frames.length - 1))));
    } else return;
    event.preventDefault();
  }

  /** The first view is that of the other movies: z to the right, x upwards, from above and from the posterior side. */
  turnBack() {
    [this.turn, this.zoom] = [[[0, 0, 1], [1, 0, 0], [0, 1, 0]], 1];
    this.turnBy(-0.42, 0.3);
  }

  /** Turns what is seen to the right and downwards, by angles. The rows are the directions to the right, upwards and to the viewer. */
  turnBy(right, down) {
    const mix = (a, b, angle) => [a.map((x, c) => Math.cos(angle) * x + Math.sin(angle) * b[c]), a.map((x, c) => Math.cos(angle) * b[c] - Math.sin(angle) * x)];
    let [x, y, z] = this.turn;
    [x, z] = mix(x, z, right);
    [z, y] = mix(z, y, down);
    this.turn = [x, y, z];
    this.draw();
  }

  zoomBy(factor) {
    this.zoom = Math.min(12, Math.max(0.5, this.zoom * factor));
    this.draw();
  }

  /** The number of the frame that is shown. */
  number() {
    return Math.round(this.place * (this.frames.length - 1));
  }

  draw() {
    if (!this.turn || !this.canvas.clientWidth) return;
    const { gl, canvas, turn, data } = this;
    const { count, at, value } = this.frames[this.number()];
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    const size = [canvas.clientWidth, canvas.clientHeight];
    size.forEach((length, c) => (canvas[["width", "height"][c]] = Math.round(length * ratio)));
    const along = Math.max(...data.shell.slice(0, 2), ...data.poles.map((z) => Math.abs(z) * data.shell[2]));
    // There is room for the longest axis in every direction, and beside it for the names of the poles.
    const half = Math.min(0.47 * size[1], Math.max(0.5 * size[0] - NAMES, 0.25 * size[0]));
    const pixels = (this.zoom * half) / along;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix3fv(this.uniform("turn"), false, [0, 1, 2].flatMap((c) => turn.map((row) => row[c])));
    gl.uniform3f(this.uniform("scale"), (2 * pixels) / size[0], (2 * pixels) / size[1], -0.3 / along);
    gl.uniform4f(this.uniform("line"), 0, 0, 0, 0);
    // Lines of the shell that touch the surface are drawn before it.
    gl.depthRange(0.004, 1);
    this.give(0, at, 3);
    this.give(1, normals(at, count, data.columns), 3);
    this.give(2, value, 1);
    gl.drawElements(gl.TRIANGLES, 6 * (count - 1) * data.columns, gl.UNSIGNED_INT, 0);
    gl.depthRange(0, 0.996);
    this.give(0, this.lines, 3);
    [1, 2].forEach((k) => gl.disableVertexAttribArray(this.place3[k]));
    const line = theme().shell;
    gl.uniform4f(this.uniform("line"), ...[1, 3, 5].map((k) => parseInt(line.slice(k, k + 2), 16) / 255), 1);
    gl.drawArrays(gl.LINES, 0, this.lines.length / 3);
    this.tell(pixels, size);
  }

  /** Words and numbers of the frame that is shown. */
  tell(pixels, [width, height]) {
    for (const [name, z] of [["posterior", this.data.poles[0]], ["anterior", this.data.poles[1]]]) {
      const [x, y] = this.turn.map((row) => row[2] * (1.05 * pixels * z * this.data.shell[2] + Math.sign(z) * ASIDE));
      const within = (place, length) => Math.min(length - 36, Math.max(36, place));
      Object.assign(element(name).style, { left: `${within(width / 2 + x, width)}px`, top: `${within(height / 2 - y, height)}px` });
    }
    element("scale").style.width = `${pixels}px`;
    const frame = this.data.frames[this.number()];
    const cells = element("numbers").querySelectorAll("dd");
    // Adding 0 takes the sign from −0.
    this.shown.forEach(([field], k) => (cells[k].textContent = number(frame[field] == null ? null : Math.round(1e4 * frame[field]) / 1e4 + 0)));
    this.slider.setAttribute("aria-valuetext", `t = ${number(frame.t)} τ`);
  }
}

async function main() {
  const data = JSON.parse(element("furrow-data").textContent);
  const film = new Turned(data, await unpackedFrames(data));
  element("theme").hidden = false;
  themeSwitch(element("theme"), () => film.draw());
  film.seek(0.75);
  document.documentElement.dataset.ready = "true";
}

main().catch((error) => {
  element("without-film").hidden = false;
  element("without-film").textContent = `This browser cannot show the film: ${error.message}. A film as .gif plays everywhere.`;
});
