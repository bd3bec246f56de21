"use strict";
// A structure of studies/: what is chosen goes to the server, which sends older requests of this
// page away. Everything shown is from one answer, and grey while something else is chosen.
const PAUSE = 80; // ms without a change, until the server is asked
const [structure, model] = [at("structure"), at("model")];
const labelOf = (name) => ({ name: [...model.options].find((each) => each.value === name).text });
const firstValues = () => JSON.parse(structure.selectedOptions[0].dataset.first);
let latest = 0; // number of the last change
let shown = null; // the answer on the page
let pause = null; // the timer of the next request

function arrange() {
  at("about").textContent = structure.selectedOptions[0].dataset.words;
  for (const slider of sliders) slider.closest("[data-of], select").hidden = !(slider.options || slider.id in firstValues());
}

function changed() {
  latest += 1;
  at("answer").ariaBusy = "true";
  clearTimeout(pause);
  pause = setTimeout(ask, PAUSE);
}

async function ask() {
  const number = latest;
  const answer = await post("structure", { page: PAGE, number, values: values(), kept: state.kept }, "structure");
  if (answer && number === latest) show(answer);
}

function show(answer) {
  shown = answer;
  for (const name of ["words", "yaml", "link"]) at(name).textContent = answer[name];
  const titles = answer.head.map((title) => Object.assign(document.createElement("th"), { scope: "col", textContent: title }));
  at("lines").tHead.rows[0].replaceChildren(...titles);
  at("lines").tBodies[0].replaceChildren(...answer.rows.map(tableRow));
  showStructure(preparedStructure(answer.row, answer.shape, answer.blocks, answer.interfaces, answer));
  at("structure-order").textContent = orderOf(drawn);
  at("answer").ariaBusy = "false";
  showComparison(answer);
  arrived(answer);
  for (const act of waiting.splice(0)) act();
}

at("reset").addEventListener("click", () => {
  put(firstValues());
  at("notes").textContent = "";
  moved("");
});
at("save").addEventListener("click", () => {
  const keep = () => save(shown.yaml, "application/yaml", `${structure.value}.yaml`);
  if (at("answer").ariaBusy === "true") waiting.push(keep);
  else keep();
});
startDrawing();
structure.addEventListener("input", () => put(firstValues()));
const moved = listen(arrange, changed);
