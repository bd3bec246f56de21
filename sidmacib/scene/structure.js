// A structure in three dimensions, and how it moves: what is drawn in the report and in the explorer.
// The page has the controls of structure.html.j2, a choice #structure-view, and labelOf(model).
const VIEWS = { // from where, in directions
  "from the left": [-1.0, -1.7, 0.8], "from the right": [1.0, -1.7, 0.8], "along x": [-2.3, 0, 0.1],
  "along y": [0, -2.3, 0.1], "from above": [0, -0.01, 2.4], "from below": [-0.5, -1.2, -1.6],
};
const WHOLE = 0.15; // of the structure's size: the largest displacement that is drawn
const LONGEST = 1; // of the mean diagonal of free blocks: the line of the largest resultant
const NEXT_TO_NOTHING = 0.01; // of the largest resultant: interfaces that carry less are grey, without a line
const HALF_VIEW = Math.tan(Math.PI / 8); // Plotly sees an angle of 45 degrees from below to above
const NUMBERS = 130; // px beside the box around the structure, for the numbers of its axes
const TURN = 0.25; // rad: the largest rotation that is drawn, as larger ones would distort blocks
const BELOW = 0.14; // of the plot: room for the scale of colours
const STEEP = 2.5; // times the height from which flat structures are seen
const APART = 0.6; // how far blocks are drawn from each other at most, see spread()
const ARROW = 0.8; // of the diagonal of large free blocks: the largest load, and the largest reaction
const HEAD = 0.25; // of an arrow's length: its head
const MOST_LABELS = 12; // of reactions that are written beside their arrows
const MARKED = "#d55e00", FORCE = "#0072b2";
const ARROWS = { load: "#009e73", permanent: "#cc79a7", reaction: "#e69f00" };
const THRUST = "#000000";
const AT_REST = [0, 0, 0, 0, 0, 0];

const named = (rows, column) => new Map((rows || []).map((row) => [row[column], row]));
const plus = (p, q, factor = 1) => p.map((v, k) => v + factor * q[k]);
const toXyz = ([x, y, z]) => ({ x, y, z });
const norm = (p) => Math.hypot(...p);
const extent = (points) => [0, 1, 2].map((k) => points.reduce(([lo, hi], p) => [Math.min(lo, p[k]), Math.max(hi, p[k])], [Infinity, -Infinity]));

// --- what is drawn ---------------------------------------------------------------------------
let drawn = null; // what is chosen, prepared for drawing
let stopMotion = null; // ends the animation

// `row`, `ofBlocks`, `ofInterfaces`: rows of the tables of structures, blocks and interfaces.
// `loads`, `reactions`, `thrust`: see forces.py of this folder. `history`: times (s), and at each a displacement (m) and a
// rotation vector (rad) of each block.
function preparedStructure(row, shape, ofBlocks, ofInterfaces, { loads = null, reactions = [], thrust = [], history = null } = {}) {
  if (!shape) return { row, shape };
  const blocks = named(ofBlocks, "block"), interfaces = named(ofInterfaces, "interface");
  for (const each of shape.interfaces) each.ofLock = each.between.some((k) => shape.blocks[k].with !== k);
  const middle = middleOf(shape.blocks.flatMap((block) => block.points));
  const moves = shape.blocks.map((block) => {
    const own = blocks.get(block.name), apart = plus(middleOf(shape.blocks[block.with].points), middle, -1);
    if (!own || own.move_x_m === null) return { centre: [0, 0, 0], moved: AT_REST, apart };
    return { apart, centre: [own.x_m, own.y_m, own.z_m], moved: [own.move_x_m, own.move_y_m, own.move_z_m, own.turn_x, own.turn_y, own.turn_z] };
  });
  const points = shape.blocks.flatMap((block) => block.points);
  const size = diagonal(points);
  if (history) moves.forEach((move, k) => { move.path = history.moves.map((frame) => frame[k]); });
  const largest = Math.max(...shape.blocks.flatMap((block, k) => block.points.map((p) => norm(plus(shifted(p, moves[k].centre, moves[k].moved, 1), p, -1)))));
  const turn = Math.max(...moves.map((move) => norm(move.moved.slice(3))));
  const moving = largest > 1e-12 * size;
  const shown = moving ? Math.min((WHOLE * size) / largest, turn > 0 ? TURN / turn : Infinity) : 0;
  const factor = history ? 1 : shown;
  const shares = history ? history.times.map((_, k) => k / (history.times.length - 1)) : [factor];
  const far = shares.flatMap((share) => shape.blocks.flatMap((block, k) => block.points.map((p) => displaced(p, moves[k], share))));
  const motion = [...blocks.values()].map((each) => each.motion).find((each) => each) || null;
  const forces = forcesOf(shape, interfaces), arrows = arrowsOf(row, shape, loads, reactions);
  const ranges = extent([...points, ...far, ...arrows.flatMap(({ tail, tip }) => [tail, tip])]);
  return { row, shape, interfaces, moves, size, factor, motion, ranges, forces, arrows, thrust, history };
}

