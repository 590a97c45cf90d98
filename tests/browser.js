// As much of a browser as the page of sliders asks for: node browser.js PAGE CHANGES
// What an address sets; for each change of the setting, what the page then shows; then how it plays
// and steps; last what the arrow keys of the map set, and whether a thin rod has a length.
const { readFileSync } = require("fs");
const { runInThisContext } = require("vm");

const text = readFileSync(process.argv[2], "utf8");
const ids = [...text.matchAll(/ id="([^"]+)"/g)].map(([, id]) => id);
const made = () => ({ heard: {}, textContent: "", innerHTML: "" });
const elements = Object.fromEntries(ids.map((id) => [id, made()]));
for (const one of Object.values(elements)) {
  one.addEventListener = (kind, act) => (one.heard[kind] = act);
}
let now = 0, frame;
Object.defineProperty(globalThis, "performance", { value: { now: () => now } });
Object.assign(globalThis, {
  document: { getElementById: (id) => elements[id] },
  location: { hash: "#law=toString&tilt_deg=many&speed=3&friction=&ratio=4" },
  history: { replaceState: (state, title, address) => (location.hash = address) },
  matchMedia: () => ({ matches: true }),
  requestAnimationFrame: (act) => ((frame = act), 1),
  cancelAnimationFrame: () => (frame = null),
  addEventListener() {},
});
for (const [, script] of text.matchAll(/<script>([^]*?)<\/script>/g)) runInThisContext(script);

const given = ["ratio", "tilt_deg"].map((name) => +elements[`${name}-number`].value);
console.log(JSON.stringify(given));
for (const changes of JSON.parse(process.argv[3])) {
  elements.reset.heard.click();
  for (const [name, value] of Object.entries(changes)) {
    const control = elements[name] ?? elements[`${name}-${value}`];
    control.value = `${value}`;
    control.heard.input?.();
    control.heard.change();
  }
  for (const moment of ["0", "0.31", "0.5", "0.69", "1"]) {
    elements.clock.value = moment;
    elements.clock.heard.input();
  }
  const shown = Object.entries(elements).map(([id, one]) => [id, one.textContent || one.innerHTML]);
  console.log(JSON.stringify({ ...Object.fromEntries(shown), hash: location.hash }));
}

const seen = [];
const look = () => seen.push(+elements.clock.value, elements.play.textContent);
elements.play.heard.click();
for (now of [0, 4700, 90000]) {
  frame(now); // 8 s in all, in tenths where motion is to be reduced
  look();
}
elements.reset.heard.click();
for (let i = 0; i < 6; i += 1) {
  elements.step.heard.click(); // from the end to the beginning, and on
  seen.push([elements.phase.textContent, elements["u-now"].textContent, elements["v-now"].textContent]);
}
console.log(JSON.stringify(seen));

elements.reset.heard.click();
const press = (key) => elements.map.heard.keydown({ key, preventDefault() {} });
["ArrowRight", "ArrowRight", "ArrowUp", "ArrowLeft", "ArrowDown", "ArrowDown", "Tab"].forEach(press);
const fields = ["tilt_deg", "friction", "length"].map((name) => elements[`${name}-number`]);
const [tilt, friction, length] = fields;
const before = length.disabled;
elements["shape-thin"].heard.change();
console.log(JSON.stringify([tilt.value, friction.value, before, length.disabled]));
