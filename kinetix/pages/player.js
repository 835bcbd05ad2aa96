"use strict";
// Plays what #data holds: fixed geometry, and for each film poses over time.
(() => {
const { scene, films: stored } = JSON.parse(document.getElementById("data").textContent);
const SIZE = 5, CHANNELS = 6, UNKNOWN = -32768;
const KEYS = [["←", "→"], ["↑", "↓"], ["W", "S"], ["A", "D"], ["1", ""], ["2", ""]];
const byId = (id) => document.getElementById(id);

function numbers(text, kind) {
  if (text === null) return null;
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new kind(bytes.buffer);
}

const films = stored.map((film) => ({
  ...film,
  seconds: Array.from(numbers(film.seconds, Uint32Array), (ms) => ms / 1000),
  column: new Map(film.moving.map((body, k) => [body, k])),
  shown: numbers(film.shown, Uint32Array),
  places: numbers(film.places, Int16Array),
  angles: numbers(film.angles, Int32Array),
  actions: numbers(film.actions, Int8Array),
  value: numbers(film.value, Int16Array),
  entropy: numbers(film.entropy, Int16Array),
}));
for (const film of films) film.times = Array.from(film.shown, (row) => film.seconds[row]);
const end = Math.max(...films.map((film) => film.seconds[film.count - 1]));
const state = { time: 0, playing: false, speed: 1, before: 0 };

// ---- geometry -------------------------------------------------------------------------------
// What is on show: the arena and all that starts outside it; without one, all that ever moves.
function view() {
  const arena = scene.arena.length > 0;
  const low = arena ? [0, 0] : [Infinity, Infinity], high = arena ? [SIZE, SIZE] : [-Infinity, -Infinity];
  const show = (at, reach) => {
    if (arena && at.every((x) => x + reach > 0 && x - reach < SIZE)) return;
    for (const axis of [0, 1]) {
      low[axis] = Math.min(low[axis], at[axis] - reach);
      high[axis] = Math.max(high[axis], at[axis] + reach);
    }
  };
  for (const film of films) {
    film.start.forEach(([x, y], k) => show([x / 1000, y / 1000], reachOf(scene.bodies[k])));
    if (arena) continue;
    for (let k = 0; k < film.places.length; k += 2)
      show([film.places[k] / 1000, film.places[k + 1] / 1000],
           reachOf(scene.bodies[film.moving[k / 2 % film.moving.length]]));
  }
  const side = Math.max(high[0] - low[0], high[1] - low[1], 0.5);
  return { low: [(low[0] + high[0] - side) / 2, (low[1] + high[1] - side) / 2], side };
}
const reachOf = (shape) => shape.radius ?? Math.max(...shape.corners.map((at) => Math.hypot(...at)));
const window_ = view();

// The moment at a time: two rows and how far it is from the first to the second.
function between(times, time) {
  let low = 0, high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle; else high = middle;
  }
  const span = times[high] - times[low];
  const share = span > 0 ? Math.min(Math.max((time - times[low]) / span, 0), 1) : 0;
  return { low, high, share, row: share >= 0.999 ? high : low };
}
const moment = (film, time) => between(film.seconds, time);

// The pose of a body; `at` is a moment of those that have poses.
function pose(film, at, body) {
  const column = film.column.get(body), width = film.moving.length;
  const turns = (angle) => angle * 2 * Math.PI / 65536;
  if (column === undefined) {
    const [x, y, angle] = film.start[body];
    return [x / 1000, y / 1000, turns(angle)];
  }
  const a = at.low * width + column, b = at.high * width + column;
  const mix = (of, k, l) => of[k] + (of[l] - of[k]) * at.share;
  const along = (axis) => mix(film.places, 2 * a + axis, 2 * b + axis) / 1000;
  return [along(0), along(1), turns(mix(film.angles, a, b))];
}

function placed([x, y, angle], [px, py]) {
  const c = Math.cos(angle), s = Math.sin(angle);
  return [x + c * px - s * py, y + s * px + c * py];
}

// ---- drawing --------------------------------------------------------------------------------
function outline(g, shape, at) {
  g.beginPath();
  if (shape.radius !== undefined) {
    g.arc(at[0], at[1], shape.radius, 0, 2 * Math.PI);
  } else {
    shape.corners.forEach((corner, k) => g[k ? "lineTo" : "moveTo"](...placed(at, corner)));
    g.closePath();
  }
  g.fillStyle = shape.fill;
  g.fill();
  g.stroke();
  if (shape.radius !== undefined) {  // a spoke, so that one sees it turn
    g.beginPath();
    g.moveTo(at[0], at[1]);
    g.lineTo(...placed(at, [0, shape.radius]));
    g.stroke();
  }
}

function draw(film) {
  const canvas = film.canvas, g = canvas.getContext("2d");
  const dots = Math.round(canvas.clientWidth * (window.devicePixelRatio || 1));
  if (canvas.width !== dots) canvas.width = canvas.height = dots;
  const scale = dots / window_.side;
  g.setTransform(1, 0, 0, 1, 0, 0);
  g.fillStyle = "#fff";
  g.fillRect(0, 0, dots, dots);
  g.setTransform(scale, 0, 0, -scale, -window_.low[0] * scale, dots + window_.low[1] * scale);
  g.lineWidth = 1.4 / scale * (window.devicePixelRatio || 1);
  g.lineJoin = "round";
  g.strokeStyle = "#000";
  const at = moment(film, state.time), kept = between(film.times, state.time);
  const poses = scene.bodies.map((_, k) => pose(film, kept, k));
  scene.arena.forEach((shape) => outline(g, shape, shape.at));
  scene.thrusters.forEach((thruster) => flame(g, film, at, poses, thruster));
  for (const circles of [false, true]) {
    scene.bodies.forEach((shape, k) => {
      if ((shape.radius !== undefined) === circles) outline(g, shape, poses[k]);
    });
  }
  scene.joints.forEach((joint) => mark(g, film, at, poses, joint));
  if (byId("overlay").checked) numbersOf(film, at, dots);
  film.said.textContent = state.time >= film.seconds[film.count - 1] - 1e-6 ? ENDS[film.outcome] || "" : "";
}
const ENDS = { won: "Won", lost: "Lost", timeout: "Time is up", broken: "Physics broke down" };
const driven = (film, at, channel) =>
  film.actions && channel >= 0 ? film.actions[at.row * CHANNELS + channel] / 100 : 0;

function flame(g, film, at, poses, thruster) {
  const angle = poses[thruster.body][2] + thruster.angle;
  const foot = placed(poses[thruster.body], thruster.at);
  const power = driven(film, at, thruster.channel);
  const reach = 0.1 + 0.25 * power, wide = 0.05;
  const tip = [foot[0] - reach * Math.cos(angle), foot[1] - reach * Math.sin(angle)];
  const side = [-Math.sin(angle) * wide, Math.cos(angle) * wide];
  g.beginPath();
  g.moveTo(foot[0] + side[0], foot[1] + side[1]);
  g.lineTo(tip[0], tip[1]);
  g.lineTo(foot[0] - side[0], foot[1] - side[1]);
  g.closePath();
  g.fillStyle = power > 0.05 ? "#ff7a1a" : thruster.colour;
  g.fill();
  g.stroke();
}

function mark(g, film, at, poses, joint) {
  const body = joint.body < 0 ? [0, 0, 0] : poses[joint.body];
  const [x, y] = placed(body, joint.at), radius = 0.055;
  g.beginPath();
  if (joint.weld) g.rect(x - radius, y - radius, 2 * radius, 2 * radius);
  else g.arc(x, y, radius, 0, 2 * Math.PI);
  g.fillStyle = joint.colour;
  g.fill();
  g.stroke();
  const turn = driven(film, at, joint.channel) * joint.way;
  if (Math.abs(turn) < 0.05 || !byId("overlay").checked) return;
  const start = Math.PI / 2, span = Math.sign(turn) * 1.9, r = 0.13;
  g.save();
  g.strokeStyle = turn > 0 ? "#d6301f" : "#2166bf";
  g.lineWidth *= 2;
  g.beginPath();
  g.arc(x, y, r, start - span / 2, start + span / 2, span < 0);
  const tip = start + span / 2, along = tip + Math.sign(span) * Math.PI / 2;
  const [tx, ty] = [x + r * Math.cos(tip), y + r * Math.sin(tip)];
  for (const side of [2.6, -2.6]) {
    g.moveTo(tx, ty);
    g.lineTo(tx + 0.06 * Math.cos(along + side), ty + 0.06 * Math.sin(along + side));
  }
  g.stroke();
  g.restore();
}

// Words in the corner: the keys that are down, value and entropy.
function numbersOf(film, at, dots) {
  const g = film.canvas.getContext("2d"), words = [];
  const known = (curve) => curve && curve[at.row] !== UNKNOWN;
  if (known(film.value)) words.push(`value ${(film.value[at.row] / 1000).toFixed(2)}`);
  if (known(film.entropy)) words.push(`entropy ${(film.entropy[at.row] / 1000).toFixed(2)}`);
  for (const channel of scene.controls) {
    const now = driven(film, at, channel);
    if (Math.abs(now) > 0.05) {
      const name = scene.names[channel];
      words.push(KEYS[channel][now < 0 ? 1 : 0] + (name ? ` ${name}` : ""));
    }
  }
  if (!words.length) return;
  g.setTransform(1, 0, 0, 1, 0, 0);
  const size = Math.max(12, dots / 36), text = words.join("   ");
  g.font = `${size}px system-ui, sans-serif`;
  const wide = g.measureText(text).width;
  g.fillStyle = "rgba(0,0,0,.62)";
  g.fillRect(size * 0.6, size * 0.6, wide + size, size * 1.7);
  g.fillStyle = "#fff";
  g.fillText(text, size * 1.1, size * 1.75);
}

// The values of all films over time, with the present moment.
function curves() {
  const canvas = byId("curves"), known = films.filter((film) => film.value);
  canvas.hidden = !known.length || !byId("overlay").checked;
  if (canvas.hidden) return;
  const ratio = window.devicePixelRatio || 1, g = canvas.getContext("2d");
  canvas.width = canvas.clientWidth * ratio;
  canvas.height = canvas.clientHeight * ratio;
  const [w, h] = [canvas.width, canvas.height];
  const all = known.flatMap((film) => Array.from(film.value).filter((v) => v !== UNKNOWN));
  const low = Math.min(0, ...all), high = Math.max(0, ...all), span = Math.max(high - low, 1);
  const y = (v) => h - 6 * ratio - (v - low) / span * (h - 22 * ratio);
  g.strokeStyle = "#d5d9df";
  g.beginPath(); g.moveTo(0, y(0)); g.lineTo(w, y(0)); g.stroke();
  known.forEach((film) => {
    g.strokeStyle = films.indexOf(film) ? "#c2571a" : "#1f66cc";
    g.lineWidth = 1.6 * ratio;
    g.beginPath();
    let pen = false;
    film.value.forEach((v, k) => {
      if (v === UNKNOWN) { pen = false; return; }
      g[pen ? "lineTo" : "moveTo"](film.seconds[k] / end * w, y(v));
      pen = true;
    });
    g.stroke();
  });
  g.strokeStyle = "#20242c";
  g.lineWidth = ratio;
  g.beginPath(); g.moveTo(state.time / end * w, 0); g.lineTo(state.time / end * w, h); g.stroke();
  g.fillStyle = "#5b6270";
  g.font = `${11 * ratio}px system-ui, sans-serif`;
  g.fillText("value", 6 * ratio, 13 * ratio);
}

// ---- the clock and the controls -------------------------------------------------------------
function show() {
  films.forEach(draw);
  curves();
  byId("scrub").value = end > 0 ? state.time / end * 1000 : 0;
  const at = moment(films[0], state.time);
  byId("time").textContent = `${state.time.toFixed(2)} s of ${end.toFixed(2)} s`;
  byId("play").textContent = state.playing ? "Pause" : "Play";
  document.body.dataset.row = at.row;
  document.body.dataset.time = state.time.toFixed(3);
}

function tick(now) {
  if (!state.playing) return;
  state.time += (now - state.before) / 1000 * state.speed;
  state.before = now;
  if (state.time >= end) {
    if (byId("loop").checked) state.time = 0;
    else { state.time = end; state.playing = false; }
  }
  show();
  if (state.playing) requestAnimationFrame(tick);
}

function play(on) {
  state.playing = on;
  if (on) {
    if (state.time >= end) state.time = 0;
    state.before = performance.now();
    requestAnimationFrame(tick);
  }
  show();
}

function step(way) {
  state.playing = false;
  const film = films.reduce((a, b) => (b.count > a.count ? b : a));
  const row = Math.min(Math.max(moment(film, state.time).row + way, 0), film.count - 1);
  state.time = film.seconds[row];
  show();
}

films.forEach((film) => {
  const figure = document.createElement("figure"), caption = document.createElement("figcaption");
  const name = document.createElement("span");
  film.canvas = document.createElement("canvas");
  film.said = document.createElement("strong");
  film.said.className = film.outcome;
  name.textContent = film.title;
  caption.append(name, film.said);
  figure.append(film.canvas, caption);
  byId("stage").append(figure);
  for (const [what, told] of film.facts) {
    const term = document.createElement("dt"), text = document.createElement("dd");
    term.textContent = films.length > 1 ? `${film.title}: ${what}` : what;
    text.textContent = told;
    byId("facts").append(term, text);
  }
});
byId("play").onclick = () => play(!state.playing);
byId("back").onclick = () => step(-1);
byId("step").onclick = () => step(1);
byId("scrub").oninput = (event) => {
  state.playing = false;
  state.time = event.target.value / 1000 * end;
  show();
};
byId("speed").onchange = (event) => { state.speed = Number(event.target.value); };
byId("overlay").onchange = show;
document.onkeydown = (event) => {
  if (["INPUT", "SELECT"].includes(event.target.tagName) && event.key !== " ") return;
  const does = { " ": () => play(!state.playing), ArrowLeft: () => step(-1), ArrowRight: () => step(1) };
  if (does[event.key]) { does[event.key](); event.preventDefault(); }
};
window.onresize = show;
show();
if (location.hash !== "#still") play(true);
})();
