// How one item looks: a bar for what lasts, a symbol for a moment. Colour says how it ended, and so
// does the symbol, for those who see colours differently and for black and white print.

const SYMBOL = 11;
const LETTER = 6.7;

// Sorts that have a symbol. The others need none: it would only repeat what the lane says.
const MARKED = new Set([...document.querySelectorAll("symbol")].map((one) => one.id.slice(2)));

function symbol(sort, x, y, where = "") {
  const half = SYMBOL / 2;
  const place = { x: x - half, y: y - half, width: SYMBOL, height: SYMBOL };
  return svg("use", { href: `#g-${sort}`, class: `glyph s-${sort} ${where}`, ...place });
}

function _label(text, x, y, room, sort) {
  const letters = Math.floor(room / LETTER);
  if (letters < 2) return [];
  const shown = text.length > letters ? `${text.slice(0, letters - 1)}…` : text;
  return [svg("text", { x, y, class: `on s-${sort}` }, shown)];
}

function _bar(item, x0, x1, y, height) {
  const width = Math.max(x1 - x0, 1.5);
  const middle = y + height / 2;
  const parts = [
    svg("rect", { x: x0, y, width, height, rx: Math.min(2, width / 3), class: `bar s-${item.sort}` }),
  ];
  const marked = MARKED.has(item.sort);
  const inside = marked && width > SYMBOL + 2;
  if (inside) parts.push(symbol(item.sort, x1 - SYMBOL / 2 - 1, middle, "within"));
  if (marked && !inside) parts.push(symbol(item.sort, x1 + SYMBOL / 2 + 1, middle));
  const room = width - 8 - (inside ? SYMBOL : 0);
  return parts.concat(_label(item.label, x0 + 4, middle, room, item.sort));
}

function _moment(item, x, y, height) {
  return [
    // The pointer finds a thin thing only if more than its ink counts.
    svg("rect", { x: x - 7, y, width: 14, height, class: "catch" }),
    symbol(item.sort, x, y + height / 2),
  ];
}

// The item between x0 and x1 pixels; the part that is out of sight on the left is cut off, so that
// the label of a long bar stays readable.
function drawItem(item, x0, x1, left, right, y, height) {
  const parts = item.instant
    ? _moment(item, x0, y, height)
    : _bar(item, Math.max(x0, left - 3), Math.min(x1, right + 3), y, height);
  return svg("g", { class: "item", "data-number": item.number }, ...parts);
}

// A line through the values, with gaps where nothing was measured. A line of no length at each
// beginning makes a value that stands alone a dot.
function curvePath(points, x, y) {
  let path = "";
  let drawing = false;
  for (const [at, value] of points) {
    if (value === null) {
      drawing = false;
    } else {
      const place = `${x(at).toFixed(1)} ${y(value).toFixed(1)}`;
      path += drawing ? `L${place}` : `M${place}h0`;
      drawing = true;
    }
  }
  return path;
}
