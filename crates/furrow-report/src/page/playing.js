// Plays a film.

/** A film with a slider and a button; `draw` shows its place, from 0 to 1. */
class Playing {
  constructor(button, slider) {
    Object.assign(this, { button, slider });
    this.playing = false;
    this.place = 0;
    button.addEventListener("click", () => (this.playing ? this.pause() : this.play()));
    slider.addEventListener("input", () => {
      this.pause();
      this.seek(Number(slider.value));
    });
  }

  play() {
    if (this.place >= 1) this.place = 0;
    this.playing = true;
    this.told();
    let last = performance.now();
    const lasts = 4500;
    const next = (now) => {
      if (!this.playing) return;
      this.seek(Math.min(1, this.place + (now - last) / lasts));
      last = now;
      if (this.place >= 1) this.pause();
      else requestAnimationFrame(next);
    };
    requestAnimationFrame(next);
  }

  pause() {
    this.playing = false;
    this.told();
  }

  told() {
    this.button.textContent = this.playing ? "Pause" : "Play";
  }

  seek(place) {
    this.place = place;
    this.slider.value = String(place);
    this.draw();
  }
}
