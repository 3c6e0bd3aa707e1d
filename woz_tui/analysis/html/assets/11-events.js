// The list of all events under a timeline. Its rows come with the page, unless there are too many
// sessions in it; then they are made here.

function _row(item, titles, address) {
  const span = Math.max(item.end - item.begin, 2);
  const link = el("a", { href: address(item.begin - span, item.end + span, item.number) });
  link.append(clockTime(item.begin));
  const facts = item.facts.map(([name, value]) => el("span", {}, `${name}: `, said(value)));
  const row = el("tr", { "data-number": item.number });
  row.append(el("td", { class: "number" }, link));
  row.append(el("td", { class: "lane-name" }, said(item.lane.title)));
  row.append(el("td", {}, symbolBox(item.sort), said(item.label)));
  row.append(el("td", { class: "lane-name" }, titles[item.sort] ?? item.sort));
  row.append(el("td", { class: "number" }, item.instant ? "" : duration(item.end - item.begin)));
  row.append(el("td", { class: "facts" }, ...facts));
  return row;
}

class EventList {
  constructor(table, items, titles, address) {
    this.body = table.tBodies[0];
    if (this.body.rows.length < items.length) {
      const inTime = [...items].sort((a, b) => a.begin - b.begin || a.number - b.number);
      this.body.replaceChildren(...inTime.map((item) => _row(item, titles, address)));
    }
    this.rows = new Map([...this.body.rows].map((row) => [Number(row.dataset.number), row]));
    this.body.addEventListener("click", (event) => {
      if (!event.target.closest("a")) event.target.closest("tr")?.querySelector("a")?.click();
    });
    this.body.classList.add("live");
  }

  filter(items, shown) {
    for (const item of items) {
      const row = this.rows.get(item.number);
      if (row) row.hidden = !shown(item);
    }
  }

  choose(item) {
    this.body.querySelector("[aria-current]")?.removeAttribute("aria-current");
    const row = item && this.rows.get(item.number);
    if (!row) return;
    row.setAttribute("aria-current", "true");
    // Within the list only: the page itself stays where it is.
    const list = row.closest(".scroll");
    const off = row.getBoundingClientRect().top - list.getBoundingClientRect().top;
    if (off < 30 || off > list.clientHeight - 30) list.scrollTop += off - list.clientHeight / 2;
  }
}
