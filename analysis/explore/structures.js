"use strict";
// A structure of studies/: what is chosen goes to the server, which sends older requests of this
// page away. Everything shown is from one answer, and grey while something else is chosen.
const PAUSE = 80; // ms without a change, until the server is asked
const [structure, model] = [at("structure"), at("model")];
const labelOf = (name) => ({ name: [...model.options].find((each) => each.value === name).text });
const firstValues = () => JSON.parse(structure.selectedOptions[0].dataset.first);
const isPart = (slider) => slider.id in firstValues(); // of the structure
let latest = 0; // number of the last change
let latestFile = 0; // and of the last file
let shown = null; // the answer on the page
let pause = null; // the timer of the next request

function chosen() {
  const own = sliders.filter(isPart).map((slider) => [slider.id, Number(slider.value)]);
  return { structure: structure.value, model: model.value, ...Object.fromEntries(own) };
}

function changed() {
  latest += 1;
  at("answer").ariaBusy = "true";
  at("about").textContent = structure.selectedOptions[0].dataset.words;
  for (const slider of sliders) {
    slider.parentElement.hidden = !isPart(slider);
    if (document.activeElement !== typed(slider)) typed(slider).value = slider.value;
  }
  clearTimeout(pause);
  pause = setTimeout(ask, PAUSE);
}

async function ask() {
  const number = latest;
  const answer = await post("structure", { page: PAGE, number, values: chosen() }, "structure");
  if (answer && number === latest) show(answer);
}

function show(answer) {
  shown = answer;
  for (const name of ["words", "unit", "yaml", "link"]) at(name).textContent = answer[name];
  at("lines").tBodies[0].replaceChildren(...answer.lines.map(tableRow));
  showStructure(preparedStructure(answer.row, answer.shape, answer.blocks, answer.interfaces, answer));
  at("structure-order").textContent = orderOf(drawn);
  at("answer").ariaBusy = "false";
  history.replaceState(null, "", answer.link); // so that the address opens the same structure
  for (const act of waiting.splice(0)) act();
}

function asInFile() {
  const first = firstValues();
  for (const slider of sliders.filter(isPart)) slider.value = first[slider.id];
  at("notes").textContent = "";
  changed();
}

structure.addEventListener("change", asInFile);
at("reset").addEventListener("click", asInFile);
model.addEventListener("change", changed);
at("save").addEventListener("click", () => {
  const keep = () => save(shown.yaml, "application/yaml", `${structure.value}.yaml`);
  if (at("answer").ariaBusy === "true") waiting.push(keep);
  else keep();
});
// --- files: the server makes a page of them, which is opened ----------------------------------
async function inBase64(file) {
  const url = await new Promise((done, failed) => {
    const reader = new FileReader();
    reader.addEventListener("load", () => done(reader.result));
    reader.addEventListener("error", () => failed(reader.error));
    reader.readAsDataURL(file);
  });
  return { name: file.name, data: url.slice(url.indexOf(",") + 1) };
}

async function openFiles(files) {
  if (!files.length) return;
  at("notes").textContent = `Computing ${[...files].map((file) => file.name).join(", ")} …`;
  const sent = await Promise.all([...files].map(inBase64));
  const answer = await post("file", { page: `${PAGE}f`, number: ++latestFile, values: { files: sent } }, "file");
  at("notes").textContent = "";
  if (answer && answer.page) location.assign(answer.page);
  else if (answer) at("problem").textContent = answer.error;
}

at("open").addEventListener("change", () => openFiles(at("open").files));
addEventListener("dragover", (event) => event.preventDefault());
addEventListener("drop", (event) => { event.preventDefault(); openFiles(event.dataTransfer.files); });
startDrawing();
listen(changed);
changed();
