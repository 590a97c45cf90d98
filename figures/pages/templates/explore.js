"use strict";
// Drawing and controls. What an impact does, the generated functions above say.

const ROD = 180; // its length in the picture
const IN = 0.3, OUT = 0.7; // moments at which the impact begins and ends
const SECONDS = 8;
const REDUCED = matchMedia("(prefers-reduced-motion: reduce)");
const $ = (id) => document.getElementById(id);
const names = Object.keys(PAGE.ranges), choices = Object.keys(PAGE.choices);
let setting = { ...PAGE.start }, moment = 0.5, playing = 0, shown;

// ---- from a setting to an impact ----------------------------------------------------------

const radians = (degrees) => (degrees * Math.PI) / 180;

/** The rod at a tilt: its contact geometry, and what is drawn of it. */
function rodOf({ shape, length }, tilt) {
  const geometry = shape === "thin" ? rodImpact.thin_rod(tilt, length)
    : shape === "round" ? rodImpact.spherocylinder(tilt, length, 1) : rodImpact.flat_ended_rod(tilt, length, 1);
  return { ...geometry, thick: shape === "thin" ? 0 : 1 / length, round: shape === "round" };
}

/** What the impact is given: a rod of a setting that comes with speed 1. */
function givenOf(s, rod) {
  const speed = Math.hypot(1, s.ratio);
  const velocities = { c_x: 1 / speed, c_z: -s.ratio / speed, omega: s.spin / rod.k, plate_velocity: 0 };
  return { ...velocities, geometry: rod, friction: s.friction, restitution: s.restitution };
}

const driftOf = (s, rod, friction = s.friction) => rodImpact.drift(rod, friction, s.restitution, 1);

/** The impact of a setting: its path, the states along it, the ends under all laws. */
function impactOf(s) {
  const rod = rodOf(s, radians(s.tilt_deg)), given = givenOf(s, rod), { X, Z, k } = rod;
  const path = rodImpact.path(given), { A, B, C } = rodImpact.mobilities(rod);
  const laws = Object.keys(PAGE.choices.law);
  const ends = Object.fromEntries(laws.map((law) => [law, rodImpact.collide(law, given)]));
  const hit = ends[s.law], stop = [path.P_x, path.P_z], end = [hit.P_x, hit.P_z];
  /** State under an impulse; the spin is that of a rigid body whose two points move like this. */
  const at = ([P_x, P_z]) => {
    const c_x = given.c_x + P_x, c_z = given.c_z + P_z;
    const u = path.slip_velocity + C * P_x - B * P_z, v = path.normal_velocity + A * P_z - B * P_x;
    const omega = (Z * (c_x - u) + X * (v - c_z)) / (X * X + Z * Z);
    return { c_x, c_z, omega, spin: k * omega, u, v };
  };
  const corners = hit.regime > 1 ? [[0, 0], stop, end] : [[0, 0], end];
  const after = { ...hit, spin: k * hit.omega, u: hit.slip_velocity, v: hit.normal_velocity };
  const speeds = corners.map((P) => at(P).v), found = speeds.findIndex((v) => v >= 0);
  const i = found > 0 ? found : corners.length - 1;
  const part = Math.min(speeds[i - 1] / (speeds[i - 1] - speeds[i]), 1) || 0;
  const deepest = corners[i - 1][1] + part * (corners[i][1] - corners[i - 1][1]);
  const inside = [0, corners[1][1], deepest, end[1]].map((P_z) => IN + ((OUT - IN) * P_z) / (end[1] || 1));
  const moments = [0, ...inside, 1].sort((a, b) => a - b);
  return { rod, at, ends, hit, corners, before: at([0, 0]), after, drift: driftOf(s, rod), moments };
}

/** Point of the path at which the impulse across the plate is P_z, and whether slip has stopped. */
function pointAt(corners, P_z) {
  let i = 1;
  while (i < corners.length - 1 && P_z > corners[i][1]) i += 1;
  const [a, b] = [corners[i - 1], corners[i]];
  const part = b[1] > a[1] ? Math.min((P_z - a[1]) / (b[1] - a[1]), 1) : 0;
  return { P: [0, 1].map((n) => a[n] + part * (b[n] - a[n])), piece: i, way: [b[0] - a[0], b[1] - a[1]] };
}

