// What the page's data become: lanes, whose items never overlap within one row.

// The order in the data's arrays; page data are short because there may be a hundred sessions.
function _item(row, number, lane) {
  const [begin, end, label, sort, facts] = row;
  return {
    number,
    lane,
    begin,
    end: end ?? begin,
    instant: end === null,
    label,
    sort,
    facts,
    words: `${label} ${sort} ${facts.map((fact) => fact[1]).join(" ")}`.toLowerCase(),
  };
}

// Whether a row has room for `item` after `last`; of two moments at the same time each has its own.
function _after(last, item) {
  return last.end < item.begin || (last.end === item.begin && !item.instant);
}

// Puts each item into the first row in which the one before it has ended.
function _rows(items) {
  const rows = [];
  for (const item of items) {
    let row = rows.find((other) => _after(other[other.length - 1], item));
    if (!row) rows.push((row = []));
    row.push(item);
  }
  return rows;
}

function readLanes(data) {
  const items = [];
  const lanes = data.lanes.map((given, index) => {
    const lane = { index, title: given.title, group: given.group, shown: true };
    if (given.points) {
      return { ...lane, points: given.points, unit: given.unit, low: given.low, high: given.high };
    }
    const own = given.items.map((row, at) => _item(row, items.length + at, lane));
    items.push(...own);
    return Object.assign(lane, { items: own, rows: _rows(own) });
  });
  return { lanes, items };
}

// Items of a row that touch from..to. Their ends are in order too, because none overlap.
function inSight(row, from, to) {
  const first = _first(row, (item) => item.end >= from);
  let last = first;
  while (last < row.length && row[last].begin <= to) last += 1;
  return row.slice(first, last);
}

// Points of a curve from the one before `from` to the one after `to`.
function pointsInSight(points, from, to) {
  const first = _first(points, (point) => point[0] >= from);
  const last = _first(points, (point) => point[0] > to);
  return points.slice(Math.max(first - 1, 0), last + 1);
}

// Index of the first for which `holds`, in a list in which it holds from there on.
function _first(list, holds) {
  let [low, high] = [0, list.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (holds(list[middle])) high = middle;
    else low = middle + 1;
  }
  return low;
}

// The value that a curve holds at `at`: that of the last point before it.
function valueAt(points, at) {
  const next = _first(points, (point) => point[0] > at);
  return next ? points[next - 1][1] : null;
}
