// What is known of one item, beside it; and the same in words for a screen reader.

function _facts(item, zero, titles) {
  const when = wallTime(zero, item.begin);
  const rows = [["what", titles[item.sort] ?? item.sort]];
  rows.push(["at", `${clockTime(item.begin)}${when ? ` (${when} UTC)` : ""}`]);
  if (!item.instant) rows.push(["for", duration(item.end - item.begin)]);
  return rows.concat(item.facts);
}

class Tip {
  constructor(holder, zero, titles) {
    Object.assign(this, { holder, zero, titles });
    this.box = el("div", { class: "tip", role: "tooltip", hidden: "" });
    this.spoken = el("p", { class: "unseen", role: "status", "aria-live": "polite" });
    holder.append(this.box);
    holder.after(this.spoken);
  }

  // Shows `item` near `x`, `y` pixels of the holder.
  show(item, x, y) {
    const rows = _facts(item, this.zero, this.titles).flatMap(([name, value]) => [
      el("dt", {}, name),
      el("dd", {}, said(value)),
    ]);
    const head = el("p", { class: "head" }, symbolBox(item.sort), said(item.label || item.lane.title));
    this.box.replaceChildren(head, el("dl", {}, ...rows));
    this.box.hidden = false;
    const { clientWidth: wide, clientHeight: high } = this.holder;
    const [width, height] = [this.box.offsetWidth, this.box.offsetHeight];
    const left = x + 14 + width > wide ? x - width - 14 : x + 14;
    // Above the pointer if there is no room below, but never above the plot's own top.
    const top = y + 14 + height > high ? y - height - 10 : y + 14;
    this.box.style.left = `${clamp(left, 0, Math.max(wide - width, 0))}px`;
    this.box.style.top = `${Math.max(top, 0)}px`;
  }

  say(item) {
    const facts = _facts(item, this.zero, this.titles).map(([name, value]) => `${name} ${value}`);
    this.spoken.textContent = `${item.lane.title}: ${item.label}. ${facts.join(", ")}`;
  }

  hide() {
    this.box.hidden = true;
  }
}

function symbolBox(sort) {
  const box = svg("svg", { class: "swatch", viewBox: "-8 -7 16 14", "aria-hidden": "true" });
  const bar = { x: -7, y: -5, width: 14, height: 10, rx: 2, class: `bar s-${sort}` };
  box.append(MARKED.has(sort) ? symbol(sort, 0, 0) : svg("rect", bar));
  return box;
}
