// The report's charts of joints, all of the joint that is chosen at the top of the page.
const JOINTS = DATA.joints;
const chosenSample = () => at("sample").value;

// Draws now, and again whenever another joint is chosen.
function onSample(drawn) {
  at("sample").addEventListener("change", drawn);
  drawn();
}

fill(at("sample"), JOINTS.samples, DATA.answer.sample, (name) => JOINTS.words[name]);
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
  const sample = chosenSample();
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
  const published = capacity.filter((r) => r.model === "published" && r.variant === "3dec" && r.sample === sample && r.mesh_m === mesh);
  line(published, "published (3DEC)", { mode: "markers", marker: { symbol: "star-open", size: 13, color: "#000000" } });
  vmChart("curve-plot", traces, { why: `Nothing is chosen, or none of what is chosen has an answer for ${sample} here.` });
  const peaks = traces.map((t) => `${t.name} ${short(Math.max(...t.x))} N and ${short(Math.max(...t.y))} N m`);
  at("curve-text").textContent = `${sample}, mesh ${mesh} m. Largest V and M: ${peaks.join("; ") || "nothing chosen"}.`;
}

function fillSources() {
  const own = unique(rules.filter((row) => row.sample === chosenSample()).map((row) => row.weights_from));
  fill(at("curve-source"), own, own[0], (model) => labelOf(model).name);
}

function startCurves() {
  const meshes = JOINTS.meshes.filter((mesh) => plain.some((row) => row.mesh_m === mesh));
  fill(at("curve-mesh"), meshes, meshes[0]);
  fill(at("curve-variant"), unique(plain.map((row) => row.variant)), "reference");
  const reductions = unique(rules.map((row) => row.reduction));
  fill(at("curve-reduction"), reductions, reductions.includes("half") ? "half" : reductions[0], (name) => JOINTS.rules[name] || name);
  boxes(at("curve-models"), models, models, drawCurves, (model) => labelOf(model).name);
  boxes(at("curve-options"), unique(rules.map((row) => row.option)), ["option4"], drawCurves, (option) => JOINTS.options[option].name);
  for (const id of ["curve-mesh", "curve-reduction", "curve-source", "curve-friction", "curve-variant"]) at(id).addEventListener("change", drawCurves);
  onSample(() => { fillSources(); drawCurves(); });
}

// --- weights ---------------------------------------------------------------------------------
// The paper's weights beside those of a case in pure shear, where it has any: as printed, and swapped.
function publishedWeights(rows) {
  const { sample, mesh_m: mesh, eccentricity_over_a: ratio } = rows[0];
  const own = records(DATA.tables.validation).filter((row) => row.sample === sample && row.mesh_m === mesh);
  const of = (quantity) => own.find((row) => row.quantity === quantity);
  const locks = unique(rows.map((row) => row.lock)), printed = locks.map((lock) => of(`weight_lock${lock}`));
  if (ratio !== 0 || printed.some((row) => !row)) return [];
  const swapped = locks.map((lock, k) => of(`weight_lock${lock}_swapped`) || printed[k]);
  const bars = (name, values, color) => ({ type: "bar", name, y: values.map((row) => row.published), marker: { color } });
  return [bars("published, as printed", printed, "#000000"), bars("published, first two swapped", swapped, "#9aa0aa")];
}

function drawWeights() {
  const rows = weights.filter((row) => row.case === at("weight-case").value && row.variant === "reference");
  const traces = unique(rows.map((row) => row.model)).map((model) => {
    const own = rows.filter((row) => row.model === model);
    return { type: "bar", name: labelOf(model).name, x: own.map((r) => `lock ${r.lock} (${r.block})`), y: own.map((r) => r.weight), marker: { color: labelOf(model).colour } };
  });
  const published = rows.length ? publishedWeights(rows).map((trace) => ({ ...trace, x: traces[0].x })) : [];
  const all = [...published, ...traces].map((trace) => ({ ...trace, text: trace.y.map((v) => v.toFixed(2)), textangle: traces.length > 3 ? -90 : 0, textposition: "outside", cliponaxis: false }));
  chart("weight-plot", all, { barmode: "group", xaxis: axis(""), yaxis: axis("weight: shear / T0", { range: [0, 1.25 * Math.max(1, ...all.flatMap((trace) => trace.y))] }), why: "No model of this study gives stresses of this joint, from which weights follow." });
  at("weight-text").textContent = all.map((t) => `${t.name}: ${t.y.map(short).join(", ")}`).join("; ") + (published.length ? ". Equilibrium requires the first two published weights to be swapped." : rows.length ? ". The paper has no weights for this case." : "");
}

