// The report's structures: which one is drawn, and what its models say.
const STRUCTURES = DATA.structures;
const structureRows = records(DATA.tables.structures);
const interfacesOf = byCase(DATA.tables.interfaces);
const blocksOf = byCase(DATA.tables.blocks);

function byCase(table) {
  const found = new Map();
  for (const row of records(table)) {
    const key = `${row.model}/${row.case}`;
    if (!found.has(key)) found.set(key, []);
    found.get(key).push(row);
  }
  return found;
}

// --- what is chosen --------------------------------------------------------------------------
function chosenRow() {
  const value = (part) => at(`structure-${part}`).value;
  return structureRows.find((row) => row.structure === value("name") && row.load === value("load") && row.variant === value("variant") && row.model === value("model"));
}

function prepared(row) {
  const known = STRUCTURES.cases.find((each) => each.structure === row.structure && each.load === row.load && each.variant === row.variant);
  const key = `${row.model}/${row.case}`;
  return preparedStructure(row, known.shape === null ? null : STRUCTURES.shapes[known.shape], blocksOf.get(key), interfacesOf.get(key), { loads: known.loads, ...STRUCTURES.forces[key] });
}

// --- words -----------------------------------------------------------------------------------
const percent = (share) => (share === null ? null : Number((100 * share).toFixed(2)));
const COLUMNS = [
  ["model", (row) => labelOf(row.model).name], ["load (N)", (row) => row.load_N], ["load / weight", (row) => row.load_over_weight],
  ["tilt (°)", (row) => row.tilt_degrees], ["governed by", (row) => row.counts], ["peak (N)", (row) => row.peak_N], ["peak (°)", (row) => row.peak_tilt_degrees],
  ["difference to static (%)", (row) => percent(row.difference_to_static)], ["mesh error (%)", (row) => percent(row.mesh_error)],
  ["failure mode", (row) => row.mode], ["first bond failure", (row) => row.first_interface], ["at", (row) => (row.first_interface === null ? null : firstFailure(row))],
  ["reason", (row) => row.because], ["highest utilisation", (row) => row.most_used_interface], ["no answer", (row) => reasonOf(row, "refused")], ["no result", (row) => reasonOf(row, "error")],
];

function tellModels() {
  const rows = structureRows.filter((row) => ["structure", "load", "variant"].every((part) => row[part] === drawn.row[part]));
  const shown = COLUMNS.filter(([, read], k) => k < 1 || rows.some((row) => read(row) !== null));
  const head = document.createElement("tr");
  head.append(...shown.map(([title]) => Object.assign(document.createElement("th"), { scope: "col", textContent: title })));
  at("structure-models").tHead.replaceChildren(head);
  at("structure-models").tBodies[0].replaceChildren(...rows.map((row) => {
    const line = tableRow(shown.map(([, read]) => read(row)));
    if (row === drawn.row) line.setAttribute("aria-current", "true");
    return line;
  }));
}

function tellStructure() {
  const answers = drawn.row.load_N !== null || drawn.row.tilt_degrees !== null;
  const hasRoom = !answers || STRUCTURES.told.includes(`${drawn.row.model}/${drawn.row.case}`);
  at("structure-order").textContent = drawn.shape && hasRoom ? orderOf(drawn) : "This page has no room for this case; see its tables and its ParaView files in the results folder.";
  tellModels();
}

// --- controls --------------------------------------------------------------------------------
function chooseStructure() {
  for (const part of ["load", "variant", "model"]) {
    const own = unique(structureRows.filter((row) => row.structure === at("structure-name").value).map((row) => row[part]));
    const before = at(`structure-${part}`).value;
    const usual = own.includes("static") ? "static" : own[0];
    fill(at(`structure-${part}`), own, own.includes(before) ? before : usual, part === "model" ? (name) => labelOf(name).name : undefined);
  }
  chooseCase();
}

function chooseCase() {
  showStructure(prepared(chosenRow()));
  tellStructure();
}

function startStructures() {
  const names = unique(structureRows.map((row) => row.structure));
  startDrawing();
  fill(at("structure-name"), names, names[0]);
  at("structure-name").addEventListener("change", chooseStructure);
  for (const part of ["load", "variant", "model"]) at(`structure-${part}`).addEventListener("change", chooseCase);
  chooseStructure();
}

startStructures();
