// The report's load paths of the static model: displacements, stresses, order of failure, the joint.
const pathsOf = (mesh) => JOINTS.paths.filter((path) => path.sample === chosenSample() && (mesh === null || path.mesh === mesh));
const chosenPath = () => pathsOf(Number(at("path-mesh").value)).find((path) => path.eccentricity === at("path-direction").value);
const chosenStep = (path) => path.steps[Math.min(Number(at("path-step").value), path.steps.length - 1)];

const WIDE_BAR = { orientation: "h", x: 0.5, y: 1, yanchor: "bottom", len: 0.8, thickness: 12, title: { text: "shear / cohesion", side: "top" } };
const BEHIND = "#d55e00", V_COLOUR = "#d55e00";

// What a load along a path's direction amounts to: V in N, in pure torsion M in N m.
function amountOf(path) {
  const torsion = path.eccentricity === "torsion";
  const factor = torsion ? JOINTS.sizes[path.sample].a_m : 1 / Math.hypot(1, Number(path.eccentricity));
  const unit = torsion ? "N m" : "N";
  return { of: (load) => factor * load, said: (load) => `${short(factor * load)} ${unit}`, title: torsion ? "torque M (N m)" : "shear V (N)" };
}

function drawDisplacement(path, step) {
  const micro = ([u]) => 1e6 * u, peak = path.curve.at(-1), amount = amountOf(path);
  const line = (points, name, more) => ({ x: points.map(micro), y: points.map(([, load]) => amount.of(load)), name, ...more });
  const traces = [line(path.curve, "static model, load raised", { mode: "lines", line: { color: labelOf("static").colour, width: 2.5 } })];
  const first = path.curve.find(([, load]) => load >= path.first * (1 - 1e-5));
  if (first) traces.push(line([first], "first failure", { mode: "markers", marker: { symbol: "diamond-open", size: 11, color: "#8a6d00", line: { width: 2 } } }));
  traces.push(line([peak], "peak", { mode: "markers", marker: { symbol: "star", size: 13, color: labelOf("static").colour } }));
  if (path.behind && path.behind.length) traces.push(line([peak, ...path.behind], "after the peak", { mode: "lines+markers", line: { color: BEHIND, dash: "dot", width: 1.5 }, marker: { symbol: "circle-open", size: 6, color: BEHIND } }));
  traces.push(line([path.curve.reduce((one, other) => (Math.abs(other[1] - step.load) < Math.abs(one[1] - step.load) ? other : one))], "shown below", { mode: "markers", marker: { symbol: "circle", size: 9, color: "#000000" } }));
  chart("move-plot", traces, { xaxis: axis("displacement along the load (µm)", { rangemode: "tozero" }), yaxis: axis(amount.title, { rangemode: "tozero" }) });
  at("move-text").textContent = `First failure ${amount.said(path.first)}, peak ${amount.said(peak[1])} at ${short(1e6 * peak[0])} µm. ${behindWords(path, amount)}`;
}

function behindWords({ behind, curve }, amount) {
  if (behind === null) return "Post-peak response is available only on coarser meshes, or in pure shear.";
  if (!behind.length) return "No equilibrium remains after the peak: the joint collapses at once.";
  const most = Math.max(...behind.map(([, load]) => load));
  return `Under displacement control ${behind.length === 1 ? "bonds fail once more" : `bonds fail ${behind.length} more times`} after the peak; the residual capacity is ${amount.said(most)} (${Math.round((100 * most) / curve.at(-1)[1])} % of the peak). Under load control the joint collapses at the peak.`;
}

// Edges of the cells around the places of nodes, from one edge of a face to the other.
function cellEdges(places, low, high) {
  return [low, ...places.slice(1).map((place, k) => (place + places[k]) / 2), high].map((v) => 1000 * v);
}