function chooseWeights() {
  const own = unique(weights.filter((row) => row.sample === chosenSample() && row.variant === "reference").map((row) => row.case));
  fill(at("weight-case"), own, own[0]);
  drawWeights();
}

function startWeights() {
  at("weight-case").addEventListener("change", drawWeights);
  onSample(chooseWeights);
}

// --- convergence -----------------------------------------------------------------------------
function drawConvergence() {
  const sample = chosenSample(), model = at("mesh-model").value;
  const own = capacity.filter((r) => r.sample === sample && r.model === model && r.variant === "reference" && r.load_N !== null);
  const meshes = unique(own.map((r) => r.mesh_m)).sort((a, b) => a - b);
  const direction = (r) => (r.eccentricity_over_a === "inf" ? "torsion" : String(r.eccentricity_over_a));
  const reference = own.filter((r) => r.mesh_m === meshes[0]).sort((a, b) => rank(a) - rank(b));
  const directions = reference.map(direction), finest = new Map(reference.map((r) => [direction(r), r.load_N]));
  const traces = meshes.map((mesh, k) => {
    const rows = own.filter((r) => r.mesh_m === mesh && finest.has(direction(r))), colour = COLOURS[k % COLOURS.length];
    const share = (r, part) => (100 * part) / finest.get(direction(r)), beside = 0.12 * (k - (meshes.length - 1) / 2);
    const bars = { type: "data", array: rows.map((r) => share(r, (r.mesh_error || 0) * r.load_N)), thickness: 1.5, width: 5, color: colour };
    return { x: rows.map((r) => directions.indexOf(direction(r)) + beside), y: rows.map((r) => share(r, r.load_N)), name: `mesh ${short(1000 * mesh)} mm`, mode: "markers", error_y: bars, marker: { symbol: MARKS[k % MARKS.length], size: 9, color: colour }, text: rows.map((r) => `e/a ${direction(r)}: ${direction(r) === "torsion" ? `${short(r.torque_Nm)} N m` : `${short(r.shear_N)} N`}`), hovertemplate: "%{text}<br>%{y:.2f} %" };
  });
  const ticks = { tickvals: directions.map((_, place) => place), ticktext: directions, zeroline: false };
  chart("mesh-plot", meshes.length > 1 ? traces : [], { xaxis: axis("e / a", ticks), yaxis: axis("load / finest mesh (%)"), why: "Only one mesh was run: there is nothing to compare." });
  const errors = own.filter((r) => r.mesh_error !== null && r.mesh_m === ANSWER_MESH);
  const worst = errors.reduce((one, other) => (one && one.mesh_error >= other.mesh_error ? one : other), null);
  at("mesh-text").textContent = `Load / load at the finest mesh, for each load direction. Bars: estimated mesh error.${worst ? ` At ${ANSWER_MESH} m it is at most ${(100 * worst.mesh_error).toFixed(1)} % (${worst.case}).` : ""}`;
}

const ANSWER_MESH = Math.min(...JOINTS.meshes);

function startConvergence() {
  const own = models.filter((model) => !["law", "safe", "characteristic", "design"].includes(model));
  fill(at("mesh-model"), own, own.includes("static") ? "static" : own[0], (model) => labelOf(model).name);
  at("mesh-model").addEventListener("change", drawConvergence);
  onSample(drawConvergence);
}

// --- law, models -----------------------------------------------------------------------------
function drawLaw() {
  const own = JOINTS.law[chosenSample()];
  at("law").hidden = !own;
  if (!own) return;
  const names = { law: labelOf("law"), safe: labelOf("safe"), closed: { name: "closed form", colour: "#555555" }, half: { name: "(n − 1)/2", colour: "#000000" } };
  const traces = Object.keys(names).map((key, k) => ({ x: own.locks, y: own[key], name: names[key].name, connectgaps: true, mode: "lines+markers", marker: { symbol: MARKS[k] }, line: { color: names[key].colour, dash: DASHES[k] } }));
  chart("law-plot", traces, { xaxis: axis("number of locks n", { dtick: 2 }), yaxis: axis("V / T0", { rangemode: "tozero" }) });
}

function drawModels() {
  const own = cases.filter((row) => row.difference_to_static !== null && row.variant === "reference" && row.model !== "static" && row.model !== "limit");
  at("models").hidden = own.length === 0;
  const traces = unique(own.map((row) => row.model)).map((model) => {
    const rows = own.filter((row) => row.model === model);
    return { x: rows.map((r) => r.name), y: rows.map((r) => 100 * r.difference_to_static), name: labelOf(model).name, mode: "markers", marker: { symbol: markOf(model), color: labelOf(model).colour, size: 8 } };
  });
  chart("model-plot", traces, { margin: { l: 60, r: 20, t: 30, b: 20 }, legend: { orientation: "h", y: 1.02, yanchor: "bottom" }, xaxis: axis("", { tickangle: -60 }), yaxis: axis("difference (%)") });
}

