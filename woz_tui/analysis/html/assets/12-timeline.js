// One session's timeline: the plot with everything around it.

const HELP =
  "Click, then scroll to zoom (or Ctrl+scroll). Drag to move. Shift+drag, or a drag on the ruler, " +
  "selects a range. Keys: + − 0 zoom, ← → Home End move, n p next and previous event, Esc clears.";

class Timeline {
  // `address(from, to, number)` makes the hash that leads back to a view; `moved` is told of each.
  constructor(figure, table, data, { titles, address, moved }) {
    Object.assign(this, readLanes(data));
    this.inTime = [...this.items].sort((a, b) => a.begin - b.begin || a.number - b.number);
    this.view = new View(data.end);
    this.plot = new Plot(this.view, this.lanes);
    this.minimap = new Minimap(this.plot);
    this.moved = moved;
    this._build(figure, figure.dataset.title, data.zero, titles);
    this.events = new EventList(table, this.items, titles, address);
    this.redraw = oncePerFrame(() => this._draw());
    this.view.listeners.push(this.redraw, moved);
    new ResizeObserver(() => this._resize()).observe(this.holder);
    this._resize();
  }

  _build(figure, title, zero, titles) {
    const about = `Timeline of ${title}. ${HELP}`;
    const role = { role: "application", "aria-roledescription": "timeline", "aria-label": about };
    this.holder = el("div", { class: "plot", tabindex: 0, ...role }, this.plot.root);
    this.range = el("output", { class: "range" });
    const changed = () => this._filtered();
    const tools = el("div", { class: "tools" }, zoomButtons(this.view), this._search());
    tools.append(laneMenu(this.lanes, changed), this.range);
    const chips = legend(this.items, titles, this.plot.hidden, changed);
    const help = el("p", { class: "help" }, HELP);
    figure.querySelector(".static").replaceWith(tools, chips, this.holder, this.minimap.root, help);
    this.tip = new Tip(this.holder, zero, titles);
    keysMove(this.holder, keyTable(this.view, this));
    wheelZooms(this.plot, this.holder);
    new Drags(this.plot, this.holder, (event) => this.choose(this._at(event)));
    this.plot.root.addEventListener("pointermove", (event) => this._hover(event));
    this.plot.root.addEventListener("pointerleave", () => this._leave());
  }

  _search() {
    const searched = (words) => {
      const found = words && this.items.filter((item) => item.words.includes(words));
      this.plot.matches = words ? new Set(found) : null;
      this._filtered();
      return words ? `${found.length} of ${this.items.length}` : "";
    };
    return searchField(searched, (by) => this.step(by));
  }

  shown(item) {
    const { matches, hidden } = this.plot;
    return item.lane.shown && !hidden.has(item.sort) && (matches === null || matches.has(item));
  }

  // Selects the next (1) or previous (-1) event that is shown, beginning at what is seen.
  step(by) {
    const list = this.inTime.filter((item) => this.shown(item));
    const at = list.indexOf(this.plot.chosen);
    const seen = list.findIndex((item) => item.begin >= this.view.from);
    const next = at >= 0 ? at + by : Math.max(seen, 0);
    if (list.length) this.choose(list[clamp(next, 0, list.length - 1)], true);
  }

  // Selects an item, or nothing; `reveal` brings it into sight.
  choose(item, reveal = false) {
    this.plot.chosen = item;
    this.events.choose(item);
    if (item && reveal) this.view.reveal(item.begin, item.end);
    if (item) this.tip.say(item);
    this._draw();
    this.moved();
    this._tipOfChosen();
  }

  chooseNumber(number) {
    this.choose(this.items[number] ?? null);
  }

  _tipOfChosen() {
    const { chosen } = this.plot;
    const node = chosen && this.plot.root.querySelector(`[data-number="${chosen.number}"]`);
    if (!node) {
      this.tip.hide();
      return;
    }
    const [box, own] = [node.getBoundingClientRect(), this.holder.getBoundingClientRect()];
    this.tip.show(chosen, box.left - own.left + Math.min(box.width, 40), box.bottom - own.top);
  }

  _at(event) {
    const node = event.target.closest("[data-number]");
    return node ? this.items[Number(node.dataset.number)] : null;
  }

  _hover(event) {
    const box = this.plot.root.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    this.plot.moveCursor(x);
    this._tellRange(this.plot.seconds(x));
    const item = event.buttons ? null : this._at(event);
    if (item) this.tip.show(item, x, y);
    else this._tipOfChosen();
  }

  _leave() {
    this.plot.moveCursor(-1);
    this._tellRange();
    this._tipOfChosen();
  }

  _filtered() {
    if (this.plot.chosen && !this.shown(this.plot.chosen)) this.choose(null);
    this.events.filter(this.items, (item) => this.shown(item));
    this._draw();
    this.minimap.draw();
  }

  _resize() {
    const width = Math.floor(this.holder.clientWidth);
    // Nothing to draw on while the section is closed.
    if (!width || width === this.minimap.width) return;
    this.minimap.width = this.plot.width = width;
    this._draw();
    this.minimap.draw();
  }

  _draw() {
    this.plot.draw();
    this.minimap.follow();
    this._tellRange();
    Object.assign(this.holder.dataset, { from: this.view.from, to: this.view.to });
    if (!this.tip.box.hidden) this._tipOfChosen();
  }

  // The part that is seen; with the pointer in it also its place, and what the curves are there.
  _tellRange(at = null) {
    const { from, to, span } = this.view;
    const step = span / 1000;
    const range = `${clockTime(from, step)} – ${clockTime(to, step)}  (${duration(span)})`;
    if (at === null || at < from || at > to) {
      this.range.textContent = range;
      return;
    }
    const values = this.lanes.filter((lane) => lane.points && lane.shown).map((lane) => {
      const value = valueAt(lane.points, at);
      return value === null ? "" : `   ${lane.title} ${Number(value.toPrecision(3))} ${lane.unit}`;
    });
    this.range.textContent = `at ${clockTime(at, step)}${values.join("")}`;
  }
}
