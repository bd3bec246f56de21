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

// A button that plays a motion: its slider goes to the end and back until the button is pressed again
// or the slider is moved. `drawn`: draws what the slider says, and returns a promise. `forward`: ms in
// which the slider goes to the end, again and again, in place of to and fro; 0: as said. Returns what
// stops it.
const PERIOD = 4000; // ms, from rest to rest
function player(button, slider, drawn, forward = () => 0) {
  let start = null; // when it was at rest
  const told = () => Object.assign(button, { textContent: start === null ? "Play" : "Stop", ariaPressed: String(start !== null) });
  const stop = () => { start = null; told(); };
  function frame(now) {
    if (start === null) return;
    const whole = forward();
    slider.value = whole ? 100 * (((now - start) / whole) % 1) : 50 * (1 - Math.cos((2 * Math.PI * (now - start)) / PERIOD));
    drawn().then(() => requestAnimationFrame(frame));
  }
  button.addEventListener("click", () => {
    if (start !== null) return stop();
    const whole = forward();
    start = performance.now() - (whole ? (whole * (Number(slider.value) % 100)) / 100 : (PERIOD * Math.acos(1 - Number(slider.value) / 50)) / (2 * Math.PI));
    told();
    return requestAnimationFrame(frame);
  });
  slider.addEventListener("input", stop);
  slider.addEventListener("keydown", (event) => event.key !== "Tab" && stop()); // also where it is at its end
  return stop;
}

// A point (m) of a piece that moves by a displacement (m) and a small rotation (rad) about its centre.
function shifted(p, centre, moved, scale) {
  const r = p.map((v, k) => v - centre[k]);
  const w = moved.slice(3);
  const turn = [w[1] * r[2] - w[2] * r[1], w[2] * r[0] - w[0] * r[2], w[0] * r[1] - w[1] * r[0]];
  return p.map((v, k) => v + scale * (moved[k] + turn[k]));
}
