"use strict";
// Vue component "wr-drawing": draws the plain data of wheelrail/scenes/plots/drawing.py on a canvas.
// Emits "pick" with {x, y} in the units of the axes when the pointer is pressed or dragged over them.
window.wheelrail_explorer = (() => {
  const FONT = "12px system-ui, sans-serif";
  const LINE = 16; // pixels from one line of text to the next
  const LEFT = 70, RIGHT = 14, BAR = 72, TOP = 26; // pixels beside and above the axes
  const LOWEST = 110, TALLEST = 480, GIVEN = 260; // pixels of height: of axes of equal scale, and of a whole picture
  const DASH = [6, 3], MARK = 4; // pixels: of dashed lines, half the size of marks
  const THEMES = {
    light: { ink: "#222222", faint: "#e4e4e4", frame: "#8a8a8a", veil: "rgba(255, 255, 255, 0.9)" },
    dark: { ink: "#dddddd", faint: "#3a3a3a", frame: "#8a8a8a", veil: "rgba(30, 30, 30, 0.9)" },
  };

  function widened([low, high], length) {
    const middle = 0.5 * (low + high);
    return [middle - 0.5 * length, middle + 0.5 * length];
  }

  // Round numbers in an interval, with their texts.
  function ticks([low, high], count) {
    const rough = (high - low) / Math.max(count, 1);
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = power * [1, 2, 5, 10].find(factor => factor * power >= 0.999 * rough);
    const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const small = digits < 5 && Math.max(Math.abs(low), Math.abs(high)) < 1e5;
    const first = Math.ceil(low / step - 1e-9), last = Math.floor(high / step + 1e-9);
    return Array.from({ length: last - first + 1 }, (_, k) => {
      const value = (first + k) * step;
      const text = small ? value.toFixed(digits) : Number(value.toPrecision(6)).toExponential();
      return [value, text.replace("-", "−")];
    });
  }

  // Lines of a text that are not longer than a width.
  function wrapped(pen, text, width) {
    const lines = [""];
    for (const word of text.split(" ")) {
      const longer = `${lines.at(-1)} ${word}`.trim();
      if (lines.at(-1) && pen.measureText(longer).width > width) lines.push(word);
      else lines[lines.length - 1] = longer;
    }
    return lines;
  }

  // Entries of the legend, each with its row and distance from the left end.
  function legendOf(pen, drawing, width) {
    const lines = drawing.layers.filter(layer => layer.kind === "Line" && layer.label);
    const areas = drawing.legend.map(([colour, text]) => ({ kind: "area", colour, label: text }));
    let row = 0, x = 0;
    return [...lines, ...areas].map(item => {
      const size = 40 + pen.measureText(item.label).width;
      if (x > 0 && x + size > width) [row, x] = [row + 1, 0];
      x += size;
      return { item, row, x: x - size };
    });
  }

  // Places of everything, those of whole numbers by `dot`, for a width of the canvas, and its height; a given height of 0 follows from the data.
  function layout(pen, drawing, width, given) {
    pen.font = FONT;
    const w = Math.max(width - LEFT - (drawing.bar ? BAR : RIGHT), 40);
    const legend = legendOf(pen, drawing, w);
    const rows = legend.length ? 1 + legend.at(-1).row : 0;
    const label = wrapped(pen, drawing.x_label, w);
    const notes = drawing.notes.flatMap(note => wrapped(pen, note, width - LEFT));
    const below = LINE * (1 + label.length + rows + notes.length) + 12;
    let x = drawing.x_limits, y = drawing.y_limits;
    let h = Math.max((given || GIVEN) - TOP - below, 40);
    if (drawing.equal) {
      if (!given) h = Math.min(Math.max(w * (y[1] - y[0]) / (x[1] - x[0]), LOWEST), TALLEST);
      const scale = Math.max((x[1] - x[0]) / w, (y[1] - y[0]) / h);
      [x, y] = [widened(x, scale * w), widened(y, scale * h)];
    }
    const at = ([a, b]) => [LEFT + w * (a - x[0]) / (x[1] - x[0]), TOP + h * (y[1] - b) / (y[1] - y[0])];
    const [[first], [lowest], [along, up]] = [drawing.x_limits, drawing.y_limits, drawing.unit];
    const dot = ([a, b]) => at([first + along * a, lowest + up * b]);
    return { w, h, x, y, at, dot, legend, rows, label, notes, height: TOP + h + below };
  }

  // Polygons or lines of one path, which is painted at once.
  function path(pen, shapes, close = false) {
    pen.beginPath();
    for (const points of shapes) {
      points.forEach(([x, y], k) => (k ? pen.lineTo(x, y) : pen.moveTo(x, y)));
      if (close) pen.closePath();
    }
  }

  function mark(pen, [x, y], marker, colour) {
    const s = MARK, triangle = [[x, y - s], [x + s, y + s], [x - s, y + s]];
    if (marker === "o") {
      pen.beginPath();
      pen.arc(x, y, s, 0, 2 * Math.PI);
    } else if (marker === "D") path(pen, [[[x, y - s], [x + s, y], [x, y + s], [x - s, y]]], true);
    else path(pen, [marker === "^" ? triangle : triangle.map(([a, b]) => [a, 2 * y - b])], true);
    pen.fillStyle = colour;
    pen.fill();
    [pen.strokeStyle, pen.lineWidth] = ["#ffffff", 0.8];
    pen.stroke();
  }

  // Colours of lines were chosen for white paper: those that would vanish on a dark page are mixed with white.
  function visible(colour, dark) {
    const parts = /^#(..)(..)(..)$/.exec(colour)?.slice(1).map(part => parseInt(part, 16));
    if (!dark || !parts || 0.3 * parts[0] + 0.59 * parts[1] + 0.11 * parts[2] > 110) return colour;
    return `rgb(${parts.map(part => Math.round(0.55 * part + 0.45 * 255)).join(" ")})`;
  }

  // Corners moved outwards by half a pixel, which hides the seams between cells.
  function grown(corners) {
    const middle = [0, 1].map(axis => 0.25 * corners.reduce((sum, point) => sum + point[axis], 0));
    return corners.map(point => point.map((value, axis) => value + 0.5 * Math.sign(value - middle[axis])));
  }

  // Outline of an arrow in pixels; one that cannot be seen has none.
  function arrow(x, y, across, down) {
    const length = Math.hypot(across, down), u = across / length, v = down / length;
    if (length < 0.5) return [];
    const head = Math.min(7, length), neck = length - head, wide = 0.45 * head, thin = Math.min(0.9, wide);
    const outline = [[0, thin], [neck, thin], [neck, wide], [length, 0], [neck, -wide], [neck, -thin], [0, -thin]];
    return outline.map(([s, t]) => [x + s * u - t * v, y + s * v + t * u]);
  }

  const PAINT = {
    Cells(pen, layer, at) {
      const shapes = new Map(); // by colour
      layer.points.forEach((corners, k) => {
        const colour = layer.colours[layer.values[k]];
        if (!shapes.has(colour)) shapes.set(colour, []);
        shapes.get(colour).push(grown(corners.map(at)));
      });
      for (const [colour, ofColour] of shapes) {
        path(pen, ofColour, true);
        pen.fillStyle = colour;
        pen.fill();
      }
    },
    Arrows(pen, layer, at) {
      const shapes = layer.points.map(([x, y], k) => {
        const [a, b] = at([x, y]), [c, d] = at([x + layer.vector[k][0], y + layer.vector[k][1]]);
        return arrow(a, b, c - a, d - b);
      });
      path(pen, shapes, true);
      [pen.fillStyle, pen.strokeStyle, pen.lineWidth] = [layer.colour, "#333333", 0.8];
      if (layer.colour === "white") pen.stroke();
      pen.fill();
    },
    Segments(pen, layer, at) {
      path(pen, layer.points.map(ends => ends.map(at)));
      [pen.strokeStyle, pen.lineWidth] = [layer.colour, layer.width];
      pen.stroke();
    },
    Line(pen, layer, at, dark) {
      const pieces = [[]], colour = visible(layer.colour, dark);
      for (const point of layer.points) {
        if (point) pieces.at(-1).push(at(point));
        else pieces.push([]);
      }
      if (layer.width > 0) {
        path(pen, pieces);
        [pen.strokeStyle, pen.lineWidth] = [colour, 1.2 * layer.width];
        pen.setLineDash(layer.dash ? DASH : []);
        pen.stroke();
        pen.setLineDash([]);
      }
      if (layer.marker) for (const point of pieces.flat()) mark(pen, point, layer.marker, colour);
    },
  };

  function write(pen, text, x, y, align = "center", turned = false) {
    pen.save();
    pen.translate(x, y);
    if (turned) pen.rotate(-0.5 * Math.PI);
    [pen.textAlign, pen.textBaseline] = [align, "middle"];
    pen.fillText(text, 0, 0);
    pen.restore();
  }

  function paintAxes(pen, drawing, place, theme) {
    const { w, h, x, y, at, label, notes, rows } = place, bottom = TOP + h;
    pen.lineWidth = 1;
    for (const [axis, limits, space] of [[0, x, w / 75], [1, y, h / 38]]) {
      for (const [value, text] of ticks(limits, space)) {
        const [a, b] = at(axis ? [x[0], value] : [value, y[0]]);
        path(pen, [axis ? [[a, b], [a + w, b]] : [[a, b], [a, b - h]]]);
        pen.strokeStyle = theme.faint;
        pen.stroke();
        pen.fillStyle = theme.ink;
        axis ? write(pen, text, a - 5, b, "right") : write(pen, text, a, b + 11);
      }
    }
    path(pen, [[[LEFT, TOP], [LEFT, bottom], [LEFT + w, bottom]]]);
    pen.strokeStyle = theme.frame;
    pen.stroke();
    label.forEach((text, k) => write(pen, text, LEFT + 0.5 * w, bottom + LINE * (1.8 + k)));
    const turned = wrapped(pen, drawing.y_label, h + TOP);
    turned.forEach((text, k) => write(pen, text, 9 + (LINE - 3) * k, TOP + 0.5 * h, "center", true));
    notes.forEach((text, k) => write(pen, text, LEFT, bottom + LINE * (2 + label.length + rows + k) + 2, "left"));
    pen.font = `600 ${FONT}`;
    write(pen, drawing.title, LEFT, TOP - 13, "left");
    pen.font = FONT;
  }

  function paintLegend(pen, drawing, { legend, label, h }, theme, dark) {
    for (const { item, row, x } of legend) {
      const left = LEFT + x, y = TOP + h + LINE * (2 + label.length + row);
      if (item.kind === "area") {
        pen.fillStyle = item.colour;
        pen.fillRect(left, y - 5, 22, 10);
      } else {
        PAINT.Line(pen, { ...item, points: [[left, y], [left + 22, y]], marker: "" }, point => point, dark);
        if (item.marker) mark(pen, [left + 11, y], item.marker, visible(item.colour, dark));
      }
      pen.fillStyle = theme.ink;
      write(pen, item.label, left + 27, y, "left");
    }
  }

  function paintBar(pen, bar, { w, h }, theme) {
    const left = LEFT + w + 10, size = h / bar.colours.length;
    bar.colours.forEach((colour, k) => {
      pen.fillStyle = colour;
      pen.fillRect(left, TOP + h - (k + 1) * size, 12, size + 0.5);
    });
    pen.fillStyle = theme.ink;
    const values = bar.upper > 0 ? ticks([0, bar.upper], h / 38) : [];
    for (const [value, text] of values) write(pen, text, left + 16, TOP + h * (1 - value / bar.upper), "left");
    write(pen, bar.label, left + 54, TOP + 0.5 * h, "center", true);
  }

  // Draws everything and returns the places, from which a point of the canvas is translated to the axes.
  function paint(canvas, drawing, width, given, dark) {
    const pen = canvas.getContext("2d"), place = layout(pen, drawing, width, given);
    const ratio = window.devicePixelRatio || 1, theme = THEMES[dark ? "dark" : "light"];
    const [columns, lines] = [Math.round(width * ratio), Math.round(place.height * ratio)];
    if (canvas.width !== columns) canvas.width = columns;
    if (canvas.height !== lines) canvas.height = lines;
    canvas.style.height = `${place.height}px`;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, place.height);
    [pen.font, pen.lineJoin] = [FONT, "round"];
    paintAxes(pen, drawing, place, theme);
    pen.save();
    pen.beginPath();
    pen.rect(LEFT, TOP, place.w, place.h);
    pen.clip();
    for (const layer of drawing.layers) PAINT[layer.kind](pen, layer, place.dot, dark);
    pen.restore();
    paintLegend(pen, drawing, place, theme, dark);
    if (drawing.bar) paintBar(pen, drawing.bar, place, theme);
    canvas.dataset.drawn = 1 + Number(canvas.dataset.drawn ?? 0);
    return place;
  }

  const component = {
    props: {
      drawing: { type: Object, default: null },
      stale: Boolean,
      reason: { type: String, default: "" },
      dark: Boolean,
      height: { type: Number, default: 0 },
    },
    emits: ["pick"],
    mounted() {
      this.$watch(() => [this.drawing, this.dark, this.height], this.draw, { flush: "post" });
      const fit = () => this.$el.clientWidth !== this.drawnWidth && this.draw();
      this.resizes = new ResizeObserver(() => requestAnimationFrame(fit)); // drawing changes the observed height
      this.resizes.observe(this.$el);
    },
    beforeUnmount() {
      this.resizes.disconnect();
    },
    methods: {
      draw() {
        const width = this.$el.clientWidth, { canvas } = this.$refs;
        if (!this.drawing || !width) return;
        this.drawnWidth = width;
        this.place = paint(canvas, window.Vue.toRaw(this.drawing), width, this.height, this.dark);
      },
      pick(event) {
        if (!this.place || !this.$.vnode.props?.onPick) return;
        const { w, h, x, y } = this.place;
        const [a, b] = [(event.offsetX - LEFT) / w, 1 - (event.offsetY - TOP) / h];
        if (event.type === "pointerdown") {
          if (a < 0 || a > 1 || b < 0 || b > 1) return;
          this.$refs.canvas.setPointerCapture(event.pointerId);
        } else if (!this.$refs.canvas.hasPointerCapture(event.pointerId)) return;
        const [s, t] = [a, b].map(share => Math.min(Math.max(share, 0), 1));
        this.$emit("pick", { x: x[0] + s * (x[1] - x[0]), y: y[0] + t * (y[1] - y[0]) });
      },
    },
    render() {
      const { h } = window.Vue, { veil, ink } = THEMES[this.dark ? "dark" : "light"];
      const over = { position: "absolute", inset: "30% 10% auto", padding: "8px", textAlign: "center", font: FONT };
      const canvas = {
        ref: "canvas",
        role: "img",
        "aria-label": this.drawing?.title,
        style: {
          display: this.drawing ? "block" : "none",
          width: "100%",
          filter: this.stale ? "grayscale(1) opacity(0.4)" : "none",
          cursor: this.$.vnode.props?.onPick ? "crosshair" : "default",
          touchAction: "pan-y",
        },
        onPointerdown: this.pick,
        onPointermove: this.pick,
      };
      const style = { ...over, background: veil, color: ink };
      const reason = this.reason && h("div", { role: "alert", style }, this.reason);
      const empty = this.drawing ? {} : { minHeight: `${this.height || GIVEN}px` };
      return h("div", { style: { position: "relative", width: "100%", ...empty } }, [h("canvas", canvas), reason]);
    },
  };
  return { install: app => app.component("wr-drawing", component) };
})();