// ---- pieces of pictures -------------------------------------------------------------------

const tag = (name, look, inside = "") =>
  `<${name} ${Object.entries(look).map(([key, value]) => `${key}="${value}"`).join(" ")}>${inside}</${name}>`;
const px = (value) => (Number.isFinite(value) ? Math.max(-4000, Math.min(4000, value)).toFixed(1) : "0");
const line = (points, look) =>
  tag("path", { class: look, d: points.map(([x, y], i) => `${i ? "L" : "M"}${px(x)} ${px(y)}`).join("") });
const text = (x, y, words, anchor = "middle", more = {}) =>
  tag("text", { x: px(x), y: px(y), "text-anchor": anchor, ...more }, words);
const ring = (x, y, look = "here", r = 5.5) => tag("circle", { class: look, cx: px(x), cy: px(y), r });

function head(x, y, angle, look, size = 6) {
  const corner = (turn) => [x + size * Math.cos(angle + turn), y + size * Math.sin(angle + turn)];
  return line([corner(0), corner(2.4), corner(-2.4)], `head ${look}`);
}

function arrow(x, y, dx, dy, look, size) {
  if (Math.hypot(dx, dy) < 3) return "";
  return line([[x, y], [x + dx, y + dy]], `arrow ${look}`) + head(x + dx, y + dy, Math.atan2(dy, dx), look, size);
}

function turning(x, y, spin) {
  const end = Math.max(-5, Math.min(5, 2.2 * spin)), r = 17;
  if (Math.abs(end) < 0.15) return "";
  const points = Array.from({ length: 25 }, (_, i) => (end * i) / 24 - Math.PI / 2);
  const [tip] = points.slice(-1), place = (a) => [x + r * Math.cos(a), y + r * Math.sin(a)];
  return line(points.map(place), "arrow spin") + head(...place(tip), tip + (Math.sign(end) * Math.PI) / 2, "spin");
}

function ticks(low, high, most = 6) {
  const power = 10 ** Math.floor(Math.log10((high - low) / most));
  const step = power * [1, 2, 5, 10].find((n) => (high - low) / (n * power) <= most);
  const first = Math.ceil(low / step - 1e-9);
  const count = Math.floor(high / step + 1e-9) - first + 1;
  return Array.from({ length: count }, (_, i) => +((first + i) * step).toPrecision(9));
}

/** Axes: places of values, and the frame with ticks and words. */
function axes(id, [x0, x1], [y0, y1], xWords, yWords, xTicks = ticks(x0, x1), box = [60, 10, 390, 258]) {
  const [left, top, right, bottom] = box;
  const x = (value) => left + ((value - x0) / (x1 - x0)) * (right - left);
  const y = (value) => bottom - ((value - y0) / (y1 - y0)) * (bottom - top);
  const area = { x: left, y: top, width: right - left, height: bottom - top };
  const yTicks = ticks(y0, y1), short = (value) => `${value}`.replace("-", "−");
  const marks = [
    ...xTicks.map((v) => line([[x(v), bottom], [x(v), bottom + 5]], "tick") + text(x(v), bottom + 19, short(v))),
    ...yTicks.map((v) => line([[left - 5, y(v)], [left, y(v)]], "tick") + text(left - 8, y(v) + 4, short(v), "end")),
    text((left + right) / 2, bottom + 37, xWords),
    text(0, 0, yWords, "middle", { transform: `translate(13 ${(top + bottom) / 2}) rotate(-90)` }),
    tag("rect", { class: "frame", ...area }),
  ];
  const draw = (inside, above = "") => {
    const clip = tag("clipPath", { id: `${id}-clip` }, tag("rect", area));
    $(id).innerHTML = clip + tag("g", { "clip-path": `url(#${id}-clip)` }, inside) + marks.join("") + above;
  };
  return { x, y, area, draw };
}

// ---- (a) the rod --------------------------------------------------------------------------

