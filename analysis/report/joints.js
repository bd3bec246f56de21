// The report's charts of joints.
const JOINTS = DATA.joints;
const capacity = records(DATA.tables.capacity);
const weights = records(DATA.tables.weights);
const cases = records(DATA.tables.cases);
const markOf = (model) => MARKS[models.indexOf(model) % MARKS.length];

// --- V-M curves ------------------------------------------------------------------------------
const rank = (row) => (row.eccentricity_m === "inf" ? Infinity : row.eccentricity_m);
const plain = capacity.filter((row) => row.model !== "sidmacib" && row.model !== "published");
const rules = capacity.filter((row) => row.model === "sidmacib" && row.option !== null);
const models = unique(plain.map((row) => row.model));

function drawCurves() {
  const sample = at("curve-sample").value;
  const mesh = Number(at("curve-mesh").value);
  const variant = at("curve-variant").value;
  const shown = ticked(at("curve-models"));
  const options = ticked(at("curve-options"));
  const traces = [];
  const line = (rows, name, style) => {
    const own = rows.filter((row) => row.load_N !== null).sort((a, b) => rank(a) - rank(b));
    if (own.length) traces.push(vmTrace({ shear: own.map((r) => r.shear_N), torque: own.map((r) => r.torque_Nm), name, text: own.map((r) => `e = ${r.eccentricity_m === "inf" ? "torsion" : short(r.eccentricity_m) + " m"}`), hovertemplate: "%{text}<br>V = %{x:.1f} N<br>M = %{y:.3f} N m", ...style }));
  };
  for (const model of shown) {
    const number = models.indexOf(model);
    const rows = plain.filter((r) => r.sample === sample && r.mesh_m === mesh && r.model === model && r.variant === variant);
    const label = labelOf(model);
    line(rows, label.name, { mode: label.engine ? "markers" : "lines+markers", marker: { symbol: markOf(model), size: 9, color: label.colour }, line: { dash: DASHES[number % DASHES.length], color: label.colour } });
  }
  for (const option of options) {
    const rows = rules.filter((r) => r.sample === sample && r.mesh_m === mesh && r.option === option && r.reduction === at("curve-reduction").value && r.weights_from === at("curve-source").value && String(r.friction) === String(at("curve-friction").checked));
    line(rows, `${labelOf("sidmacib").name} ${JOINTS.options[option].name}`, { mode: "lines", line: { width: 1.5, dash: "dot", color: JOINTS.options[option].colour } });
  }
  vmChart("curve-plot", traces);
  const peaks = traces.map((t) => `${t.name} ${short(Math.max(...t.x))} N and ${short(Math.max(...t.y))} N m`);
  at("curve-text").textContent = `${sample}, mesh ${mesh} m. Largest V and M: ${peaks.join("; ") || "nothing chosen"}.`;
}

function fillSources() {
  const own = unique(rules.filter((row) => row.sample === at("curve-sample").value).map((row) => row.weights_from));
  fill(at("curve-source"), own, own[0], (model) => labelOf(model).name);
}

function startCurves() {
  const samples = JOINTS.samples;
  fill(at("curve-sample"), samples, samples[0]);
  const meshes = JOINTS.meshes.filter((mesh) => plain.some((row) => row.mesh_m === mesh));
  fill(at("curve-mesh"), meshes, meshes[0]);
  fill(at("curve-variant"), unique(plain.map((row) => row.variant)), "reference");
  const reductions = unique(rules.map((row) => row.reduction));
  fill(at("curve-reduction"), reductions, reductions.includes("lower_sum") ? "lower_sum" : reductions[0], (name) => JOINTS.rules[name] || name);
  at("curve-sample").addEventListener("change", fillSources);
  fillSources();
  boxes(at("curve-models"), models, models, drawCurves, (model) => labelOf(model).name);
  boxes(at("curve-options"), unique(rules.map((row) => row.option)), ["option4"], drawCurves, (option) => JOINTS.options[option].name);
  for (const id of ["curve-sample", "curve-mesh", "curve-reduction", "curve-source", "curve-friction", "curve-variant"]) at(id).addEventListener("change", drawCurves);
  drawCurves();
}

