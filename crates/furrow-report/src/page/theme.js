// Dark and light: what the system prefers, until the reader says otherwise. Canvases take their colours from the style sheet.

let inks = null;

/** The colours in force. */
function theme() {
  if (!inks) {
    const style = getComputedStyle(document.documentElement);
    const colour = (name) => style.getPropertyValue(`--${name}`).trim();
    inks = {
      dark: colour("scheme") === "dark",
      ground: colour("ground"),
      text: colour("text"),
      faint: colour("faint"),
      line: colour("line"),
      accent: colour("accent"),
      found: colour("found"),
      cell: colour("cell"),
      cue: colour("cue"),
      lowers: colour("cue-low"),
      force: colour("force"),
      shell: colour("shell"),
      stays: colour("stays"),
    };
  }
  return inks;
}

/** A founder's colour, lightened where it would not stand off from a dark ground. */
function shade(colour, ink) {
  if (!ink.dark) return colour;
  const parts = [1, 3, 5].map((k) => parseInt(colour.slice(k, k + 2), 16));
  const light = (0.3 * parts[0] + 0.59 * parts[1] + 0.11 * parts[2]) / 255;
  const mix = Math.max(0.12, 0.62 - light);
  return `rgb(${parts.map((part) => Math.round(part + (255 - part) * mix)).join(" ")})`;
}

/** Sets up the switch; `redraw` is called when colours change. */
function themeSwitch(button, redraw) {
  const system = matchMedia("(prefers-color-scheme: dark)");
  const root = document.documentElement;
  const isDark = () => (root.dataset.theme ? root.dataset.theme === "dark" : system.matches);
  const told = () => {
    inks = null;
    button.setAttribute("aria-pressed", String(isDark()));
    button.textContent = isDark() ? "Light" : "Dark";
    button.setAttribute("aria-label", isDark() ? "Switch to light colours" : "Switch to dark colours");
    redraw();
  };
  button.addEventListener("click", () => {
    root.dataset.theme = isDark() ? "light" : "dark";
    told();
  });
  system.addEventListener("change", told);
  told();
}