/** Centre and turn of the rod in free flight, at a time from the impact; in units of its length. */
function flown(state, time) {
  const { rod } = shown, { length } = setting;
  return [rod.X / length + state.c_x * time, rod.Z / length + state.c_z * time, state.omega * length * time];
}

/** How long the picture shows the flight: 0.3, or until an end would be in the plate. */
function flight(state, way) {
  const { thick, round } = shown.rod;
  const above = (time) => {
    const [, z, turn] = flown(state, time), tilt = radians(setting.tilt_deg) + turn;
    const up = Math.abs(Math.cos(tilt)), along = Math.abs(Math.sin(tilt));
    return z > (round ? up * (1 - thick) + thick : up + thick * along) / 2 - 1e-3;
  };
  let time = 0;
  while (Math.abs(time) < 0.3 && above(time + 0.01 * way)) time += 0.01 * way;
  return time;
}

function drawRod(now, point) {
  const { before, after, rod } = shown, speed = 62, begin = flight(before, -1), finish = flight(after, 1);
  const place = ([x, z]) => [140 + ROD * x, 252 - ROD * z];
  const body = (state, time, look) => {
    const flight = flown(state, time), width = ROD * Math.max(rod.thick, 0.02);
    const turn = setting.tilt_deg + (flight[2] * 180) / Math.PI;
    const shape = { x: px(-width / 2), y: -ROD / 2, width: px(width), height: ROD, rx: rod.round ? px(width / 2) : 0 };
    return tag("rect", { class: look, ...shape, transform: `translate(${place(flight).map(px)}) rotate(${px(turn)})` });
  };
  const velocity = (state, time, look) =>
    arrow(...place(flown(state, time)), speed * state.c_x, -speed * state.c_z, look);
  const ghost = (state, time, look) => {
    const [x, z, turn] = flown(state, time), tilt = radians(setting.tilt_deg) + turn;
    const side = look === "after" ? 1 : -1, [X, Z] = place([x + 0.5 * Math.sin(tilt), z + 0.5 * Math.cos(tilt)]);
    const word = time ? text(X + 8 * side, Z - 5, look, side > 0 ? "start" : "end") : "";
    return body(state, time, `ghost ${look}`) + velocity(state, time, "centre pale") + word;
  };
  const part = moment < IN ? 1 - moment / IN : Math.max(0, (moment - OUT) / (1 - OUT));
  const time = part * (moment < IN ? begin : finish);
  const centre = place(flown(now, time)), [foot, ground] = place([0, 0]);
  let pieces = ghost(before, begin, "before") + ghost(after, finish, "after");
  pieces += line([[8, ground], [392, ground]], "plate") + body(now, time, "body") + ring(...centre, "dot", 3.5);
  pieces += velocity(now, time, "centre") + turning(...centre, now.spin);
  if (point) {
    const size = 30 / (Math.hypot(...point.way) || Infinity), [X, Z] = point.way.map((part) => part * size);
    pieces += arrow(foot - 1.4 * X, ground + 1.4 * Z, X, -Z, "force", 9);
    pieces += arrow(foot, ground, speed * now.u, -speed * now.v, "contact");
  }
  $("rod").innerHTML = pieces;
}

// ---- (b) the plane of impulses ------------------------------------------------------------

const impulse = (letter) => `P<tspan dy="3" font-size="9">${letter}</tspan><tspan dy="-3"> / (mass × speed)</tspan>`;

