"use strict";
// The sliders' values go to the server, one request at a time; the latest wins. Everything shown is
// from one answer, and grey while the sliders have other values.
const inFlight = new Set();
let latest = 0; // number of the sliders' last change
let shown = null; // the answer on the page
let line = null; // the curve on the page

const isJointOf = (one, other) => Object.keys(one).every((name) => ["eccentricity", "scatter", "gamma_m"].includes(name) || one[name] === other[name]);

function changed() {
  latest += 1;
  at("answer").ariaBusy = at("curve").ariaBusy = "true";
  showEffects({}); // those of another joint
  ask("answer");
}

async function ask(kind) {
  if (inFlight.has(kind)) return; // which asks again as soon as it is back
  inFlight.add(kind);
  const number = latest;
  const found = await post(kind, { page: PAGE, number, values: values(), kept: state.kept }, "joint");
  inFlight.delete(kind);
  const show = { answer: showAnswer, curve: showCurve }[kind];
  if (found) show(found);
  if (number === latest) return;
  if (kind === "answer" || shown?.number === latest) ask(kind);
}

function showAnswer(answer) {
  shown = answer;
  for (const name of ["words", "yaml", "python", "link"]) at(name).textContent = answer[name];
  drawCurve();
  drawJoint();
  showComparison(answer);
  if (answer.number !== latest) return; // in grey: the sliders have moved on
  at("answer").ariaBusy = "false";
  arrived(answer);
  for (const act of waiting.splice(0)) act();
  ask("curve");
}

// Where law and safe rule answer, below each slider: as a bar, and in words where that is not everywhere.
function showCovered(covered) {
  for (const [name, span] of Object.entries(covered)) {
    const { min, max } = at(name), share = (value) => (100 * (value - min)) / (max - min);
    const [low, high] = span || [min, min];
    Object.assign(at(`${name}-span`).firstElementChild.style, { left: `${share(low)}%`, width: `${share(high) - share(low)}%` });
    const everywhere = span && low === Number(min) && high === Number(max);
    at(`${name}-words`).textContent = everywhere ? "" : span ? `law tested from ${low} to ${high}` : "outside the range in which the law was tested";
  }
}

// Which way to pull each slider.
function showEffects(effects) {
  for (const slider of sliders) if (at(`${slider.id}-effect`)) at(`${slider.id}-effect`).textContent = effects[slider.id] || "";
}

function showCurve(curve) {
  if (curve.number !== shown.number) return; // a curve of another joint than the numbers'
  showCovered(curve.covered);
  showComparison(curve);
  showEffects(curve.number === latest ? curve.effects : {});
  line = curve;
  shown.words = at("words").textContent = `${shown.words} ${curve.counts}`.trim();
  drawCurve();
  at("curve").ariaBusy = String(curve.number !== latest);
}

// --- charts ----------------------------------------------------------------------------------
function drawCurve() {
  const { name, colour, shear, torque } = shown.curve;
  const current = line && isJointOf(line.values, shown.values);
  const style = (color) => ({ mode: "lines+markers", line: { color }, marker: { color } });
  const traces = line && !current ? [vmTrace({ shear: line.shear, torque: line.torque, name: "curve of another joint", ...style("#c9ced8") })] : [];
  traces.push(vmTrace({ shear: current ? line.shear : shear, torque: current ? line.torque : torque, name: current ? name + line.spread.replace(" ", "<br>") : name, ...style(colour) }));
  if (shown.kept) {
    if (line && line.kept) traces.push(vmTrace({ ...line.kept, name: `kept: ${line.kept.name}`, mode: "lines", line: { color: "#555555", dash: "dash", width: 2 } }));
    for (const mark of shown.kept.marks) traces.push(vmTrace({ shear: [mark.shear], torque: [mark.torque], name: `kept: ${mark.name}`, mode: "markers", marker: { color: "#555555", symbol: mark.symbol, size: 11 }, showlegend: false }));
  }
  for (const mark of shown.marks) traces.push(vmTrace({ shear: [mark.shear], torque: [mark.torque], name: mark.name, mode: "markers", marker: { color: mark.colour, symbol: mark.symbol, size: 12 } }));
  vmChart("curve", traces, { margin: { l: 60, r: 15, t: 15, b: 50 }, uirevision: "same" });
}

function part(name, attributes, text = "") {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.textContent = text;
  return element;
}

function bar(share, left, width, foot, height, numbered, type) {
  const [middle, top] = [left + width / 2, foot - height * share.weight];
  const parts = [part("rect", { x: left + 0.15 * width, y: top, width: 0.7 * width, height: foot - top, fill: shown.colours[share.block], class: "weight" })];
  if (numbered) parts.push(part("text", { x: middle, y: foot + 1.1 * type, "text-anchor": "middle" }, share.lock));
  if (width > 2.4 * type) parts.push(part("text", { x: middle, y: top - 4, "text-anchor": "middle" }, share.weight.toFixed(2)));
  return parts;
}

function box({ lock, block }, x, y, width, height) {
  return part("rect", { x, y, width, height, fill: shown.colours[block], "fill-opacity": lock === null ? 0.4 : 0.9, class: lock === null ? "piece" : "piece lock" });
}

// The joint from the side, and over each lock its weight.
function drawJoint() {
  const { a, b, h, H, locks } = shown.values;
  const across = 640, type = 12 * Math.max(1, across / (at("drawing").clientWidth || across)); // as high in narrow windows
  const [foot, high, tall, left] = [110 + 2.5 * type, 100, 170, 70]; // pixels
  const scale = Math.min((across - 1.5 * left) / (locks * b), tall / (h + 2 * H));
  const every = Math.ceil((1.7 * type) / (scale * b)); // lock has its number
  const y = (z) => foot + 1.8 * type + scale * (h + H - z);
  const parts = [0, 0.5, 1].flatMap((weight) => [
    part("path", { d: `M ${left} ${foot - high * weight} h ${scale * locks * b}`, stroke: "#c9ced8" }),
    part("text", { x: left - 6, y: foot - high * weight, "text-anchor": "end", "dominant-baseline": "central" }, weight),
  ]);
  parts.push(part("text", { x: left - 60, y: foot - high - 1.5 * type }, "lock weights"));
  for (const share of shown.shares) parts.push(...bar(share, left + scale * b * (share.lock - 1), scale * b, foot, high, share.lock % every === 1 || every === 1, type));
  for (const piece of shown.pieces) {
    const { low, high: up } = piece;
    parts.push(box(piece, left + scale * low[0], y(up[1]), scale * (up[0] - low[0]), scale * (up[1] - low[1])));
  }
  const middle = y((h + H) / 2);
  parts.push(part("path", { d: `M ${left - 45} ${middle} h 38 m -7 -5 l 7 5 l -7 5`, fill: "none", stroke: "currentColor", "stroke-width": 2 }));
  parts.push(part("text", { x: left - 60, y: middle, "dominant-baseline": "central" }, "V"));
  parts.push(part("text", { x: left - 60, y: y(-H) + 1.5 * type }, `${locks} locks: a = ${a}, b = ${b}, h = ${h}, H = ${H} mm; ${locks * b} mm long`));
  at("drawing").setAttribute("viewBox", `0 0 ${across} ${y(-H) + 2.5 * type}`);
  at("drawing").style.fontSize = `${type}px`;
  const weights = shown.shares.map((share) => `${share.lock}: ${share.weight.toFixed(2)}`).join(", ");
  at("drawing").ariaLabel = `The joint from the side: ${locks} locks, weights ${weights || "unknown"}`;
  at("drawing").replaceChildren(...parts);
}

listen(() => {}, changed);
