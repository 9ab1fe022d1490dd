// What all pages need: elements by their names, and numbers in words.

const element = (id) => document.getElementById(id);

/** The bytes of an element, which are compressed and in base64. */
async function unpacked(id) {
  const packed = Uint8Array.from(atob(element(id).textContent.trim()), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

/** A number with so many decimals. */
const number = (value, digits = 4) => (value === null || value === undefined ? "–" : value.toFixed(digits).replace("-", "\u2212"));
