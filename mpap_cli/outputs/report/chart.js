"use strict";
/* Draws one chart as SVG: hover or arrow keys tell values, a drag zooms, a double click resets. */
const COLORS = ["#0b62b8", "#d55e00", "#009e73", "#cc79a7", "#8a6d00", "#56b4e9", "#7b4fd0", "#6b7280"];
const SPAN_CLASSES = { "in contact": "contact", alarm: "alarm", predicted: "predicted" };
const EDGE = { left: 46, right: 12, top: 8, bottom: 36 };

function element(name, attributes, parent) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (parent) parent.append(made);
  return made;
}

function ticks(low, high, most) {
  const rough = (high - low) / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((one) => one * power).find((one) => one >= rough);
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step);
  return found.map((value) => Number(value.toPrecision(12)));
}

class Chart {
  constructor(box, data) {
    this.box = box;
    this.data = data;
    this.shown = data.x;
    this.listen();
    this.key();
    new ResizeObserver(() => this.draw()).observe(box);
  }

  draw() {
    const width = Math.max(240, this.box.clientWidth);
    const height = this.data.is_square ? Math.min(width, 420) : 190;
    this.size = { width, height };
    this.box.querySelector("svg")?.remove();
    this.svg = element("svg", { viewBox: `0 0 ${width} ${height}`, height });
    this.box.prepend(this.svg);
    this.axes();
    const id = `clip-${this.data.key}`;
    const clip = element("clipPath", { id }, element("defs", {}, this.svg));
    const [left, right, top, bottom] = this.edges();
    element("rect", { x: left, y: top, width: right - left, height: bottom - top }, clip);
    const inside = element("g", { "clip-path": `url(#${id})` }, this.svg);
    this.spans(inside);
    this.data.series.forEach((one, index) => this.curve(inside, one, index));
    this.marks(inside);
    this.cross = element("line", { class: "cross", y1: top, y2: bottom, visibility: "hidden" }, inside);
    this.chosen = element("rect", { class: "chosen", y: top, height: bottom - top, width: 0 }, inside);
  }

  edges() {
    const { width, height } = this.size;
    return [EDGE.left, width - EDGE.right, EDGE.top, height - EDGE.bottom];
  }

  px(x) {
    const [left, right] = this.edges();
    return left + ((x - this.shown[0]) / (this.shown[1] - this.shown[0])) * (right - left);
  }

  py(y) {
    const [, , top, bottom] = this.edges();
    return bottom - ((y - this.data.y[0]) / (this.data.y[1] - this.data.y[0])) * (bottom - top);
  }

  at(pixel) {
    const [left, right] = this.edges();
    const share = Math.min(1, Math.max(0, (pixel - left) / (right - left)));
    return this.shown[0] + share * (this.shown[1] - this.shown[0]);
  }

  axes() {
    const [left, right, top, bottom] = this.edges();
    for (const value of ticks(...this.data.y, (bottom - top) / 40)) {
      element("line", { class: "grid", x1: left, x2: right, y1: this.py(value), y2: this.py(value) }, this.svg);
      element("text", { x: left - 6, y: this.py(value) + 4, "text-anchor": "end" }, this.svg).textContent = value;
    }
    for (const value of ticks(...this.shown, (right - left) / 80)) {
      element("line", { class: "grid", x1: this.px(value), x2: this.px(value), y1: top, y2: bottom }, this.svg);
      element("text", { x: this.px(value), y: bottom + 15, "text-anchor": "middle" }, this.svg).textContent = value;
    }
    const middle = (left + right) / 2;
    element("text", { x: middle, y: bottom + 31, "text-anchor": "middle" }, this.svg).textContent = this.data.x_label;
    const turned = { transform: `translate(11 ${(top + bottom) / 2}) rotate(-90)`, "text-anchor": "middle" };
    element("text", turned, this.svg).textContent = this.data.y_label;
  }

  spans(parent) {
    const [, , top, bottom] = this.edges();
    const kinds = Object.keys(SPAN_CLASSES);
    for (const [name, start, end] of this.data.spans) {
      const row = kinds.indexOf(name);
      const tall = row === 0 ? bottom - top : 5;
      const width = Math.max(1, this.px(end) - this.px(start));
      const look = `fill: var(--${SPAN_CLASSES[name]}); opacity: ${row === 0 ? 0.22 : 0.9}`;
      const y = row === 0 ? top : top + 7 * (row - 1);
      element("rect", { x: this.px(start), y, width, height: tall, style: look }, parent);
    }
  }