const place = (p, move, factor) => plus(displaced(p, move, factor), move.apart, spread());

// Where a point is: by a motion that is magnified, or at a share of the time that a path takes.
function displaced(p, { centre, moved, path }, factor) {
  if (!path) return shifted(p, centre, moved, factor);
  const now = path[Math.round(factor * (path.length - 1))], turn = now.slice(3), angle = norm(turn);
  const arm = plus(p, centre, -1);
  const here = angle > 0 ? turned(arm, turn.map((v) => v / angle), angle) : arm;
  return here.map((v, k) => v + centre[k] + now[k]);
}

// How far blocks are drawn from each other, over how far their centroids are from the middle.
const spread = () => (APART * Number(at("structure-apart").value)) / 100;

const middleOf = (points) => extent(points).map(([lo, hi]) => (lo + hi) / 2);

// A point of an interface moves as the mean of the two blocks there do.
function placeBetween(p, [below, above], moves, factor) {
  return plus(place(p, moves[below], factor), place(p, moves[above], factor)).map((v) => v / 2);
}

const diagonal = (points) => norm(extent(points).map(([lo, hi]) => hi - lo));

function meanDiagonal(shape) {
  const free = shape.blocks.filter((block) => !block.fixed);
  return free.reduce((sum, block) => sum + diagonal(block.points), 0) / free.length;
}

// Large blocks count more than locks.
function largeDiagonal(shape) {
  const sizes = shape.blocks.filter((block) => !block.fixed).map((block) => diagonal(block.points));
  return sizes.reduce((sum, size) => sum + size ** 2, 0) / sizes.reduce((sum, size) => sum + size, 0);
}

// A vector turned by an angle (rad) about an axis of length 1.
function turned(v, axis, angle) {
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const along = axis.reduce((sum, a, k) => sum + a * v[k], 0), across = cross(axis, v);
  return v.map((each, k) => each * Math.cos(angle) + across[k] * Math.sin(angle) + axis[k] * along * (1 - Math.cos(angle)));
}

// Those components of a force that are more than next to nothing, a line each.
function components(force) {
  const told = ["x", "y", "z"].map((name, k) => [name, force[k]]).filter(([, v]) => Math.abs(v) > NEXT_TO_NOTHING * norm(force));
  return told.map(([name, v]) => `R${name} ${short(v)} N`).join("<br>");
}