// --- weights ---------------------------------------------------------------------------------
function drawWeights() {
  const rows = weights.filter((row) => row.case === at("weight-case").value && row.variant === "reference");
  const traces = unique(rows.map((row) => row.model)).map((model) => {
    const own = rows.filter((row) => row.model === model);
    return { type: "bar", name: labelOf(model).name, x: own.map((r) => `lock ${r.lock} (${r.block})`), y: own.map((r) => r.weight), marker: { color: labelOf(model).colour } };
  });
  chart("weight-plot", traces, { barmode: "group", xaxis: axis(""), yaxis: axis("weight", { rangemode: "tozero" }) });
  at("weight-text").textContent = traces.map((t) => `${t.name}: ${t.y.map(short).join(", ")}`).join("; ");
}

function chooseWeights() {
  const own = unique(weights.filter((row) => row.sample === at("weight-sample").value && row.variant === "reference").map((row) => row.case));
  fill(at("weight-case"), own, own[0]);
  drawWeights();
}

function startWeights() {
  const samples = unique(weights.map((row) => row.sample));
  fill(at("weight-sample"), samples, samples[0]);
  at("weight-sample").addEventListener("change", chooseWeights);
  at("weight-case").addEventListener("change", drawWeights);
  chooseWeights();
}

// --- stresses, order of failure, joint -------------------------------------------------------
const pathsOf = (mesh) => JOINTS.paths.filter((path) => path.sample === at("path-sample").value && (mesh === null || path.mesh === mesh));
const chosenPath = () => pathsOf(Number(at("path-mesh").value)).find((path) => path.eccentricity === at("path-direction").value);
const chosenStep = (path) => path.steps[Math.min(Number(at("path-step").value), path.steps.length - 1)];

function drawStress(path, step) {
  const x = [], y = [], colour = [], symbol = [];
  path.faces.forEach((face, k) => {
    x.push(...face.y.map((v) => 1000 * v));
    y.push(...face.x.map((v) => 1000 * v));
    colour.push(...step.shear[k]);
    symbol.push(...step.bonded[k].map((whole) => (whole ? "square" : "x")));
  });
  const trace = { x, y, mode: "markers", marker: { color: colour, symbol, size: Math.max(4, Math.min(13, 120 / Math.sqrt(x.length))), colorscale: "Viridis", cmin: 0, cmax: 1, colorbar: { title: { text: "shear / cohesion" } } }, hovertemplate: "%{marker.color:.3f}<extra></extra>" };
  chart("stress-plot", [trace], { xaxis: axis("across the locks y (mm)"), yaxis: axis("along them x (mm)", { scaleanchor: "x" }), showlegend: false });
}

