// Brings the page to life: timelines when their session is opened, the address, sorting.

const TITLES = JSON.parse(document.getElementById("sorts").textContent);
const sections = [...document.querySelectorAll("section.session")];
const alone = sections.length === 1;
const timelines = new Map();

// A session is drawn when it is opened for the first time: a page may hold a hundred of them.
function timelineOf(section) {
  let timeline = timelines.get(section.id);
  if (!timeline) {
    const session = alone ? "" : section.id;
    const data = JSON.parse(document.getElementById(`${section.id}-data`).textContent);
    const figure = section.querySelector("figure.timeline");
    const table = section.querySelector("table.events");
    const address = (from, to, number) => writeAddress({ session, from, to, number });
    const remember = afterwards(200, () => {
      const { view, plot } = timeline;
      history.replaceState(null, "", address(view.from, view.to, plot.chosen?.number));
    });
    timeline = new Timeline(figure, table, data, { titles: TITLES, address, moved: remember });
    timelines.set(section.id, timeline);
  }
  return timeline;
}

function goTo(hash) {
  const { session, from, to, number } = readAddress(hash);
  // Other addresses, such as those of the definitions, are the browser's own business.
  const ours = session || from !== null || number !== null;
  const section = document.getElementById(session) ?? (ours && alone ? sections[0] : null);
  if (!section) return;
  section.querySelector("details").open = true;
  const timeline = timelineOf(section);
  if (from !== null && to > from) timeline.view.show(from, to);
  if (number !== null) timeline.chooseNumber(number);
  const target = from === null ? section : section.querySelector("figure.timeline");
  if (!_inSight(target)) target.scrollIntoView();
}

function _inSight(node) {
  const { top, bottom } = node.getBoundingClientRect();
  return top >= 0 && bottom <= innerHeight;
}

for (const section of sections) {
  const details = section.querySelector("details");
  details.addEventListener("toggle", () => details.open && timelineOf(section));
  if (details.open) timelineOf(section);
}
for (const table of document.querySelectorAll("table.sortable")) sortable(table);
// Not `location.hash`: what is remembered of the view before may stand there again meanwhile.
addEventListener("hashchange", (event) => goTo(new URL(event.newURL).hash));
goTo(location.hash);
document.documentElement.dataset.ready = "yes";