// Loads and reactions as arrows, each kind with its own scale; `at`: the end that stays in place.
function arrowsOf(row, shape, loads, reactions) {
  const longest = ARROW * largeDiagonal(shape), numbers = new Map(shape.blocks.map((block, k) => [block.name, k]));
  const tilt = row.tilt_degrees, load = row.load_N;
  const found = [];
  const add = (kind, list, forceOf, textOf, labelFor = (force) => `${short(norm(force))} N`) => {
    const most = Math.max(0, ...list.map((one) => norm(forceOf(one))));
    for (const one of list) {
      const force = forceOf(one), along = force.map((v) => (longest * v) / most);
      const [tail, tip] = one.point ? [plus(one.at, along, -1), one.at] : [one.at, plus(one.at, along)];
      if (most > 0) found.push({ kind, tail, tip, anchor: one.at, block: numbers.get(one.block), text: textOf(one, force), label: one.point ? labelFor(force) : "" });
    }
  };
  const loaded = (one, force) => `${one.block}<br>load ${short(norm(force))} N`;
  if (loads && loads.axis && tilt !== null && tilt !== undefined) add("load", loads.variable, (one) => turned(one.force, loads.axis, (tilt * Math.PI) / 180), (one, force) => `${one.block}<br>weight ${short(norm(force))} N`);
  else if (loads && load !== null) add("load", loads.variable, (one) => one.force.map((v) => v * load), loaded);
  if (loads) add("permanent", loads.permanent, (one) => one.force, (one, force) => `${one.block}<br>permanent load ${short(norm(force))} N`);
  const told = reactions.map((one) => ({ ...one, block: one.support, at: one.at && norm(plus(one.at, one.middle, -1)) <= one.reach ? one.at : one.middle, point: true }));
  add("reaction", told, (one) => one.force, (one, force) => `${one.support}<br>reaction ${short(norm(force))} N<br>Rx ${short(force[0])} N, Ry ${short(force[1])} N, Rz ${short(force[2])} N`, components);
  return found;
}

function forcesOf(shape, interfaces) {
  const found = [], longest = LONGEST * meanDiagonal(shape);
  for (const each of shape.interfaces) {
    const row = interfaces.get(each.name);
    if (!row) continue;
    const force = [row.force_x_N, row.force_y_N, row.force_z_N];
    const point = row.at_x_m === null ? null : [row.at_x_m, row.at_y_m, row.at_z_m];
    const acts = point !== null && norm(plus(point, each.middle, -1)) <= diagonal(each.points);
    found.push({ each, row, force, size: norm(force), acts, point: acts ? point : each.middle });
  }
  const most = Math.max(0, ...found.map((one) => one.size));
  const felt = found.filter((one) => one.size > NEXT_TO_NOTHING * most);
  return felt.map((one) => ({ ...one, half: one.force.map((v) => (0.5 * longest * v) / most) }));
}

// --- drawing ---------------------------------------------------------------------------------
const newMesh = () => ({ x: [], y: [], z: [], i: [], j: [], k: [], text: [] });
const newLines = () => ({ x: [], y: [], z: [], text: [] });

function addMesh(mesh, points, triangles, text) {
  const first = mesh.x.length;
  for (const [x, y, z] of points) { mesh.x.push(x); mesh.y.push(y); mesh.z.push(z); mesh.text.push(text); }
  for (const [i, j, k] of triangles) { mesh.i.push(first + i); mesh.j.push(first + j); mesh.k.push(first + k); }
}

function addLine(lines, points, text = "") {
  for (const p of [...points, [null, null, null]]) { lines.x.push(p[0]); lines.y.push(p[1]); lines.z.push(p[2]); lines.text.push(text); }
}

const closedLine = (points, edge) => [...edge, edge[0]].map((number) => points[number]);
const solid = (mesh, more) => ({ type: "mesh3d", flatshading: true, hoverinfo: "text", lighting: { ambient: 0.75, diffuse: 0.5, specular: 0.05 }, ...mesh, ...more });
const lineTrace = (lines, line, more) => ({ type: "scatter3d", mode: "lines", line, hoverinfo: "skip", ...lines, ...more });

function blockTraces({ shape, moves, factor }, share) {
  const free = newMesh(), fixed = newMesh(), edges = newLines();
  shape.blocks.forEach((block, k) => {
    const points = block.points.map((p) => place(p, moves[k], share * factor));
    addMesh(block.fixed ? fixed : free, points, block.triangles, block.fixed ? `${block.name}, fixed` : block.name);
    for (const edge of block.edges) addLine(edges, closedLine(points, edge));
  });
  const how = at("structure-blocks").value, shown = how !== "outlines", whole = how === "solid";
  return [
    solid(fixed, { color: "#6b7280", opacity: whole ? 1 : 0.35 }),
    solid(free, { color: "#c9ced8", opacity: whole ? 1 : shown ? 0.3 : 0, hoverinfo: shown ? "text" : "skip" }),
    lineTrace(edges, whole ? { color: "#3a4150", width: 2.5 } : { color: "#7a8394", width: 1.5 }),
  ];
}