  curve(parent, one, index) {
    const color = one.look === "faint" ? "var(--pale)" : COLORS[index % COLORS.length];
    if (one.look === "dots") {
      for (const [x, y] of one.points) element("circle", { cx: this.px(x), cy: this.py(y), r: 5, fill: color }, parent);
      return;
    }
    let path = "";
    let isBroken = true;
    for (const [x, y] of one.points) {
      if (y === null) { isBroken = true; continue; }
      path += `${isBroken ? "M" : "L"}${this.px(x).toFixed(1)} ${this.py(y).toFixed(1)}`;
      isBroken = false;
    }
    element("path", { class: `curve ${one.look}`, d: path, stroke: color }, parent);
  }

  marks(parent) {
    const [, , top, bottom] = this.edges();
    for (const [x, words] of this.data.marks) {
      element("line", { class: "mark", x1: this.px(x), x2: this.px(x), y1: top, y2: bottom }, parent);
      element("text", { x: this.px(x) + 4, y: top + 12 }, parent).textContent = words;
    }
  }

  key() {
    const key = document.createElement("div");
    key.className = "key";
    const add = (color, name) => {
      const part = document.createElement("span");
      const sign = document.createElement("i");
      sign.style.background = color;
      part.append(sign, name);
      key.append(part);
    };
    this.data.series.forEach((one, index) => {
      if (one.look !== "faint") add(COLORS[index % COLORS.length], one.name);
    });
    for (const name of new Set(this.data.spans.map((one) => one[0]))) add(`var(--${SPAN_CLASSES[name]})`, name);
    this.box.after(key);
  }

  nearest(points, x) {
    let best = null;
    for (const point of points) {
      if (point[1] !== null && (best === null || Math.abs(point[0] - x) < Math.abs(best[0] - x))) best = point;
    }
    return best;
  }

  tell(x) {
    this.told = x;
    const short = (value) => Number(value.toPrecision(4));
    const lines = [`${this.data.x_label}: ${short(x)}`];
    for (const one of this.data.series) {
      const point = one.look === "faint" ? null : this.nearest(one.points, x);
      if (point) lines.push(`${one.name}: ${short(point[1])}`);
    }
    for (const [name, start, end] of this.data.spans) if (start <= x && x <= end) lines.push(name);
    this.cross.setAttribute("x1", this.px(x));
    this.cross.setAttribute("x2", this.px(x));
    this.cross.setAttribute("visibility", "visible");
    this.tip ??= this.box.appendChild(Object.assign(document.createElement("div"), { className: "tip" }));
    this.tip.hidden = false;
    this.tip.replaceChildren(...lines.map((line) => Object.assign(document.createElement("div"), { textContent: line })));
    const place = this.px(x) + 10;
    const isFar = place + this.tip.offsetWidth > this.size.width;
    this.tip.style.left = `${Math.max(0, isFar ? this.px(x) - 10 - this.tip.offsetWidth : place)}px`;
    this.tip.style.top = "14px";
  }

  hush() {
    this.cross.setAttribute("visibility", "hidden");
    if (this.tip) this.tip.hidden = true;
  }

  zoom(low, high) {
    const least = (this.data.x[1] - this.data.x[0]) / 10000;
    this.shown = high - low < least ? this.shown : [Math.max(this.data.x[0], low), Math.min(this.data.x[1], high)];
    this.draw();
  }

  listen() {
    let from = null;
    const pixel = (event) => event.clientX - this.box.getBoundingClientRect().left;
    this.box.addEventListener("pointerdown", (event) => { from = pixel(event); });
    this.box.addEventListener("pointermove", (event) => {
      this.tell(this.at(pixel(event)));
      if (from === null) return;
      const [low, high] = [from, pixel(event)].sort((a, b) => a - b);
      this.chosen.setAttribute("x", low);
      this.chosen.setAttribute("width", high - low);
    });
    this.box.addEventListener("pointerup", (event) => {
      const to = pixel(event);
      const start = from;
      from = null;
      if (start !== null && Math.abs(to - start) > 8) this.zoom(...[this.at(start), this.at(to)].sort((a, b) => a - b));
    });
    this.box.addEventListener("pointerleave", () => { from = null; this.draw(); this.hush(); });
    this.box.addEventListener("dblclick", () => { this.shown = this.data.x; this.draw(); });
    this.box.addEventListener("keydown", (event) => this.typed(event));
  }

  typed(event) {
    const span = this.shown[1] - this.shown[0];
    const x = this.told ?? (this.shown[0] + this.shown[1]) / 2;
    if (event.key === "ArrowLeft") this.tell(Math.max(this.shown[0], x - span / 100));
    else if (event.key === "ArrowRight") this.tell(Math.min(this.shown[1], x + span / 100));
    else if (event.key === "+") this.zoom(x - span / 4, x + span / 4);
    else if (event.key === "-") this.zoom(x - span, x + span);
    else if (event.key === "Escape") { this.shown = this.data.x; this.draw(); this.hush(); }
    else return;
    event.preventDefault();
  }
}