function drawPlane(point) {
  const { at, corners, ends, before } = shown;
  const all = [...corners, ...Object.values(ends).map((end) => [end.P_x, end.P_z])];
  const top = Math.max(...all.map(([, z]) => z)) || 1, wide = Math.max(...all.map(([x]) => Math.abs(x)));
  const scale = Math.min(248 / top, 165 / (wide || 1e-9)) / 1.2, size = { x: 165 / scale, z: 248 / scale };
  const { x, y, draw } = axes("plane", [-size.x, size.x], [0, size.z], impulse("x"), impulse("z"));
  const straight = (name, look) => {
    const f = before[name], a = at([1, 0])[name] - f, b = at([0, 1])[name] - f, far = 9 * (size.x + size.z);
    const foot = [(-f * a) / (a * a + b * b), (-f * b) / (a * a + b * b)], norm = Math.hypot(a, b);
    return line([-far, far].map((t) => [x(foot[0] - (t * b) / norm), y(foot[1] + (t * a) / norm)]), look);
  };
  const high = size.z, edge = setting.friction * high, cone = [[x(-edge), y(high)], [x(0), y(0)], [x(edge), y(high)]];
  const marks = Object.entries(ends).map(([law, end], i) => {
    const look = `end${law === setting.law ? " chosen" : ""}`, X = x(end.P_x), Y = y(end.P_z);
    if (i === 0) return ring(X, Y, look, 5);
    const shape = i === 1 ? [[-6, -6], [6, -6], [6, 6], [-6, 6], [-6, -6]] : [[-8, 6], [8, 6], [0, -8], [-8, 6]];
    return line(shape.map(([dx, dy]) => [X + dx, Y + dy]), look);
  });
  const P = point ? point.P : moment < IN ? [0, 0] : corners.at(-1);
  const way = line(corners.map(([X, Z]) => [x(X), y(Z)]), "path");
  const lines = line([[x(0), y(0)], [x(0), y(high)]], "zero") + straight("u", "stick") + straight("v", "deepest");
  draw(line(cone, "inside") + line(cone, "cone") + lines + way + marks.join(""), ring(x(P[0]), y(P[1])));
}

// ---- (c), (d): over tilt ------------------------------------------------------------------

const TILT_TICKS = [0, 15, 30, 45, 60, 75, 90], COLUMNS = 180, ROWS = 100;
const TILTS = Array.from({ length: 181 }, (_, i) => i / 2);

/** Values side by side as few rectangles as there are runs: [from, to, value]. */
function runs(values) {
  const found = [];
  values.forEach((value, i) => {
    if (i && found.at(-1)[2] === value) found.at(-1)[1] = i + 1;
    else found.push([i, i + 1, value]);
  });
  return found;
}

const rect = (left, top, right, height, regime) =>
  tag("rect", { class: `r${regime}`, x: px(left), y: px(top), width: px(right - left + 0.4), height: px(height) });
const colours = { key: "", rects: "" };

/** The regimes as rectangles; kept as long as only tilt, friction and law change. */
function regimeRects(x, y) {
  const key = JSON.stringify({ ...setting, tilt_deg: 0, friction: 0, law: "" });
  if (key === colours.key) return colours.rects;
  const step = 90 / COLUMNS;
  const rods = Array.from({ length: COLUMNS }, (_, i) => rodOf(setting, radians((i + 0.5) * step)));
  const given = rods.map((rod) => givenOf(setting, rod));
  const rows = Array.from({ length: ROWS }, (_, row) => {
    const high = y((row + 1) / ROWS), height = y(row / ROWS) - high + 0.4;
    const regimes = given.map((one) => rodImpact.collide("newton", { ...one, friction: (row + 0.5) / ROWS }).regime);
    return runs(regimes).map(([from, to, regime]) => rect(x(from * step), high, x(to * step), height, regime));
  });
  Object.assign(colours, { key, rects: rows.flat().join("") });
  return colours.rects;
}

function drawMap() {
  const { x, y, area, draw } = axes("map", [0, 90], [0, 1], "tilt φ (deg)", "friction μ", TILT_TICKS);
  const X = x(setting.tilt_deg), Y = y(setting.friction);
  const least = (deg) => rodImpact.critical_friction(rodOf(setting, radians(deg)));
  const critical = line(TILTS.map((deg) => [x(deg), y(least(deg))]), "critical");
  const cross = line([[X, y(0)], [X, y(1)]], "guide") + line([[x(0), Y], [x(90), Y]], "guide");
  draw(regimeRects(x, y) + critical + cross, ring(X, Y) + tag("rect", { class: "pad", ...area }));
}

