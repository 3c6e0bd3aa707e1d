// The picture of the lanes that are shown, for the part of the session that is seen.

const RULER = 22;
const ROW = 18;
const GAP = 5;
const CURVE = 46;
const RIGHT = 10;

class Plot {
  constructor(view, lanes) {
    this.view = view;
    this.lanes = lanes;
    this.chosen = null;
    this.matches = null; // the items that a search found; null: nobody searches
    this.hidden = new Set(); // sorts that the legend switched off
    this.width = 900;
    this.root = svg("svg", { class: "lanes", "aria-hidden": "true" });
    this.cursor = svg("line", { class: "cursor", y1: 0, y2: 0, x1: -1, x2: -1 });
  }

  get gutter() {
    return this.width < 640 ? 92 : 150;
  }

  get room() {
    return Math.max(this.width - this.gutter - RIGHT, 40);
  }

  x(seconds) {
    return this.gutter + ((seconds - this.view.from) / this.view.span) * this.room;
  }

  seconds(x) {
    return this.view.from + ((x - this.gutter) / this.room) * this.view.span;
  }

  draw() {
    const parts = [];
    let y = RULER;
    for (const lane of this.lanes.filter((one) => one.shown)) {
      const height = lane.points ? CURVE : lane.rows.length * ROW;
      parts.push(this._lane(lane, y, height || ROW));
      y += (height || ROW) + GAP;
    }
    this.height = y;
    this.root.setAttribute("viewBox", `0 0 ${this.width} ${y}`);
    this.root.setAttribute("height", y);
    this.cursor.setAttribute("y2", y);
    this.root.replaceChildren(this._clip(), ...this._ruler(), ...parts, this.cursor);
  }

  // Bars and symbols that reach out of sight do not run into the lanes' names.
  _clip() {
    this.clip ??= `clip-${Math.random().toString(36).slice(2)}`;
    const place = { x: this.gutter - 1, y: 0, width: this.room + RIGHT, height: this.height };
    return svg("clipPath", { id: this.clip }, svg("rect", place));
  }

  _ruler() {
    const step = tickStep(this.room / this.view.span, 76);
    return ticks(this.view.from, this.view.to, step).flatMap((at) => [
      svg("line", { x1: this.x(at), x2: this.x(at), y1: RULER - 6, y2: this.height, class: "grid" }),
      svg("text", { x: this.x(at), y: 11, class: "tick" }, clockTime(at, step)),
    ]);
  }

  _lane(lane, y, height) {
    const back = { x: 0, y: y - GAP / 2, width: this.width, height: height + GAP, class: "lane" };
    const clipped = svg("g", { "clip-path": `url(#${this.clip})` });
    clipped.append(...(lane.points ? this._curve(lane, y, height) : this._rows(lane, y)));
    return svg("g", {}, svg("rect", back), this._title(lane, y, height), clipped);
  }

  _title(lane, y, height) {
    const letters = Math.floor((this.gutter - 12) / 6.4);
    const cut = lane.title.length > letters;
    const shown = cut ? `${lane.title.slice(0, letters - 1)}…` : lane.title;
    const middle = y + (lane.points ? height : Math.min(height, ROW)) / 2;
    const text = svg("text", { x: 4, y: middle, class: "title" }, shown);
    if (cut) text.append(svg("title", {}, lane.title));
    return text;
  }

  _rows(lane, y) {
    return lane.rows.flatMap((row, index) => this._row(row, y + index * ROW));
  }

  _row(row, y) {
    const drawn = [];
    let last = null;
    for (const item of inSight(row, this.view.from, this.view.to)) {
      if (this.hidden.has(item.sort)) continue;
      const [x0, x1] = [this.x(item.begin), this.x(item.end)];
      // Seen from afar, what falls on the same pixel and looks the same is drawn once.
      const same = last && last.sort === item.sort && x1 < last.x + 1 && item !== this.chosen;
      if (same && this._found(item) === last.found) continue;
      last = { sort: item.sort, x: Math.max(x1, x0), found: this._found(item) };
      drawn.push(this._item(item, x0, x1, y));
    }
    return drawn;
  }

  _item(item, x0, x1, y) {
    const right = this.gutter + this.room;
    const node = drawItem(item, x0, x1, this.gutter, right, y + 1, ROW - 2);
    if (!this._found(item)) node.classList.add("dim");
    if (item === this.chosen) node.classList.add("chosen");
    return node;
  }

  _found(item) {
    return this.matches === null || this.matches.has(item);
  }

  _curve(lane, y, height) {
    const range = lane.high - lane.low || 1;
    const up = (value) => y + height - 2 - ((value - lane.low) / range) * (height - 4);
    const points = pointsInSight(lane.points, this.view.from, this.view.to);
    const right = this.gutter + this.room;
    const axis = (value, at) => {
      const text = `${value.toPrecision(3) * 1} ${lane.unit}`;
      return svg("text", { x: right - 3, y: at, class: "axis" }, text);
    };
    return [
      svg("path", { d: curvePath(points, (at) => this.x(at), up), class: "curve" }),
      axis(lane.high, y + 7),
      axis(lane.low, y + height - 5),
    ];
  }

  moveCursor(x) {
    const inside = x >= this.gutter && x <= this.gutter + this.room;
    this.cursor.setAttribute("x1", inside ? x : -1);
    this.cursor.setAttribute("x2", inside ? x : -1);
  }
}
