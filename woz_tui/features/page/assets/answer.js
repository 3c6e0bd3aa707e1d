// Sends forms without leaving the page, and keeps what has not been sent yet.
"use strict";

document.documentElement.dataset.runs = "yes";

const sheet = document.querySelector(".sheet");
const form = document.querySelector("form");
const AGAIN_MS = 2000;

// From when on somebody could see it, by this page's own clock.
let shown = performance.now();
requestAnimationFrame(() => { shown = performance.now(); });

const kept = {
  get: (name) => { try { return sessionStorage.getItem(name); } catch { return null; } },
  set: (name, text) => { try { sessionStorage.setItem(name, text); } catch { /* not allowed here */ } },
  drop: (name) => { try { sessionStorage.removeItem(name); } catch { /* not allowed here */ } },
};

// Goes to the page that is right now, once the network is there: else the browser's own page of
// errors would stand here, which looks for nothing.
async function goOn(leave) {
  try {
    await fetch("/page.css", { method: "HEAD", cache: "no-store" });
  } catch {
    setTimeout(goOn, AGAIN_MS, leave);
    return;
  }
  leave();
}
const anew = () => location.reload();
const onward = () => location.replace("/answer");

function place() {
  const item = form && form.elements.namedItem("item");
  return item ? `${sheet.dataset.round} ${item.value}` : "";
}

function keepDraft() {
  const told = [...new FormData(form)].filter(([name]) => /^(value|text|choice-?\d+)$/.test(name));
  kept.set(place(), JSON.stringify(Object.fromEntries(told)));
}

function useDraft() {
  const draft = JSON.parse(kept.get(place()) || "{}");
  if (!Object.keys(draft).length) return;
  for (const field of form.querySelectorAll("input:not([type=hidden]), textarea")) {
    if (field.type === "checkbox") field.checked = field.name in draft;
    else if (!(field.name in draft)) continue;
    else if (field.type === "radio") field.checked = field.value === draft.value;
    else field.value = draft[field.name];
  }
}

function complain(text) {
  document.getElementById("complaint").textContent = text;
}

async function send(fields) {
  try {
    // A redirection says that it was taken; where to, the browser does not tell.
    const answer = await fetch(form.action, { method: "POST", body: fields, redirect: "manual" });
    if (answer.type === "opaqueredirect") {
      kept.drop(place());
      goOn(onward);
      return;
    }
    if (answer.status !== 503) {
      goOn(anew);
      return;
    }
  } catch { /* the line is away */ }
  complain(sheet.dataset.unsent);
  setTimeout(send, AGAIN_MS, fields);
}

function submit(event) {
  event.preventDefault();
  if (form.dataset.sent) return;  // a double tap
  form.dataset.sent = "yes";
  const fields = new URLSearchParams(new FormData(form));
  fields.set("what", event.submitter ? event.submitter.value : "answer");
  const before = form.elements.namedItem("before");
  if (before) fields.set("took", String(Math.round(Number(before.value) + performance.now() - shown)));
  for (const button of form.querySelectorAll("button")) button.disabled = true;
  send(fields);
}

if (form) {
  if (place()) {
    useDraft();
    form.addEventListener("input", keepDraft);
  }
  form.addEventListener("submit", submit);
}

const source = new EventSource("/answer/news");
source.onerror = () => {
  // Not let in any more, such as after a new code: the page says it. A form that is being sent stays.
  if (source.readyState === EventSource.CLOSED && !(form && form.dataset.sent)) {
    setTimeout(goOn, AGAIN_MS, anew);
  }
};
source.onmessage = (message) => {
  const news = JSON.parse(message.data);
  // A form stays while the session is away: it is sent when the session is back.
  const stays = news.round === "lost" && form;
  if (news.round && news.round !== sheet.dataset.round && !stays) goOn(onward);
  // Answered on another tablet. Who changes an answer of before stays there.
  const elsewhere = "open" in news && news.open !== sheet.dataset.open;
  if (elsewhere && place() && !form.dataset.sent && !location.search) goOn(onward);
  if ("notice" in news) {
    const notice = document.getElementById("notice");
    notice.textContent = news.notice;
    notice.hidden = !news.notice;
  }
};