function drawStress(path, step) {
  const failed = { x: [], y: [] }, names = [], outlines = [];
  const bar = { colorscale: "Viridis", zmin: 0, zmax: 1, colorbar: WIDE_BAR };
  const maps = path.faces.map((face, k) => {
    const { low, high } = JOINTS.pieces[path.sample].find((piece) => piece.name === `lock${face.lock}`);
    const [across, along] = [face.y, face.x].map((places) => unique(places).sort((a, b) => a - b));
    const z = along.map(() => across.map(() => null));
    face.x.forEach((_, node) => {
      z[along.indexOf(face.x[node])][across.indexOf(face.y[node])] = step.shear[k][node];
      if (!step.bonded[k][node]) { failed.x.push(1000 * face.y[node]); failed.y.push(1000 * face.x[node]); }
    });
    names.push({ x: 500 * (low[1] + high[1]), y: 1000 * high[0], text: `lock ${face.lock}`, showarrow: false, yanchor: "bottom" });
    outlines.push({ type: "rect", x0: 1000 * low[1], x1: 1000 * high[1], y0: 1000 * low[0], y1: 1000 * high[0], line: { color: "#ffffff", width: 1.5 } });
    return { type: "heatmap", x: cellEdges(across, low[1], high[1]), y: cellEdges(along, low[0], high[0]), z, ...bar, showscale: k === 0, hovertemplate: `lock ${face.lock}: %{z:.3f}<extra></extra>` };
  });
  const crosses = { ...failed, mode: "markers", marker: { symbol: "x-thin", size: 6, line: { color: "#ffffff", width: 1.5 } }, hoverinfo: "skip" };
  chart("stress-plot", [...maps, crosses], { annotations: names, shapes: outlines, xaxis: axis("across the locks y (mm)", { showgrid: false, zeroline: false }), yaxis: axis("along them x (mm)", { scaleanchor: "x", showgrid: false, zeroline: false }), showlegend: false, margin: { l: 60, r: 20, t: 60, b: 50 } });
}

function drawOrder(path, step) {
  const amount = amountOf(path), loads = path.steps.map((s) => amount.of(s.load));
  const traces = path.faces.map((face, k) => ({ x: loads, y: path.steps.map((s) => Math.max(...s.shear[k].map((v, i) => (s.bonded[k][i] ? v : 0)))), name: `lock ${face.lock}`, mode: "lines+markers", marker: { symbol: MARKS[k % MARKS.length] }, line: { color: COLOURS[k % COLOURS.length], dash: DASHES[k % DASHES.length] } }));
  const here = { type: "line", x0: amount.of(step.load), x1: amount.of(step.load), y0: 0, y1: 1, line: { color: "#555555", dash: "dot" } };
  chart("order-plot", traces, { shapes: [here], xaxis: axis(amount.title), yaxis: axis("largest shear / cohesion", { rangemode: "tozero" }) });
  const last = path.steps[path.steps.length - 1];
  const order = path.faces.filter((face) => face.fails_from !== null).sort((a, b) => a.fails_from - b.fails_from);
  at("order-text").textContent = (order.length ? `Bonds fail first in lock ${order.map((face) => `${face.lock} (from ${amount.said(face.fails_from)})`).join(", then in lock ")}. ` : "No bond fails before the peak. ") + `Peak: ${amount.said(last.load)}.`;
}

function boxMesh(piece, moved, scale, colour, opacity) {
  const [lo, hi] = [piece.low, piece.high];
  const centre = lo.map((v, k) => (v + hi[k]) / 2);
  const corner = [];
  for (let k = 0; k < 8; k += 1) {
    const p = [k & 1 ? hi[0] : lo[0], k & 2 ? hi[1] : lo[1], k & 4 ? hi[2] : lo[2]];
    corner.push(shifted(p, centre, moved, scale));
  }
  const i = [0, 1, 4, 5, 0, 1, 2, 3, 0, 2, 1, 3], j = [1, 3, 6, 7, 4, 5, 3, 7, 2, 6, 3, 7], k = [2, 2, 5, 6, 1, 4, 6, 6, 4, 4, 5, 5];
  return { type: "mesh3d", x: corner.map((p) => p[0]), y: corner.map((p) => p[1]), z: corner.map((p) => p[2]), i, j, k, color: colour, opacity, flatshading: true, name: piece.name, hoverinfo: "name" };
}