// A joint that is marked: a lock's flanks give way with their joint.
const gives = (each, row, way) => !each.ofLock && row.mode.includes(way);

function toldOf(each, row) {
  if (!row) return each.name;
  const used = row.utilisation === null ? "" : `<br>utilisation ${short(row.utilisation)}`;
  return `${each.name}: ${row.mode}${used}<br>compression ${short(row.normal_N)} N, shear ${short(row.shear_N)} N<br>torsion ${short(row.torsion_Nm)} N m, bending ${short(row.bending_Nm)} N m`;
}

function interfaceTraces({ row, shape, interfaces, moves, factor, forces }, share) {
  const carrying = new Set(forces.map((one) => one.row));
  const known = newMesh(), unknown = newMesh(), marked = newLines(), intensity = [];
  for (const each of shape.interfaces) {
    const own = interfaces.get(each.name);
    const points = each.points.map((p) => placeBetween(p, each.between, moves, share * factor));
    const used = own && own.utilisation !== null && carrying.has(own);
    addMesh(used ? known : unknown, points, each.triangles, toldOf(each, own));
    if (used) intensity.push(...each.triangles.map(() => own.utilisation));
    if (each.name === row.first_interface) for (const edge of each.edges) addLine(marked, closedLine(points, edge));
  }
  const bar = { orientation: "h", x: 0.5, y: 0, yanchor: "bottom", len: 0.7, thickness: 12, title: { text: "utilisation", side: "top" } };
  return [
    solid(known, { intensity, intensitymode: "cell", colorscale: "Viridis", cmin: 0, cmax: 1, colorbar: bar, showscale: intensity.length > 0, lighting: { ambient: 1, diffuse: 0 } }),
    solid(unknown, { color: "#9aa0aa" }),
    lineTrace(marked, { color: MARKED, width: 9 }),
  ];
}

function forceTraces({ forces, moves, factor }, share) {
  const lines = newLines(), acting = newLines(), hinges = newLines(), slides = newLines(), elsewhere = newLines();
  if (at("structure-forces").checked) {
    for (const { each, row, size, acts, point, half } of forces) {
      const here = placeBetween(point, each.between, moves, share * factor);
      addLine(lines, [plus(here, half, -1), plus(here, half)]);
      const text = `${short(size)} N<br>${toldOf(each, row)}${acts ? "" : "<br>acts outside the interface; drawn at its centroid"}`;
      addLine(!acts ? elsewhere : gives(each, row, "hinge") ? hinges : acting, [here], text);
      if (acts && gives(each, row, "slides")) addLine(slides, [here], text);
    }
  }
  return [
    lineTrace(lines, { color: FORCE, width: 5 }),
    lineTrace(acting, {}, { mode: "markers", marker: { size: 2, color: FORCE }, hoverinfo: "text" }),
    lineTrace(hinges, {}, { mode: "markers", name: "hinges", marker: { size: 5, color: FORCE }, hoverinfo: "text" }),
    lineTrace(slides, {}, { mode: "markers", name: "slides", marker: { size: 5, color: "#d55e00", symbol: "diamond" }, hoverinfo: "text" }),
    lineTrace(elsewhere, {}, { mode: "markers", marker: { size: 4, color: FORCE, symbol: "circle-open" }, hoverinfo: "text" }),
  ];
}

// An arrow: its shaft, and four lines that spread from its tip.
function addArrow(lines, tail, tip) {
  const along = plus(tip, tail, -1), smallest = along.map(Math.abs).indexOf(Math.min(...along.map(Math.abs)));
  const side = [0, 1, 2].map((k) => (k === smallest ? 1 : 0));
  const across = side.map((v, k) => v - (along[k] * along[smallest]) / norm(along) ** 2);
  addLine(lines, [tail, tip]);
  for (let quarter = 0; quarter < 4; quarter += 1) {
    const out = turned(across, along.map((v) => v / norm(along)), (quarter * Math.PI) / 2);
    addLine(lines, [tip, plus(plus(tip, along, -HEAD), out, (0.4 * HEAD * norm(along)) / norm(across))]);
  }
}

