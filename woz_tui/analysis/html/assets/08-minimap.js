// The whole session in one line, and in it the part that is seen: drag it, or click elsewhere.

const MINI = 34;

class Minimap {
  constructor(plot) {
    this.plot = plot;
    this.root = svg("svg", { class: "minimap", height: MINI, "aria-hidden": "true" });
    this.frame = svg("rect", { class: "frame", y: 1, height: MINI - 2 });
    this.dragged = null;
    this.root.addEventListener("pointerdown", (event) => this._down(event));
    this.root.addEventListener("pointermove", (event) => this._move(event));
    this.root.addEventListener("pointerup", () => (this.dragged = null));
    this.root.addEventListener("pointercancel", () => (this.dragged = null));
  }

  // All bars as one path for each look: a picture of thousands of items stays light.
  draw() {
    const { plot } = this;
    const paths = new Map();
    const lanes = plot.lanes.filter((lane) => lane.shown && lane.rows);
    const height = (MINI - 6) / Math.max(lanes.length, 1);
    lanes.forEach((lane, index) => {
      for (const item of lane.items) {
        if (plot.hidden.has(item.sort)) continue;
        const [x0, x1] = [this._x(item.begin), Math.max(this._x(item.end), this._x(item.begin) + 1)];
        const box = `M${x0.toFixed(1)} ${(3 + index * height).toFixed(1)}H${x1.toFixed(1)}`;
        const bar = `${box}v${Math.max(height - 0.6, 0.8).toFixed(1)}H${x0.toFixed(1)}z`;
        paths.set(item.sort, (paths.get(item.sort) ?? "") + bar);
      }
    });
    this.root.setAttribute("viewBox", `0 0 ${plot.width} ${MINI}`);
    const back = { class: "back", x: plot.gutter, y: 0, width: plot.room, height: MINI };
    this.root.replaceChildren(
      svg("rect", back),
      ...[...paths].map(([sort, d]) => svg("path", { d, class: `bar s-${sort}` })),
      this.frame,
      svg("text", { class: "title", x: 4, y: MINI / 2 }, "Whole session"),
    );
    this.follow();
  }

  follow() {
    const { view } = this.plot;
    this.frame.setAttribute("x", this._x(view.from));
    this.frame.setAttribute("width", Math.max(this._x(view.to) - this._x(view.from), 3));
  }

  _x(seconds) {
    return this.plot.gutter + (seconds / this.plot.view.end) * this.plot.room;
  }

  _seconds(event) {
    const x = event.clientX - this.root.getBoundingClientRect().left;
    return ((x - this.plot.gutter) / this.plot.room) * this.plot.view.end;
  }

  _down(event) {
    const { view } = this.plot;
    const at = this._seconds(event);
    const inside = at >= view.from && at <= view.to;
    if (!inside) view.show(at - view.span / 2, at + view.span / 2);
    this.dragged = at - view.from;
    this.root.setPointerCapture(event.pointerId);
  }

  _move(event) {
    if (this.dragged === null) return;
    const { view } = this.plot;
    const from = this._seconds(event) - this.dragged;
    view.show(from, from + view.span);
  }
}