// Shear V (N) and torque M (N m) at a step: V at its eccentricity, M about the middle.
function loadOf(path, step) {
  const a = JOINTS.sizes[path.sample].a_m, amount = amountOf(path).of(step.load);
  if (path.eccentricity === "torsion") return { a, V: 0, M: amount, e: null };
  const ratio = Number(path.eccentricity), V = amount;
  return { a, V, M: V * ratio * a, e: ratio * a };
}

function loadTraces(path, step, pieces) {
  const { a, V, M, e } = loadOf(path, step), upper = pieces.filter((p) => p.block === "upper" && p.name !== "plate");
  const low = [0, 1, 2].map((k) => Math.min(...upper.map((p) => p.low[k]))), high = [0, 1, 2].map((k) => Math.max(...upper.map((p) => p.high[k])));
  const size = high[1] - low[1], top = high[2] + 0.12 * a, middle = (low[1] + high[1]) / 2, z = (low[2] + high[2]) / 2;
  // A new trace for each text: one whose text changes is drawn too small.
  const said = ([x, y, z], text) => ({ uid: `said-${text.replace(/[^\w]/g, "-")}`, type: "scatter3d", mode: "text", x: [x], y: [y], z: [z], text: [text], textposition: "top center", textfont: { size: 16 }, hoverinfo: "skip" });
  const line = (points, uid) => ({ uid: `line-${uid}`, type: "scatter3d", mode: "lines", x: points.map((p) => p[0]), y: points.map((p) => p[1]), z: points.map((p) => p[2]), line: { color: V_COLOUR, width: 6 }, hoverinfo: "skip" });
  const head = (p, d, length) => ({ type: "cone", x: [p[0]], y: [p[1]], z: [p[2]], u: [d[0]], v: [d[1]], w: [d[2]], anchor: "tip", sizemode: "absolute", sizeref: length, showscale: false, colorscale: [[0, V_COLOUR], [1, V_COLOUR]], hoverinfo: "skip" });
  const found = [];
  if (V > 0) {
    const x = path.push * e, from = path.push > 0 ? low[1] : high[1];
    found.push(line([[x, from - path.push * 0.3 * size, z], [x, from, z]], "V"), said([x, from - path.push * 0.15 * size, z], `V = ${short(V)} N`), head([x, from, z], [0, path.push, 0], 0.18 * a));
    if (Math.abs(x) > a / 2) found.push(line([[x, from, z], [0, from, z]], "e"));
  }
  if (M > 0) {
    const r = 0.35 * a, turn = [...Array(25).keys()].map((k) => (-0.75 + (k / 24) * 1.5) * Math.PI);
    const arc = turn.map((t) => [r * Math.cos(t), middle + r * Math.sin(t), top]), end = turn.at(-1);
    found.push(line(arc, "M"), said(arc[0], `M = ${short(M)} N m`), head(arc.at(-1), [-Math.sin(end), Math.cos(end), 0], 0.18 * a));
  }
  return found;
}

function lockNumbers(path, pieces, step, scale) {
  const found = pieces.map((piece, k) => ({ piece, k })).filter(({ piece }) => piece.name.startsWith("lock"));
  const places = found.map(({ piece, k }) => {
    const centre = piece.low.map((v, c) => (v + piece.high[c]) / 2);
    return shifted([piece.high[0] + 0.08 * (piece.high[0] - piece.low[0]), centre[1], centre[2]], centre, step.moved[k], scale);
  });
  return { uid: "numbers", type: "scatter3d", mode: "text", x: places.map((p) => p[0]), y: places.map((p) => p[1]), z: places.map((p) => p[2]), text: found.map(({ piece }) => piece.name.replace("lock", "")), textfont: { size: 16 }, hoverinfo: "skip" };
}

