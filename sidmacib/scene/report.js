// The page of a structure: the model that is drawn, and its tables.
const DATA = JSON.parse(document.getElementById("data").textContent);
const MODELS = DATA.structures.flatMap(({ models, ...structure }) => models.map((each) => ({ ...each, ...structure })));
const labelOf = (model) => MODELS.find((each) => each.row.model === model);
const REACTIONS = ["support", "Rx (N)", "Ry (N)", "Rz (N)", "size (N)", "x (m)", "y (m)", "z (m)"];
const INTERFACES = [
  ["interface", "interface"], ["compression (N)", "normal_N"], ["shear (N)", "shear_N"], ["torsion (N m)", "torsion_Nm"], ["bending (N m)", "bending_Nm"],
  ["eccentricity", "eccentricity"], ["utilisation", "utilisation"], ["mode", "mode"], ["bonded", "bonded_share"],
];

function reactionRows({ reactions }) {
  const rows = reactions.map(({ support, force, at }) => [support, ...force, norm(force), ...(at || [null, null, null])]);
  if (rows.length < 2) return rows;
  const sum = [0, 1, 2].map((k) => reactions.reduce((total, { force }) => total + force[k], 0));
  return [...rows, ["sum", ...sum, norm(sum), null, null, null]];
}

// Forces below a millionth of the largest are rounding errors.
function withoutNoise(rows, columns) {
  const least = 1e-6 * Math.max(0, ...rows.flatMap((row) => columns.map((k) => Math.abs(row[k]))));
  return rows.map((row) => row.map((value, k) => (columns.includes(k) && Math.abs(value) < least ? 0 : value)));
}

function fillTable(id, head, rows) {
  const line = document.createElement("tr");
  line.append(...head.map((title) => Object.assign(document.createElement("th"), { scope: "col", textContent: title })));
  at(id).tHead.replaceChildren(line);
  at(id).tBodies[0].replaceChildren(...rows.map(tableRow));
  at(`${id}-part`).hidden = rows.length === 0;
}

function showModel() {
  const told = labelOf(at("structure-model").value);
  showStructure(preparedStructure({ structure: "", ...told.row }, told.shape, told.blocks, told.interfaces, told));
  at("structure-order").textContent = orderOf(drawn);
  fillTable("reactions", REACTIONS, withoutNoise(reactionRows(told), [1, 2, 3, 4]));
  fillTable("interfaces", INTERFACES.map(([title]) => title), told.interfaces.map((row) => INTERFACES.map(([, column]) => row[column])));
}

fill(at("structure-model"), MODELS.map(({ row }) => row.model), MODELS[0].row.model, (model) => labelOf(model).name);
at("structure-model").addEventListener("change", showModel);
startDrawing();
showModel();
