// Making elements. Text from a log only ever becomes a text node or an attribute's value, never
// markup: there is no innerHTML anywhere in these files.

const SVG = "http://www.w3.org/2000/svg";

function _fill(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== null && value !== undefined && value !== false) node.setAttribute(name, value);
  }
  node.append(...children);
  return node;
}

function el(tag, attributes = {}, ...children) {
  return _fill(document.createElement(tag), attributes, children);
}

function svg(tag, attributes = {}, ...children) {
  return _fill(document.createElementNS(SVG, tag), attributes, children);
}

// Text out of a log, kept apart from its surroundings: a right-to-left mark in a note must not
// turn the words beside it around.
function said(text) {
  return el("bdi", { dir: "auto" }, text);
}

// At most one call per picture, however many events ask for one.
function oncePerFrame(draw) {
  let waiting = 0;
  return () => {
    waiting ||= requestAnimationFrame(() => {
      waiting = 0;
      draw();
    });
  };
}

// One call, when nothing has asked for it any more for `ms` milliseconds.
function afterwards(ms, act) {
  let timer = 0;
  return () => {
    clearTimeout(timer);
    timer = setTimeout(act, ms);
  };
}

const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
