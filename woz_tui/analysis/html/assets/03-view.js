// The part of the session that is seen: from..to, in seconds. Everything that draws listens.

const SHORTEST = 0.02;

class View {
  constructor(end) {
    this.end = Math.max(end, SHORTEST);
    this.from = 0;
    this.to = this.end;
    this.listeners = [];
  }

  get span() {
    return this.to - this.from;
  }

  get whole() {
    return this.span >= this.end;
  }

  show(from, to) {
    const span = clamp(to - from, SHORTEST, this.end);
    this.from = clamp(from, 0, this.end - span);
    this.to = this.from + span;
    for (const told of this.listeners) told();
  }

  // `factor` below 1 shows less; what is at `at` seconds stays where it is.
  zoom(factor, at = (this.from + this.to) / 2) {
    const span = clamp(this.span * factor, SHORTEST, this.end);
    const share = (at - this.from) / this.span;
    this.show(at - share * span, at - share * span + span);
  }

  pan(seconds) {
    this.show(this.from + seconds, this.to + seconds);
  }

  showAll() {
    this.show(0, this.end);
  }

  // Brings begin..end into sight; the scale changes only where it has to.
  reveal(begin, end) {
    const span = Math.max(this.span, (end - begin) * 1.2);
    if (begin < this.from || end > this.to) {
      const middle = (begin + end) / 2;
      this.show(middle - span / 2, middle + span / 2);
    }
  }
}