function arrowTraces({ arrows, moves, factor }, share) {
  const shown = at("structure-loads").checked;
  const few = arrows.filter(({ kind }) => kind === "reaction").length <= MOST_LABELS;
  return Object.entries(ARROWS).flatMap(([kind, color]) => {
    const beside = arrows.some((one) => one.kind === kind && one.tail[2] > one.tip[2]) ? "top center" : "bottom center"; // beyond tails
    const lines = newLines(), ends = newLines(), label = [];
    for (const arrow of shown ? arrows.filter((one) => one.kind === kind) : []) {
      const moved = plus(place(arrow.anchor, moves[arrow.block], share * factor), arrow.anchor, -1);
      const [tail, tip] = [plus(arrow.tail, moved), plus(arrow.tip, moved)];
      addArrow(lines, tail, tip);
      addLine(ends, [tail], arrow.text);
      label.push(few ? arrow.label : "", "");
    }
    return [
      lineTrace(lines, { color, width: 6 }),
      lineTrace({ ...ends, text: label, hovertext: ends.text }, {}, { mode: "markers+text", textposition: beside, textfont: { color: "#000000" }, marker: { size: 3, color }, hoverinfo: "text", name: kind }),
    ];
  });
}

function thrustTraces({ thrust, moves, factor }, share) {
  const lines = newLines();
  if (at("structure-thrust").checked) for (const line of thrust) addLine(lines, line.map(({ point, between }) => placeBetween(point, between, moves, share * factor)));
  return [lineTrace(lines, { color: THRUST, width: 6 }, { name: "thrust line" })];
}

// What is flat is looked at more from above.
function seenFrom([x, y, z]) {
  const name = at("structure-view").value, view = VIEWS[name];
  return name.startsWith("from the") && z < 0.5 * Math.min(x, y) ? [view[0], view[1], STEEP * view[2]] : view;
}

// How far the eye must be to see all of a box, in the unit of its sides; `width`, `height`: px.
function distance(sides, view, width, height) {
  const half = [width, height].map((v) => (HALF_VIEW * Math.max(v - NUMBERS, 0.5 * v)) / height);
  const [x, y, z] = view.map((v) => v / norm(view)), level = Math.hypot(x, y);
  const corners = [-0.5, 0.5].flatMap((i) => [-0.5, 0.5].flatMap((j) => [-0.5, 0.5].map((k) => [i * sides[0], j * sides[1], k * sides[2]])));
  return Math.max(...corners.map(([a, b, c]) => {
    const across = Math.abs(b * x - a * y) / level, up = Math.abs(c * level - ((a * x + b * y) * z) / level);
    return a * x + b * y + c * z + Math.max(across / half[0], up / half[1]);
  }));
}

function drawStructure() {
  const share = Number(at("structure-motion").value) / 100;
  tellMotion(share);
  if (!drawn.shape) return Promise.resolve();
  const ranges = drawn.ranges.map(([lo, hi]) => [-1, 1].map((side) => (lo + hi) / 2 + side * ((1 + spread()) * (hi - lo) / 2 + 0.02 * drawn.size)));
  const lengths = ranges.map(([lo, hi]) => hi - lo), most = Math.max(...lengths);
  const ratio = lengths.map((v) => v / most), view = seenFrom(lengths);
  const plot = at("structure-plot"), away = distance(ratio, view, plot.clientWidth, plot.clientHeight * (1 - BELOW));
  const eye = view.map((v) => (away * v) / norm(view));
  const side = (name, k) => ({ title: { text: `${name} (m)` }, range: ranges[k], showbackground: false, showspikes: false, zeroline: false, nticks: Math.max(2, Math.round(6 * ratio[k])) });
  const scene = { aspectmode: "manual", aspectratio: toXyz(ratio), dragmode: "orbit", camera: { eye: toXyz(eye) }, domain: { y: [BELOW, 1] }, xaxis: side("x", 0), yaxis: side("y", 1), zaxis: side("z", 2) };
  const traces = [...blockTraces(drawn, share), ...interfaceTraces(drawn, share), ...forceTraces(drawn, share), ...arrowTraces(drawn, share), ...thrustTraces(drawn, share)];
  return chart("structure-plot", traces, { scene, margin: { l: 0, r: 0, t: 0, b: 0 }, showlegend: false, uirevision: `${drawn.row.structure} ${at("structure-view").value}` });
}

