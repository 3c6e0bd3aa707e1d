// Keeps the watch page new: texts go into the places that are named after them, as text only.
"use strict";

document.documentElement.dataset.runs = "yes";

const place = (name) => document.getElementById(name);

function made(name, className, text) {
  const element = document.createElement(name);
  if (className) element.className = className;
  if (text !== undefined) element.textContent = text;
  return element;
}

function event(told) {
  const row = made("li", told.look);
  const sign = made("span", "sign", told.sign);
  sign.setAttribute("aria-hidden", "true");
  const sentence = made("p");
  for (const [text, look] of told.pieces) {
    const apart = made("bdi", "", text);
    apart.dir = "auto";
    const piece = made("span", look);
    piece.append(apart);
    sentence.append(piece);
  }
  row.append(made("time", "", told.when), sign, made("span", "unseen", told.kind), sentence);
  return row;
}

function meter(told) {
  const row = made("li", told.old ? "old" : "");
  const middle = made("span");
  if (told.share !== null) {
    const bar = made("meter");
    bar.value = told.share;
    bar.setAttribute("aria-hidden", "true");
    middle.append(bar);
  }
  row.append(made("span", "name", told.name), middle, made("span", "value", told.text));
  return row;
}

// Only rows that are different are replaced: what somebody reads stays where it is.
function fill(list, rows, make) {
  rows.forEach((told, index) => {
    const text = JSON.stringify(told);
    const old = list.children[index];
    if (old && old.dataset.told === text) return;
    const row = make(told);
    row.dataset.told = text;
    if (old) old.replaceWith(row);
    else list.append(row);
  });
  while (list.children.length > rows.length) list.lastElementChild.remove();
}

const lists = { events: event, meters: meter };

function show(news) {
  for (const [name, told] of Object.entries(news)) {
    const element = place(name);
    if (!element) continue;
    if (name === "debrief") {
      element.hidden = !told;
    } else if (name in lists) {
      fill(element, told, lists[name]);
    } else {
      element.textContent = told;
      element.hidden = !told;
    }
    if (name === "title") document.title = told;
  }
}

// Cameras' pictures, while somebody sees them; one that has not come yet is not asked for again.
const PICTURE_MS = 2000;
for (const picture of document.querySelectorAll("img")) {
  const address = picture.getAttribute("src");
  setInterval(() => {
    if (document.visibilityState === "visible" && picture.complete) {
      picture.src = `${address}?${Date.now()}`;
    }
  }, PICTURE_MS);
}

const source = new EventSource("/watch/news");
source.onmessage = (message) => {
  const news = JSON.parse(message.data);
  show(news);
  document.body.dataset.fresh = "yes";
  if (news.over || news.debrief) source.close();
};
source.onerror = () => {
  document.body.dataset.fresh = "no";
  if (source.readyState === EventSource.CLOSED) {
    show({ lost: "This page gets no news any more: load it again, or ask for a new code." });
  } else {
    show({ lost: "The line to the robot's computer is lost; it is looked for." });
  }
};
