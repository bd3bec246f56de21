"use strict";
// What pages ask the explorer's server, and files that are opened: it makes a page of them.
const BROKEN = "The server does not answer. Start it again with make explore.";
const SUPERSEDED = 204;
const PAGE = crypto.randomUUID();
let latestFile = 0; // number of the last files

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
  openPage({ files: await Promise.all([...files].map(inBase64)) }, [...files].map((file) => file.name).join(", "));
}

async function openPage(values, what) {
  at("notes").textContent = `Computing ${what} …`;
  const answer = await post("file", { page: `${PAGE}f`, number: ++latestFile, values }, "file");
  at("notes").textContent = "";
  if (answer && answer.page) location.assign(answer.page);
  else if (answer) at("problem").textContent = answer.error;
}

if (at("open")) {
  at("open").addEventListener("change", () => openFiles(at("open").files));
  addEventListener("dragover", (event) => event.preventDefault());
  addEventListener("drop", (event) => { event.preventDefault(); openFiles(event.dataTransfer.files); });
}

// The numbers of a file: all of them are sent when one is changed, and the page of the changed file opens.
const numbers = [...document.querySelectorAll("[data-number]")];
for (const field of numbers) {
  const slider = field.closest(".one").querySelector('[type="range"]');
  const send = () => {
    if (numbers.some((each) => Number.isNaN(each.valueAsNumber))) return;
    const asked = Object.fromEntries(numbers.map((each) => [each.dataset.number, each.valueAsNumber]));
    openPage({ of: Number(at("numbers").dataset.of), numbers: asked }, field.dataset.number);
  };
  slider.addEventListener("input", () => { field.value = slider.value; });
  for (const each of [field, slider]) each.addEventListener("change", send);
}
if (at("save-file")) at("save-file").addEventListener("click", () => save(at("save-file").dataset.text, "application/yaml", "changed.yaml"));