startCurves();
startWeights();
startConvergence();
onSample(drawLaw);
drawModels();
// The report's first screen: what the models give and what the rules promise, in one plot.
const ANSWER = DATA.answer;
const HALF = "half", BAND = "rgba(0, 114, 178, 0.22)";

// Rows of one V-M curve, from pure shear to pure torsion.
function answerRows(sample, chosen) {
  const rows = capacity.filter((row) => row.sample === sample && row.mesh_m === ANSWER.mesh && row.load_N !== null && chosen(row));
  return rows.sort((a, b) => rank(a) - rank(b));
}

const vmOf = (rows, factor = () => 1) => ({ shear: rows.map((r) => r.shear_N * factor(r)), torque: rows.map((r) => r.torque_Nm * factor(r)) });
const hover = "V = %{x:.1f} N<br>M = %{y:.3f} N m";

// Between the load less and more its mesh error: there and back.
function bandOf(rows, name) {
  const known = rows.filter((row) => row.mesh_error !== null);
  if (!known.length) return [];
  const low = vmOf(known, (r) => 1 - r.mesh_error), high = vmOf(known, (r) => 1 + r.mesh_error);
  const around = { shear: [...low.shear, ...high.shear.reverse()], torque: [...low.torque, ...high.torque.reverse()] };
  return [vmTrace({ ...around, name, mode: "lines", fill: "toself", fillcolor: BAND, line: { width: 0 }, hoverinfo: "skip" })];
}

function modelTraces(sample) {
  const own = models.filter((model) => model !== "limit");
  return own.flatMap((model) => {
    const rows = answerRows(sample, (r) => r.model === model && r.variant === "reference"), label = labelOf(model);
    if (!rows.length) return [];
    const dash = model === "law" ? "dot" : "solid", width = model === "safe" ? 3 : 1.6;
    return [vmTrace({ ...vmOf(rows), name: label.name, mode: label.engine ? "markers" : "lines", marker: { symbol: markOf(model), size: 8, color: label.colour }, line: { color: label.colour, dash, width }, hovertemplate: hover })];
  });
}

function halfTrace(sample) {
  const how = ANSWER.half[sample];
  if (!how) return [];
  const rows = answerRows(sample, (r) => r.reduction === HALF && r.option === how.option && String(r.friction) === String(how.friction) && r.weights_from === ANSWER.leading[sample]);
  return rows.length ? [vmTrace({ ...vmOf(rows), name: `(n − 1)/2, ${JOINTS.options[how.option].name}`, mode: "lines", line: { color: "#d55e00", dash: "dash", width: 3 }, hovertemplate: hover })] : [];
}

function pointTrace(rows, name, symbol) {
  return rows.length ? [vmTrace({ ...vmOf(rows), name, mode: "markers", marker: { symbol, size: 14, color: "#000000", line: { width: 2 } }, cliponaxis: false, hovertemplate: hover })] : [];
}

function drawAnswer() {
  const sample = chosenSample(), leading = ANSWER.leading[sample];
  const carried = answerRows(sample, (r) => r.model === leading && r.variant === "reference");
  const published = answerRows(sample, (r) => r.model === "published" && r.variant === "3dec");
  const traces = [
    ...(leading ? bandOf(carried, `mesh error of ${labelOf(leading).name}`) : []), ...halfTrace(sample), ...modelTraces(sample),
    ...pointTrace(published, "published (3DEC)", "star-open"),
  ];
  vmChart("answer-plot", traces, { why: `No model has an answer for ${sample} at a mesh of ${short(1000 * ANSWER.mesh)} mm: for the reasons see "Failed cases".` });
  const joint = JOINTS.sizes[sample];
  at("answer-size").textContent = `${sample}: ${joint.locks} locks, a × b = ${short(1000 * joint.a_m)} × ${short(1000 * joint.b_m)} mm, strength of a lock T0 = ${short(joint.T0_N)} N, friction ${short(joint.friction)}`;
  at("answer-text").textContent = `Mesh ${short(1000 * ANSWER.mesh)} mm. A rule is unsafe where its line lies outside the capacity by the detailed models.${published.length ? "" : " The paper has no peak for this joint."}`;
}

onSample(drawAnswer);
