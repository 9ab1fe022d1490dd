// Lines, circles and words on a canvas.

/** Gives a canvas the pixels for [width, height, ratio], by default for what is shown of it; null if nothing is. */
function sheet(canvas, size) {
  const [width, height, ratio] = size ?? [canvas.clientWidth, canvas.clientHeight, window.devicePixelRatio || 1];
  if (!width || !height) return null;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const paint = canvas.getContext("2d");
  paint.setTransform(ratio, 0, 0, ratio, 0, 0);
  return { paint, width, height };
}

/** Draws a line through places. */
function drawLine(paint, ...places) {
  paint.beginPath();
  for (const [x, y] of places) paint.lineTo(x, y);
  paint.stroke();
}

/** Makes a circle the path. */
function circle(paint, x, y, radius) {
  paint.beginPath();
  paint.arc(x, y, radius, 0, 2 * Math.PI);
}

/** Writes words. */
function write(paint, words, x, y, align = "left", { baseline = "alphabetic", size = 11 } = {}) {
  Object.assign(paint, { textAlign: align, textBaseline: baseline, font: `${size}px system-ui, sans-serif` });
  paint.fillText(words, x, y);
}
