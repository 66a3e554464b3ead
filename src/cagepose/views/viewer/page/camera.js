// Where the viewer stands: z is up, the mouse turns (drag), moves (shift or right button) and zooms (wheel).

const VIEWS = { corner: [-56, 24], x: [180, 0], y: [-90, 0], z: [-90, 90] };

class Camera {
  // `content()` returns the places that a view is fitted to.
  constructor(canvas, radius, content, changed) {
    this.canvas = canvas;
    this.radius = radius;
    this.content = content;
    this.changed = changed;
    this.home("corner");
    canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener("pointermove", (event) => {
      if (!event.buttons) return;
      const pixels = this.perUnit() / window.devicePixelRatio;
      if (event.shiftKey || event.buttons === 2) {
        const [right, up] = this.axes();
        this.target = add(this.target, add(times(-event.movementX / pixels, right), times(event.movementY / pixels, up)));
      } else {
        this.azimuth -= 0.4 * event.movementX;
        this.elevation = Math.max(-90, Math.min(90, this.elevation + 0.4 * event.movementY));
      }
      changed();
    });
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom *= Math.exp(-0.0015 * event.deltaY);
      changed();
    }, { passive: false });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  home(name) {
    [this.azimuth, this.elevation] = VIEWS[name];
    this.zoom = 1;
    this.fit();
  }

  // Brings everything into view, from the same side and at the same zoom.
  fit() {
    const axes = this.axes();
    const seen = this.content().map((place) => axes.map((axis) => dot(axis, place)));
    const [low, high] = [Math.min, Math.max].map((pick) => axes.map((_, i) => pick(...seen.map((place) => place[i]))));
    this.target = axes.map((axis, i) => times((low[i] + high[i]) / 2, axis)).reduce(add);
    this.half = [0, 1].map((i) => Math.max((high[i] - low[i]) / 2, 0.05));
    this.changed();
  }

  // Right, up and towards the viewer.
  axes() {
    const [a, e] = [this.azimuth, this.elevation].map((degrees) => degrees * Math.PI / 180);
    const right = [-Math.sin(a), Math.cos(a), 0];
    const back = [Math.cos(a) * Math.cos(e), Math.sin(a) * Math.cos(e), Math.sin(e)];
    return [right, cross(back, right), back];
  }

  // Pixels of the canvas to one drawing unit.
  perUnit() {
    return 0.42 * this.zoom * Math.min(this.canvas.width / this.half[0], this.canvas.height / this.half[1]);
  }

  matrix() {
    const axes = this.axes();
    const scale = [2 * this.perUnit() / this.canvas.width, 2 * this.perUnit() / this.canvas.height, -0.05 / this.radius];
    const rows = axes.map((axis, i) => times(scale[i], axis));
    const shift = rows.map((row) => -dot(row, this.target));
    return [0, 1, 2].flatMap((i) => [rows[0][i], rows[1][i], rows[2][i], 0]).concat([...shift, 1]);
  }

  // Where a place is drawn, in pixels of the canvas from its upper left corner.
  project(place) {
    const [right, up] = this.axes();
    const from = sub(place, this.target);
    return [this.canvas.width / 2 + this.perUnit() * dot(right, from), this.canvas.height / 2 - this.perUnit() * dot(up, from)];
  }
}
