// What the report and the explorer share beside charts: numbers, choices, rows, files, motions.
const short = (value) => (typeof value === "number" ? Number(value.toPrecision(4)).toString() : String(value));

function fill(select, values, chosen, text = short) {
  select.replaceChildren(...values.map((value) => new Option(text(value), value, value === chosen, value === chosen)));
}

function tableRow(row) {
  const line = document.createElement("tr");
  for (const value of row) {
    const cell = document.createElement("td");
    cell.textContent = value === null ? "" : short(value);
    if (typeof value === "number") cell.className = "number";
    line.append(cell);
  }
  return line;
}

function save(text, type, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = name;
  link.click();
  URL.revokeObjectURL(link.href);
}

// A point (m) of a piece that moves by a displacement (m) and a small rotation (rad) about its centre.
function shifted(p, centre, moved, scale) {
  const r = p.map((v, k) => v - centre[k]);
  const w = moved.slice(3);
  const turn = [w[1] * r[2] - w[2] * r[1], w[2] * r[0] - w[0] * r[2], w[0] * r[1] - w[1] * r[0]];
  return p.map((v, k) => v + scale * (moved[k] + turn[k]));
}