function drawDrift() {
  const rods = TILTS.map((deg) => rodOf(setting, radians(deg)));
  const moves = rods.map((rod) => driftOf(setting, rod));
  const sticking = rods.map((rod) => driftOf(setting, rod, Infinity));
  const here = shown.drift.c_x, finite = moves.map(({ c_x }) => c_x).filter(Number.isFinite);
  const end = (size) => PAGE.steps.find((step) => size <= step) ?? PAGE.steps.at(-1);
  const low = -end(-Math.min(0, ...finite)), high = end(Math.max(0.5, ...finite));
  const words = ["tilt φ (deg)", "drift / plate velocity"];
  const { x, y, area, draw } = axes("drift", [0, 90], [low, high], ...words, TILT_TICKS);
  const curve = (values, look) =>
    line(values.map(({ c_x }, i) => [x(TILTS[i]), y(c_x)]).filter(([, Y]) => Number.isFinite(Y)), look);
  const shades = runs(moves.map(({ regime }) => regime)).map(([from, to, regime]) =>
    rect(x(from / 2 - 0.25), area.y, x(to / 2 - 0.25), area.height, regime));
  const guide = line([[x(setting.tilt_deg), y(low)], [x(setting.tilt_deg), y(high)]], "guide");
  const zero = line([[x(0), y(0)], [x(90), y(0)]], "zero");
  const point = Number.isFinite(here) ? ring(x(setting.tilt_deg), y(here)) : "";
  draw(shades.join("") + zero + guide + curve(sticking, "sticking") + curve(moves, "path"), point);
}

// ---- words and numbers --------------------------------------------------------------------

const number = (value, digits = 3) => value.toFixed(digits).replace(/^-(?=0\.0*$)/, "").replace("-", "−");

function words() {
  const { hit, drift, rod } = shown, lost = (-200 * hit.energy_change) / (1 + setting.spin ** 2), c_x = drift.c_x;
  const energy = `${number(Math.abs(lost), 1)} % of the energy ${lost > -0.05 ? "lost" : "GAINED"}`;
  const way = c_x > 0 ? "the way the rod leans" : "against the way the rod leans";
  const size = Number.isFinite(c_x) ? `${number(Math.abs(c_x))} of the plate’s velocity` : "without bound";
  const moves = Math.abs(c_x) < 5e-4 ? "none" : `${size}, ${way}`;
  return [
    `${PAGE.words[hit.regime]} ${hit.regime > 0 ? `${energy}.` : ""}`,
    `At this tilt a contact that has stopped slips back below friction ${number(rodImpact.critical_friction(rod))}.`,
    `Drift: ${Number.isNaN(c_x) ? "not determined without friction" : moves}.`,
  ].join(" ");
}

function phase(now, point) {
  if (shown.hit.regime < 1) return "No impact.";
  if (!point) return moment < IN ? "Before: the rod comes to the plate." : "After: the rod leaves the plate.";
  const stopped = point.piece > 1, side = now.u > 0 ? "right" : "left", slips = Math.abs(now.u) > 1e-9;
  const motion = stopped && shown.hit.regime === 2 ? "friction holds the contact point"
    : !slips ? "the contact point stands" : `the contact point slips ${stopped ? "back " : ""}to the ${side}`;
  const part = Math.abs(now.v) < 1e-9 ? "Largest compression" : now.v < 0 ? "Compression" : "Restitution";
  return `${part}: ${motion}.`;
}

/** Show the moment: rod, point in the plane of impulses, numbers of now. */
function showMoment() {
  const inside = moment >= IN && moment <= OUT;
  const point = inside ? pointAt(shown.corners, (shown.hit.P_z * (moment - IN)) / (OUT - IN)) : null;
  const now = inside ? shown.at(point.P) : moment < IN ? shown.before : shown.after;
  drawRod(now, point);
  drawPlane(point);
  for (const name of Object.keys(PAGE.rows)) $(`${name}-now`).textContent = number(now[name]);
  $("phase").textContent = phase(now, point);
  $("clock").value = moment;
}

/** Bring everything up to date with the setting. */
function show() {
  shown = impactOf(setting);
  for (const name of Object.keys(PAGE.rows)) {
    $(`${name}-before`).textContent = number(shown.before[name]);
    $(`${name}-after`).textContent = number(shown.after[name]);
  }
  $("words").textContent = words();
  drawMap();
  drawDrift();
  showMoment();
}