function drawOrder(path, step) {
  const loads = path.steps.map((s) => s.load);
  const traces = path.faces.map((face, k) => ({ x: loads, y: path.steps.map((s) => Math.max(...s.shear[k].map((v, i) => (s.bonded[k][i] ? v : 0)))), name: `lock ${face.lock}`, mode: "lines+markers", marker: { symbol: MARKS[k % MARKS.length] }, line: { color: COLOURS[k % COLOURS.length], dash: DASHES[k % DASHES.length] } }));
  const here = { type: "line", x0: step.load, x1: step.load, y0: 0, y1: 1, line: { color: "#555555", dash: "dot" } };
  chart("order-plot", traces, { shapes: [here], xaxis: axis("load (N)"), yaxis: axis("largest shear / cohesion of the bonds", { rangemode: "tozero" }) });
  const last = path.steps[path.steps.length - 1];
  const order = path.faces.filter((face) => face.fails_from !== null).sort((a, b) => a.fails_from - b.fails_from);
  at("order-text").textContent = (order.length ? `Bonds fail first in lock ${order.map((face) => `${face.lock} (from ${short(face.fails_from)} N)`).join(", then ")}. ` : "No bond fails before the peak. ") + `${path.end}: ${short(last.load)} N.`;
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

function drawJoint(path, step) {
  const pieces = JOINTS.pieces[path.sample];
  const size = Math.max(...pieces.flatMap((p) => p.high.map((v, k) => v - p.low[k])));
  const largest = Math.max(1e-12, ...step.moved.flatMap((m) => m.slice(0, 3).map(Math.abs)));
  const scale = (Number(at("joint-scale").value) / 100) * 0.3 * size / largest;
  at("joint-factor").textContent = `× ${short(Number(scale.toPrecision(2)))}`;
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
  traces.push({ type: "scatter3d", mode: "markers", x, y, z, marker: { size: 4, color: colour, colorscale: "Viridis", cmin: 0, cmax: 1, colorbar: { title: { text: "shear / cohesion" } } }, hovertemplate: "%{marker.color:.3f}<extra></extra>" });
  const scene = { aspectmode: "data", camera: { eye: { x: 1.5, y: -1.5, z: 1.2 } }, xaxis: { title: { text: "x (m)" } }, yaxis: { title: { text: "y (m)" } }, zaxis: { title: { text: "z (m)" } } };
  chart("joint-plot", traces, { scene, margin: { l: 0, r: 0, t: 0, b: 0 }, showlegend: false, uirevision: path.sample });
}

function drawPath() {
  const path = chosenPath();
  if (!path) return;
  at("path-step").max = path.steps.length - 1;
  const step = chosenStep(path);
  at("path-load").textContent = `${short(step.load)} N`;
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

function startPaths() {
  const samples = unique(JOINTS.paths.map((path) => path.sample));
  for (const id of ["stresses", "joint"]) at(id).hidden = samples.length === 0;
  if (!samples.length) return;
  fill(at("path-sample"), samples, samples[0]);
  at("path-sample").addEventListener("change", choosePath);
  at("path-mesh").addEventListener("change", choosePath);
  at("path-direction").addEventListener("change", choosePath);
  for (const id of ["path-step", "joint-scale", "joint-body"]) at(id).addEventListener("input", drawPath);
  choosePath();
}

// --- law, models -----------------------------------------------------------------------------
function drawLaw() {
  const own = JOINTS.law[at("law-sample").value];
  const names = { law: labelOf("law"), safe: labelOf("safe"), closed: { name: "closed form", colour: "#555555" }, half: { name: "(n - 1) / 2", colour: "#000000" } };
  const traces = Object.keys(names).map((key, k) => ({ x: own.locks, y: own[key], name: names[key].name, connectgaps: true, mode: "lines+markers", marker: { symbol: MARKS[k] }, line: { color: names[key].colour, dash: DASHES[k] } }));
  chart("law-plot", traces, { xaxis: axis("locks n", { dtick: 2 }), yaxis: axis("V / T0", { rangemode: "tozero" }) });
}

function startLaw() {
  const samples = Object.keys(JOINTS.law);
  at("law").hidden = samples.length === 0;
  if (!samples.length) return;
  fill(at("law-sample"), samples, samples[0]);
  at("law-sample").addEventListener("change", drawLaw);
  drawLaw();
}

function drawModels() {
  const own = cases.filter((row) => row.difference_to_static !== null && row.variant === "reference" && row.model !== "static" && row.model !== "limit");
  at("models").hidden = own.length === 0;
  const traces = unique(own.map((row) => row.model)).map((model) => {
    const rows = own.filter((row) => row.model === model);
    return { x: rows.map((r) => r.name), y: rows.map((r) => 100 * r.difference_to_static), name: labelOf(model).name, mode: "markers", marker: { symbol: markOf(model), color: labelOf(model).colour, size: 8 } };
  });
  chart("model-plot", traces, { margin: { l: 60, r: 20, t: 20, b: 150 }, legend: { orientation: "h", y: 1.1 }, xaxis: axis("", { tickangle: -60 }), yaxis: axis("difference to the static model (%)") });
}

startCurves();
startWeights();
startPaths();
startLaw();
drawModels();
