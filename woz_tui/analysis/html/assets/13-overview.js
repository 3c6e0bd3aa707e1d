// Tables that can be sorted by a press on a column's head.

// Numbers by size, everything else by the alphabet; cells without a value always come last.
function _order(a, b, way) {
  if (a === "" || b === "") return (a === "") - (b === "");
  const [x, y] = [Number(a), Number(b)];
  const numbers = !Number.isNaN(x) && !Number.isNaN(y);
  return way * (numbers ? x - y : a.localeCompare(b, undefined, { numeric: true }));
}

// What a cell counts for: `data-value` where its text is for people ("1.2 s").
function _value(row, column) {
  const cell = row.cells[column];
  return (cell.dataset.value ?? cell.textContent).trim();
}

function sortable(table) {
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => {
    const button = el("button", { type: "button", class: "sort" }, ...head.childNodes);
    head.replaceChildren(button);
    button.addEventListener("click", () => {
      const way = head.getAttribute("aria-sort") === "ascending" ? -1 : 1;
      const body = table.tBodies[0];
      const rows = [...body.rows];
      rows.sort((a, b) => _order(_value(a, column), _value(b, column), way));
      body.append(...rows);
      for (const other of heads) other.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", way === 1 ? "ascending" : "descending");
    });
  });
}
