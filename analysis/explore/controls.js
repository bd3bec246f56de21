"use strict";
// What both pages of the explorer share: their sliders, undo, what is kept for comparison, copies.
const GESTURE = 1000; // ms: later changes of the same slider are undone apart
const sliders = [...at("sliders").querySelectorAll("[data-value]")]; // and choices
const waiting = []; // what is done as soon as the answer is that of the sliders

const typed = (slider) => at(`${slider.id}-value`); // the field beside a slider; a choice has none
const values = () => Object.fromEntries(sliders.filter((slider) => !slider.closest("[hidden]")).map(({ id, value }) => [id, value]));

// --- undo: each step is an entry of the browser's history --------------------------------------
let state = { step: (history.state && history.state.step) || 0, values: values(), kept: JSON.parse(at("sliders").dataset.kept) };
let last = state.step; // the newest step
let gesture = {}; // the slider that was moved last, and when

// What the sliders have now, as a new step unless the same slider, `id`, is still being moved.
function remember(id, kept) {
  const now = performance.now(), before = state, goesOn = id && gesture.id === id && now - gesture.at < GESTURE;
  const told = ({ values: given, kept: other }) => JSON.stringify([given, other]);
  if (told(before) === told({ values: values(), kept })) return;
  gesture = { id, at: now };
  state = { step: before.step + (goesOn ? 0 : 1), values: values(), kept };
  if (goesOn) return;
  history.replaceState(before, ""); // where a drag ended
  history.pushState(state, "");
  last = state.step;
}

function go(steps) {
  if (state.step + steps < 0 || state.step + steps > last) return;
  history.replaceState(state, "");
  history.go(steps);
}

// So that the address opens the same.
const arrived = ({ link }) => history.replaceState(state, "", link);

function put(given) {
  for (const slider of sliders) {
    if (!(slider.id in given)) continue;
    slider.value = given[slider.id];
    if (typed(slider)) typed(slider).value = slider.value;
  }
}

function tellSteps() {
  at("undo").disabled = state.step === 0;
  at("redo").disabled = state.step === last;
  for (const name of ["swap", "forget"]) at(name).hidden = !state.kept;
}

function shortcut(event) {
  const key = event.key.toLowerCase(), slider = sliders.find((each) => typed(each) === event.target);
  if (!(event.ctrlKey || event.metaKey) || event.altKey || !["y", "z"].includes(key)) return;
  if (slider && slider.value !== event.target.value) return; // that is for the text in the field
  event.preventDefault();
  go(key === "y" || event.shiftKey ? 1 : -1);
}

// --- comparison --------------------------------------------------------------------------------
function showComparison({ kept, comparison }) {
  at("kept").hidden = !kept;
  if (kept && kept.words) at("kept-words").textContent = `Kept: ${kept.words}`;
  at("comparison").tBodies[0].replaceChildren(...comparison.map(tableRow));
}

// --- copies, listening -------------------------------------------------------------------------
async function copy(button) {
  await navigator.clipboard.writeText(at(button.dataset.copy).textContent);
  button.textContent = "Copied";
  setTimeout(() => { button.textContent = "Copy"; }, 2000);
}

// `arrange`: shows the sliders that there are; `changed`: asks the server. Returns what is to be
// called where something else than a slider changes one of them, or what is kept.
function listen(arrange, changed) {
  function moved(id, kept = state.kept) {
    arrange();
    remember(id, kept);
    update();
  }
  function update() {
    for (const slider of sliders) if (typed(slider) && document.activeElement !== typed(slider)) typed(slider).value = slider.value;
    tellSteps();
    changed();
  }
  for (const button of document.querySelectorAll("[data-copy]")) {
    button.addEventListener("click", () => {
      if (at("answer").ariaBusy === "true") waiting.push(() => copy(button));
      else copy(button);
    });
  }
  for (const slider of sliders) {
    slider.addEventListener("input", () => {
      at("notes").textContent = "";
      moved(slider.id);
    });
    typed(slider)?.addEventListener("change", (event) => {
      const field = event.target;
      at("notes").textContent = field.validity.valid && field.value !== "" ? "" : `${slider.id}: from ${field.min} to ${field.max} in steps of ${field.step}; the nearest is shown.`;
      slider.value = field.value === "" ? slider.value : field.value; // which rounds it
      field.value = slider.value;
      moved(slider.id);
    });
  }
  at("undo").addEventListener("click", () => go(-1));
  at("redo").addEventListener("click", () => go(1));
  addEventListener("keydown", shortcut);
  addEventListener("popstate", (event) => {
    if (!event.state) return;
    gesture = {};
    state = event.state;
    put(state.values);
    arrange();
    update();
  });
  at("keep").addEventListener("click", () => moved("", values()));
  at("forget").addEventListener("click", () => moved("", null));
  at("swap").addEventListener("click", () => {
    const kept = values();
    put(state.kept);
    moved("", kept);
  });
  arrange();
  update();
  return moved;
}