// --- words -----------------------------------------------------------------------------------
function tellMotion(share) {
  const moves = Boolean(drawn.shape) && drawn.factor > 0;
  for (const part of ["motion", "play"]) at(`structure-${part}`).disabled = !moves;
  at("structure-what").textContent = drawn.history ? "Time" : "Magnify motion";
  if (drawn.history) {
    const { times } = drawn.history;
    at("structure-factor").textContent = `${short(times[Math.round(share * (times.length - 1))])} s`;
    return;
  }
  const size = share > 0 ? `× ${short(Number((share * drawn.factor).toPrecision(2)))} (${drawn.motion})` : "undeformed";
  at("structure-factor").textContent = moves ? size : "no motion from this model";
}

const firstFailure = (row) => (row.first_failure_tilt_degrees === null ? `${short(row.first_failure_load_N)} N` : `${short(row.first_failure_tilt_degrees)}°`);

const reasonOf = (row, column) => (row[column] === null ? null : row[column].replace(`${row.model}: `, ""));

function orderOf({ row, interfaces }) {
  if (row.refused !== null) return `No answer of the ${labelOf(row.model).name}: ${reasonOf(row, "refused")}.`;
  if (row.error !== null) return `No result from the ${labelOf(row.model).name}: ${reasonOf(row, "error")}.`;
  const all = [...(interfaces || [])].map(([, own]) => own);
  const bonded = all.filter((own) => own.cohesion_Pa > 0 || own.tensile_strength_Pa > 0);
  const used = row.most_used_interface === null ? "" : ` Highest utilisation: ${row.most_used_interface}.`;
  if (!all.length) return "This model gives no interface forces.";
  if (!bonded.length) return `All interfaces are dry; there are no bonds.${used}`;
  if (row.first_interface === null) return `This model gives no first bond failure.${used}`;
  const broken = bonded.filter((own) => own.fails_at !== null).sort((one, other) => one.fails_at - other.fails_at);
  const others = broken.map((own) => `${own.interface} (${Math.round(100 * own.fails_at)} %)`);
  const first = `First bond failure: ${row.first_interface} (outlined in red) at ${firstFailure(row)}.`;
  return `${first} ${others.length > 1 ? `Order of failure, in % of the peak load: ${others.join(", ")}.` : "No other bond fails before the peak."}`;
}

// What the caption says of the longest line.
function tellLongest() {
  const most = drawn.shape ? drawn.forces.reduce((one, other) => (other.size > (one ? one.size : 0) ? other : one), null) : null;
  at("structure-longest").textContent = most ? `Largest: ${short(most.size)} N at ${most.each.name}. Open dots: the force acts outside the interface and is drawn at its centroid.` : "";
}

// --- controls --------------------------------------------------------------------------------
// Draw what is prepared, at rest.
function showStructure(prepared) {
  stopMotion();
  drawn = prepared;
  at("structure-motion").value = 0;
  at("structure-plot").hidden = !drawn.shape;
  at("structure-loads").parentElement.hidden = !drawn.shape || !drawn.arrows.length;
  at("structure-thrust").parentElement.hidden = !drawn.shape || !drawn.thrust.length;
  tellLongest();
  drawStructure();
}

function startDrawing() {
  fill(at("structure-view"), Object.keys(VIEWS), "from the left");
  for (const part of ["motion", "apart"]) at(`structure-${part}`).addEventListener("input", drawStructure);
  for (const part of ["view", "blocks", "forces", "loads", "thrust"]) at(`structure-${part}`).addEventListener("change", drawStructure);
  stopMotion = player(at("structure-play"), at("structure-motion"), drawStructure, () => (drawn.history ? 1000 * drawn.history.times.at(-1) : 0));
}
