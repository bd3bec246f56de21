"use strict";
// What both pages of the explorer share: their sliders, what they ask the server, and copies.
const BROKEN = "The server does not answer. Start it again with make explore.";
const SUPERSEDED = 204;
const PAGE = crypto.randomUUID();
const sliders = [...at("sliders").querySelectorAll("[data-value]")]; // and choices
const waiting = []; // what is done as soon as the answer is that of the sliders

const typed = (slider) => at(`${slider.id}-value`); // the field beside a slider; a choice has none
const values = () => Object.fromEntries(sliders.map((slider) => [slider.id, Number(slider.value)]));

async function post(kind, asked, what) {
  try {
    const headers = { "Content-Type": "application/json" };
    const response = await fetch(`/${kind}`, { method: "POST", headers, body: JSON.stringify(asked) });
    if (response.status === SUPERSEDED) return null;
    if (response.ok) {
      at("problem").textContent = "";
      return await response.json();
    }
    at("problem").textContent = `This ${what} could not be computed: ${response.status} ${response.statusText}.`;
  } catch {
    at("problem").textContent = BROKEN;
  }
  return null;
}

async function copy(button) {
  await navigator.clipboard.writeText(at(button.dataset.copy).textContent);
  button.textContent = "Copied";
  setTimeout(() => { button.textContent = "Copy"; }, 2000);
}

function listen(changed) {
  for (const button of document.querySelectorAll("[data-copy]")) {
    button.addEventListener("click", () => {
      if (at("answer").ariaBusy === "true") waiting.push(() => copy(button));
      else copy(button);
    });
  }
  for (const slider of sliders) {
    slider.addEventListener("input", () => {
      at("notes").textContent = "";
      changed();
    });
    typed(slider)?.addEventListener("change", (event) => {
      const field = event.target;
      at("notes").textContent = field.validity.valid && field.value !== "" ? "" : `${slider.id}: from ${field.min} to ${field.max} in steps of ${field.step}; the nearest is shown.`;
      slider.value = field.value === "" ? slider.value : field.value; // which rounds it
      field.value = slider.value;
      changed();
    });
  }
}
