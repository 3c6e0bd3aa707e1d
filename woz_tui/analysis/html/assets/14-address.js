// The part of the address after `#`: which session, which part of it, which event. So a link in a
// mail opens the page where its writer looked: `#t=12.3-45`, `#session-7&t=12.3-45&n=17`.

function readAddress(hash) {
  const found = { session: "", from: null, to: null, number: null };
  for (const part of hash.replace(/^#/, "").split("&")) {
    const span = /^t=(\d+(?:\.\d+)?)-(\d+(?:\.\d+)?)$/.exec(part);
    const number = /^n=(\d+)$/.exec(part);
    if (span) [found.from, found.to] = [Number(span[1]), Number(span[2])];
    else if (number) found.number = Number(number[1]);
    else if (/^session-\d+$/.test(part)) found.session = part;
  }
  return found;
}

function writeAddress({ session, from, to, number }) {
  const place = (seconds) => String(Number(Math.max(seconds, 0).toFixed(3)));
  const parts = [`t=${place(from)}-${place(to)}`];
  if (session) parts.unshift(session);
  if (number !== null && number !== undefined) parts.push(`n=${number}`);
  return `#${parts.join("&")}`;
}
