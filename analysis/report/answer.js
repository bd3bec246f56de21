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
    const line = { law: "dot", safe: "solid" }[model] || "solid";
    const width = model === "safe" ? 3 : 1.6;
    return [vmTrace({ ...vmOf(rows), name: label.name, mode: label.engine ? "markers" : "lines", marker: { symbol: markOf(model), size: 8, color: label.colour }, line: { color: label.colour, dash: line, width }, hovertemplate: hover })];
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
  const joint = JOINTS.sizes.find((row) => row.sample === sample);
  at("answer-size").textContent = `${sample}: ${joint.locks} locks, a × b = ${short(1000 * joint.a_m)} × ${short(1000 * joint.b_m)} mm, strength of a lock T0 = ${short(joint.T0_N)} N, friction ${short(joint.friction)}`;
  at("answer-text").textContent = `Mesh ${short(1000 * ANSWER.mesh)} mm. A rule is unsafe where its line lies outside the capacity by the detailed models.${published.length ? "" : " The paper has no peak for this joint."}`;
}

onSample(drawAnswer);