// ---- controls -----------------------------------------------------------------------------

/** Change the setting, as far as the values are allowed, and the controls with it. */
function set(changes, from = "") {
  for (const [name, value] of Object.entries(changes)) {
    const [low, high] = PAGE.ranges[name] ?? [], given = `${value}`.trim();
    const wanted = given === "" ? NaN : Number(given);
    // What a field shows is what it holds.
    if (names.includes(name) && Number.isFinite(wanted)) {
      setting[name] = +Math.max(low, Math.min(high, wanted)).toPrecision(6);
    }
    if (choices.includes(name) && Object.hasOwn(PAGE.choices[name], given)) setting[name] = given;
  }
  for (const name of names) {
    $(name).value = setting[name];
    if (from !== `${name}-number`) $(`${name}-number`).value = setting[name];
  }
  for (const name of choices) $(`${name}-${setting[name]}`).checked = true;
  for (const id of ["length", "length-number"]) $(id).disabled = setting.shape === "thin"; // changes nothing there
  show();
}

function remember() {
  const changed = Object.entries(setting).filter(([name, value]) => value !== PAGE.start[name]);
  history.replaceState(null, "", `#${new URLSearchParams(changed)}`);
}

const recall = () => set({ ...PAGE.start, ...Object.fromEntries(new URLSearchParams(location.hash.slice(1))) });

/** Show another moment, without motion. */
function go(to) {
  play(false);
  moment = to;
  showMoment();
}

function play(on) {
  cancelAnimationFrame(playing);
  playing = 0;
  $("play").textContent = on ? "Pause" : "Play";
  if (!on) return;
  const first = moment < 1 ? moment : 0, began = performance.now();
  const step = (time) => {
    const gone = (time - began) / 1000 / SECONDS;
    moment = Math.min(first + (REDUCED.matches ? Math.floor(10 * gone) / 10 : gone), 1);
    showMoment();
    if (moment < 1) playing = requestAnimationFrame(step);
    else play(false);
  };
  playing = requestAnimationFrame(step);
}

for (const name of names) {
  for (const id of [name, `${name}-number`]) {
    $(id).addEventListener("input", () => set({ [name]: $(id).value }, id));
    $(id).addEventListener("change", () => (set({}), remember()));
  }
}
for (const name of choices) {
  for (const value of Object.keys(PAGE.choices[name])) {
    $(`${name}-${value}`).addEventListener("change", () => (set({ [name]: value }), remember()));
  }
}
$("reset").addEventListener("click", () => (set(PAGE.start), remember()));
$("play").addEventListener("click", () => play(!playing));
$("step").addEventListener("click", () => go(shown.moments.find((one) => one > moment + 1e-9) ?? 0));
$("clock").addEventListener("input", () => go(+$("clock").value));
for (const kind of ["pointerdown", "pointermove"]) {
  $("map").addEventListener(kind, (event) => {
    if (!event.buttons) return;
    $("map").setPointerCapture(event.pointerId);
    const place = new DOMPoint(event.clientX, event.clientY).matrixTransform($("map").getScreenCTM().inverse());
    const { x, y } = axes("map", [0, 1], [0, 1], "", "");
    const part = (low, high, value) => Math.max(0, Math.min(1, (value - low) / (high - low)));
    const tilt_deg = Math.round(900 * part(x(0), x(1), place.x)) / 10;
    set({ tilt_deg, friction: Math.round(1000 * part(y(0), y(1), place.y)) / 1000 });
  });
}
$("map").addEventListener("pointerup", remember);
const KEYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1] };
$("map").addEventListener("keydown", (event) => {
  const way = KEYS[event.key];
  if (!way) return;
  event.preventDefault(); // the page does not scroll
  set({ tilt_deg: setting.tilt_deg + 0.5 * way[0], friction: setting.friction + 0.01 * way[1] });
  remember();
});
addEventListener("hashchange", recall);
moment = REDUCED.matches ? 0.5 : 0;
recall();
play(!REDUCED.matches);
