// The line above a timeline: zoom, search, and what is shown of it.

function _button(label, title, act, attributes = {}) {
  const button = el("button", { type: "button", title, "aria-label": title, ...attributes }, label);
  button.addEventListener("click", act);
  return button;
}

function zoomButtons(view) {
  const group = el("div", { class: "group", role: "group", "aria-label": "Zoom and move" });
  group.append(
    _button("−", "Zoom out", () => view.zoom(2)),
    _button("+", "Zoom in", () => view.zoom(0.5)),
    _button("◀", "Earlier", () => view.pan(-view.span / 2)),
    _button("▶", "Later", () => view.pan(view.span / 2)),
    _button("Whole session", "Show the whole session", () => view.showAll()),
  );
  return group;
}

// A check box for each lane, folded away: there may be many.
function laneMenu(lanes, changed) {
  const boxes = lanes.map((lane) => {
    const box = el("input", { type: "checkbox", checked: "" });
    box.addEventListener("change", () => {
      lane.shown = box.checked;
      changed();
    });
    return el("label", {}, box, said(lane.title));
  });
  const menu = el("details", { class: "menu" }, el("summary", {}, "Lanes"));
  menu.append(el("div", { class: "choices", role: "group", "aria-label": "Lanes shown" }, ...boxes));
  menu.addEventListener("keydown", (event) => {
    if (event.key === "Escape") {
      menu.open = false;
      menu.firstElementChild.focus();
    }
  });
  // A press on a label takes the focus away for a moment, to nowhere: that is no leaving.
  menu.addEventListener("focusout", (event) => {
    if (event.relatedTarget && !menu.contains(event.relatedTarget)) menu.open = false;
  });
  document.addEventListener("pointerdown", (event) => {
    if (!menu.contains(event.target)) menu.open = false;
  });
  return menu;
}

// The legend: what each colour and symbol means, and a switch for each.
function legend(items, titles, hidden, changed) {
  const counts = new Map();
  for (const item of items) counts.set(item.sort, (counts.get(item.sort) ?? 0) + 1);
  const chips = Object.keys(titles)
    .filter((sort) => counts.has(sort))
    .map((sort) => {
      const title = `Show or hide: ${titles[sort]}`;
      const chip = el("button", { type: "button", class: "chip", title, "aria-pressed": "true" });
      chip.dataset.sort = sort;
      chip.append(symbolBox(sort), `${titles[sort]} `, el("small", {}, String(counts.get(sort))));
      chip.addEventListener("click", () => {
        const off = !hidden.delete(sort);
        if (off) hidden.add(sort);
        chip.setAttribute("aria-pressed", String(!off));
        changed();
      });
      return chip;
    });
  return el("div", { class: "legend", role: "group", "aria-label": "Legend and filter" }, ...chips);
}

// A field that tells `searched` what is looked for, and `next` when Enter asks for the next find.
function searchField(searched, next) {
  const field = el("input", { type: "search", placeholder: "Search", "aria-label": "Search events" });
  const count = el("output", { class: "count" });
  field.addEventListener("input", () => {
    count.textContent = searched(field.value.trim().toLowerCase());
  });
  field.addEventListener("keydown", (event) => {
    if (event.key === "Enter") next(event.shiftKey ? -1 : 1);
  });
  return el("div", { class: "group search", role: "search" }, field, count);
}