function drawJoint(path, step) {
  const pieces = JOINTS.pieces[path.sample];
  const size = Math.max(...pieces.flatMap((p) => p.high.map((v, k) => v - p.low[k])));
  const largest = Math.max(1e-12, ...step.moved.flatMap((m) => m.slice(0, 3).map(Math.abs)));
  const scale = (Number(at("joint-scale").value) / 100) * 0.3 * size / largest;
  at("joint-factor").textContent = scale > 0 ? `× ${short(Number(scale.toPrecision(2)))}` : "undeformed";
  const traces = [];
  pieces.forEach((piece, k) => {
    const body = !piece.name.startsWith("lock");
    if (piece.name === "plate" || (body && piece.block === "upper" && !at("joint-body").checked)) return;
    traces.push(boxMesh(piece, step.moved[k], scale, piece.block === "upper" ? "#56b4e9" : "#9aa0aa", body ? 0.25 : 0.6));
  });
  const x = [], y = [], z = [], colour = [];
  path.faces.forEach((face, k) => {
    const name = `lock${face.lock}`;
    const n = pieces.findIndex((p) => p.name === name);
    const centre = pieces[n].low.map((v, axisNumber) => (v + pieces[n].high[axisNumber]) / 2);
    face.x.forEach((_, node) => {
      const p = shifted([face.x[node], face.y[node], face.z], centre, step.moved[n], scale);
      x.push(p[0]); y.push(p[1]); z.push(p[2]); colour.push(step.shear[k][node]);
    });
  });
  traces.push({ type: "scatter3d", mode: "markers", x, y, z, marker: { size: 4, color: colour, colorscale: "Viridis", cmin: 0, cmax: 1, colorbar: { ...WIDE_BAR, y: 0, yanchor: "bottom" } }, hovertemplate: "%{marker.color:.3f}<extra></extra>" });
  traces.push(...loadTraces(path, step, pieces), lockNumbers(path, pieces, step, scale));
  const scene = { aspectmode: "data", domain: { y: [0.14, 1] }, camera: { eye: eyeFrom(at("joint-plot")) }, xaxis: { visible: false }, yaxis: { visible: false }, zaxis: { visible: false } };
  return chart("joint-plot", traces, { scene, margin: { l: 0, r: 0, t: 0, b: 0 }, showlegend: false, uirevision: path.sample });
}

// Further away where the plot is narrower than high.
function eyeFrom({ clientHeight, clientWidth }) {
  const away = Math.max(1, (1.5 * clientHeight) / clientWidth);
  return { x: 1.3 * away, y: -1.1 * away, z: 0.8 * away };
}

function drawPath() {
  const path = chosenPath();
  if (!path) return;
  const step = chosenStep(path);
  at("path-load").textContent = amountOf(path).said(step.load);
  drawDisplacement(path, step);
  drawStress(path, step);
  drawOrder(path, step);
  drawJoint(path, step);
}

function choosePath() {
  const meshes = unique(pathsOf(null).map((path) => path.mesh));
  const mesh = Number(at("path-mesh").value);
  fill(at("path-mesh"), meshes, meshes.includes(mesh) ? mesh : meshes.filter((own) => JOINTS.meshes.includes(own)).at(-1));
  const own = pathsOf(Number(at("path-mesh").value)).map((path) => path.eccentricity);
  fill(at("path-direction"), own, own.includes(at("path-direction").value) ? at("path-direction").value : own[0]);
  const path = chosenPath();
  if (path) {
    at("path-step").max = path.steps.length - 1;
    at("path-step").value = path.steps.length - 1;
  }
  drawPath();
}

// Another joint: the sections are hidden where it has no path.
function chooseJoint() {
  const known = pathsOf(null).length > 0;
  for (const id of ["stresses", "joint"]) at(id).hidden = !known;
  at("no-paths").hidden = known;
  if (known) choosePath();
}

function startPaths() {
  at("path-mesh").addEventListener("change", choosePath);
  at("path-direction").addEventListener("change", choosePath);
  for (const id of ["path-step", "joint-scale", "joint-body"]) at(id).addEventListener("input", drawPath);
  player(at("joint-play"), at("joint-scale"), () => drawJoint(chosenPath(), chosenStep(chosenPath())));
  onSample(chooseJoint);
}

startPaths();
