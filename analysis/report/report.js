// What all parts of the report share, and its tables. All data are in the page; it works offline.
const DATA = JSON.parse(document.getElementById("data").textContent);
const COLOURS = DATA.series;
const MARKS = ["circle-open", "x", "square-open", "diamond-open", "triangle-up-open"];
const DASHES = ["solid", "dash", "dot", "dashdot", "longdash"];
const unique = (values) => [...new Set(values)];
const records = (table) => table.rows.map((row) => Object.fromEntries(table.columns.map((name, k) => [name, row[k]])));
const labelOf = (model) => DATA.labels[model];

// A cell of a table in words, and its number in the unit of its heading.
function shownCell(column, value, { times }) {
  if (typeof value === "number") return times * value;
  if (value === "inf") return column.startsWith("eccentricity") ? "torsion" : "∞";
  return (DATA.words[column] || {})[value] || value;
}

function boxes(fieldset, names, chosen, onchange, text = (name) => name) {
  for (const name of names) {
    const label = document.createElement("label");
    const box = document.createElement("input");
    box.type = "checkbox";
    box.id = `${fieldset.id}-${name}`;
    box.value = name;
    box.checked = chosen.includes(name);
    box.addEventListener("change", onchange);
    label.append(box, ` ${text(name)}`);
    fieldset.append(label);
  }
  fieldset.hidden = names.length === 0;
}

const ticked = (fieldset) => [...fieldset.querySelectorAll("input:checked")].map((box) => box.value);

// --- tables ----------------------------------------------------------------------------------
let sorted = { column: null, down: false };

function shownRows() {
  const table = DATA.tables[at("table-name").value];
  const words = at("table-filter").value.toLowerCase();
  const heads = DATA.headings[at("table-name").value];
  const said = (value, k) => `${value} ${shownCell(table.columns[k], value, heads[k])}`.toLowerCase();
  const rows = table.rows.filter((row) => !words || row.some((value, k) => said(value, k).includes(words)));
  if (sorted.column !== null) {
    const key = (row) => (row[sorted.column] === "inf" ? Infinity : row[sorted.column]);
    const compare = (a, b) => (a === null) - (b === null) || (typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b)));
    rows.sort((a, b) => compare(key(a), key(b)) * (sorted.down ? -1 : 1));
  }
  return { columns: table.columns, heads, rows };
}

function drawTable() {
  const { columns, heads, rows } = shownRows();
  const head = document.createElement("tr");
  heads.forEach(({ title, meaning }, k) => {
    const cell = document.createElement("th");
    cell.scope = "col";
    cell.ariaSort = sorted.column === k ? (sorted.down ? "descending" : "ascending") : "none";
    const button = document.createElement("button");
    button.type = "button";
    button.title = meaning;
    button.textContent = title + (sorted.column === k ? (sorted.down ? " ▼" : " ▲") : "");
    button.addEventListener("click", () => {
      sorted = { column: k, down: sorted.column === k && !sorted.down };
      drawTable();
      at("table").querySelectorAll("th button")[k].focus();
    });
    cell.append(button);
    head.append(cell);
  });
  at("table").tHead.replaceChildren(head);
  const body = rows.slice(0, 500).map((row) => tableRow(row.map((value, k) => shownCell(columns[k], value, heads[k]))));
  at("table").tBodies[0].replaceChildren(...body);
  at("table-count").textContent = `${rows.length} rows${rows.length > 500 ? "; the first 500 are shown" : ""}. Point at a heading for its meaning. Downloads keep the raw column names and SI units.`;
}

function download() {
  const { columns, rows } = shownRows();
  const safe = (value) => (/^[=+\-@\t\r]/.test(value) ? `'${value}` : value); // no formula of a spreadsheet
  const cellText = (value) => (typeof value === "string" ? safe(value) : String(value ?? ""));
  const cell = (value) => (/[",\n\r]/.test(cellText(value)) ? `"${cellText(value).replaceAll('"', '""')}"` : cellText(value));
  const text = [columns, ...rows].map((row) => row.map(cell).join(",")).join("\n") + "\n";
  save(text, "text/csv", `${at("table-name").value}.csv`);
}

function startTables() {
  at("table-name").addEventListener("change", () => { sorted = { column: null, down: false }; drawTable(); });
  at("table-filter").addEventListener("input", drawTable);
  at("table-csv").addEventListener("click", download);
  at("configuration-save").addEventListener("click", () => save(at("configuration").textContent, "application/yaml", "study.yaml"));
  drawTable();
  at("times").tBodies[0].replaceChildren(...DATA.times.map(tableRow));
  const failed = DATA.failed.rows.map(([model, name, error]) => Object.assign(document.createElement("li"), { textContent: `${name} (${model}): ${error}` }));
  at("failed").replaceChildren(...(failed.length ? failed : [Object.assign(document.createElement("li"), { textContent: "none" })]));
}

startTables();
