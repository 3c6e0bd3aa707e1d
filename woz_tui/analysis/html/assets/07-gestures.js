// Hands on the plot: wheel, drag, two fingers, keys.

// Dragging by less is a click.
const STILL = 4;

// Wheel over the plot: zooms once the timeline was clicked or has the focus, or with Ctrl held.
// Otherwise the page scrolls on, so that nobody is caught in a timeline on the way down.
function wheelZooms(plot, holder) {
  holder.addEventListener(
    "wheel",
    (event) => {
      const meant = event.ctrlKey || event.metaKey || holder.contains(document.activeElement);
      if (!meant) return;
      const sideways = Math.abs(event.deltaX) > Math.abs(event.deltaY) || event.shiftKey;
      if (sideways) {
        const pixels = event.deltaX || event.deltaY;
        plot.view.pan((pixels / plot.room) * plot.view.span);
      } else {
        if (event.deltaY > 0 && plot.view.whole) return;
        const x = event.clientX - plot.root.getBoundingClientRect().left;
        plot.view.zoom(1.0016 ** clamp(event.deltaY, -400, 400), plot.seconds(x));
      }
      event.preventDefault();
    },
    { passive: false },
  );
}

// Drag moves what is seen; drag on the ruler, or with Shift held, marks what is to be seen.
// Two fingers pinch. `clicked` gets presses that did not move.
class Drags {
  constructor(plot, holder, clicked) {
    Object.assign(this, { plot, holder, clicked, fingers: new Map(), band: null });
    plot.root.addEventListener("pointerdown", (event) => this._down(event));
    plot.root.addEventListener("pointermove", (event) => this._move(event));
    plot.root.addEventListener("pointerup", (event) => this._up(event));
    plot.root.addEventListener("pointercancel", (event) => this._forget(event));
  }

  _down(event) {
    if (event.button !== 0) return;
    const x = this._x(event);
    this.fingers.set(event.pointerId, { x, from: x });
    this.start = { x, from: this.plot.view.from, to: this.plot.view.to, moved: false };
    const onRuler = event.clientY - this.plot.root.getBoundingClientRect().top < RULER;
    this.marking = event.shiftKey || onRuler;
    this.holder.focus({ preventScroll: true });
  }

  _move(event) {
    const finger = this.fingers.get(event.pointerId);
    if (!finger) return;
    finger.x = this._x(event);
    if (this.fingers.size === 2) this._pinch();
    else this._drag(event, finger.x);
  }

  _drag(event, x) {
    if (!this.start.moved && Math.abs(x - this.start.x) < STILL) return;
    if (!this.start.moved) {
      this.start.moved = true;
      this.plot.root.setPointerCapture(event.pointerId);
    }
    if (this.marking) {
      this._mark(x);
    } else {
      const by = ((this.start.x - x) / this.plot.room) * (this.start.to - this.start.from);
      this.plot.view.show(this.start.from + by, this.start.to + by);
    }
  }

  _mark(x) {
    this.band ??= this.plot.root.appendChild(svg("rect", { class: "band", y: 0 }));
    this.band.setAttribute("x", Math.min(x, this.start.x));
    this.band.setAttribute("width", Math.abs(x - this.start.x));
    this.band.setAttribute("height", this.plot.height);
  }

  _pinch() {
    const [one, two] = [...this.fingers.values()];
    const { from, to } = this.start;
    const was = Math.abs(one.from - two.from) || 1;
    const span = ((to - from) * was) / Math.max(Math.abs(one.x - two.x), 1);
    const at = from + (((one.from + two.from) / 2 - this.plot.gutter) / this.plot.room) * (to - from);
    const share = ((one.x + two.x) / 2 - this.plot.gutter) / this.plot.room;
    this.start.moved = true;
    this.plot.view.show(at - share * span, at - share * span + span);
  }

  _up(event) {
    const finger = this.fingers.get(event.pointerId);
    if (!finger) return;
    if (!this.start.moved) this.clicked(event);
    if (this.band) {
      const ends = [this.start.x, finger.x].map((x) => this.plot.seconds(x));
      this.plot.view.show(Math.min(...ends), Math.max(...ends));
    }
    this._forget(event);
  }

  _forget(event) {
    this.fingers.delete(event.pointerId);
    this.band?.remove();
    this.band = null;
  }

  _x(event) {
    return event.clientX - this.plot.root.getBoundingClientRect().left;
  }
}

// What each key does to a timeline that has the focus.
function keyTable(view, timeline) {
  return {
    "+": () => view.zoom(0.5),
    "=": () => view.zoom(0.5), // the same key without Shift on many keyboards
    "-": () => view.zoom(2),
    0: () => view.showAll(),
    ArrowLeft: () => view.pan(-view.span / 5),
    ArrowRight: () => view.pan(view.span / 5),
    PageUp: () => view.pan(-view.span),
    PageDown: () => view.pan(view.span),
    Home: () => view.pan(-view.end),
    End: () => view.pan(view.end),
    n: () => timeline.step(1),
    p: () => timeline.step(-1),
    Escape: () => timeline.choose(null),
  };
}

function keysMove(holder, table) {
  holder.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target !== holder) return;
    const act = table[event.key];
    if (act) {
      act();
      event.preventDefault();
    }
  });
}
