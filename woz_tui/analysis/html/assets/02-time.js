// Seconds since the session began, as people read them.

// Distances between ticks of a ruler, in seconds.
const STEPS = [
  0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600,
  900, 1800, 3600, 7200, 14400, 43200, 86400,
];

// The smallest step at which labels of a ruler with `perSecond` pixels are `room` pixels apart;
// whole days where a damaged time makes a session last for years.
function tickStep(perSecond, room) {
  const day = STEPS[STEPS.length - 1];
  return (
    STEPS.find((step) => step * perSecond >= room) ?? day * Math.ceil(room / (perSecond * day))
  );
}

function ticks(from, to, step) {
  const found = [];
  for (let n = Math.ceil(from / step); n * step <= to; n += 1) found.push(n * step);
  return found;
}

const _decimals = (step) => (step >= 1 ? 0 : step >= 0.1 ? 1 : step >= 0.01 ? 2 : 3);
const _two = (number) => String(number).padStart(2, "0");

// "12.50 s" under a minute, "3:07" and "1:03:07" above; as many decimals as `step` needs.
function clockTime(seconds, step = 0.001) {
  const decimals = _decimals(step);
  const scale = 10 ** decimals;
  // Rounded before it is split, so that 59.9996 s does not become "0:60".
  const rounded = Math.round(seconds * scale) / scale;
  const whole = Math.floor(rounded);
  const rest = decimals ? (rounded - whole).toFixed(decimals).slice(1) : "";
  const [hours, minutes] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60];
  const tail = `${_two(whole % 60)}${rest}`;
  return hours ? `${hours}:${_two(minutes)}:${tail}` : `${minutes}:${tail}`;
}

// "180 ms", "12.34 s", "3:07 min", "1:03:07 h".
function duration(seconds) {
  if (seconds < 1) return `${Math.round(seconds * 1000)} ms`;
  if (seconds < 100) return `${seconds.toFixed(2)} s`;
  return `${clockTime(seconds, 1)} ${seconds < 3599.5 ? "min" : "h"}`;
}

// The calendar's time at `seconds`, UTC; empty if the log does not tell when it began.
function wallTime(zero, seconds) {
  const start = Date.parse(zero);
  return Number.isNaN(start) ? "" : new Date(start + seconds * 1000).toISOString().slice(11, 23);
}
