// The state of the page in its address: the section, then each control that was changed, as in
// #stresses&sample=n5. A copied address opens the page in that state, also from a file.
const changed = new Set(); // ids of controls
let section = ""; // id of the section that was gone to

const controls = () => [...document.querySelectorAll("header select, main select, main input")].filter(({ id, type }) => id && type !== "file");
const stateOf = (control) => (control.type === "checkbox" ? String(control.checked) : control.value);

function writeAddress() {
  const state = new URLSearchParams(controls().filter(({ id }) => changed.has(id)).map((control) => [control.id, stateOf(control)]));
  history.replaceState(null, "", `#${[section, String(state)].filter(Boolean).join("&")}`);
}

// In the order of the page, as a choice may decide what others there are.
function readAddress() {
  const parts = location.hash.slice(1).split("&");
  section = parts[0].includes("=") ? "" : parts.shift();
  const state = new URLSearchParams(parts.join("&"));
  for (const control of controls()) {
    const value = state.get(control.id);
    if (value === null || (control.options && ![...control.options].some((option) => option.value === value))) continue;
    if (control.type === "checkbox") control.checked = value === "true";
    else control.value = value;
    for (const kind of ["input", "change"]) control.dispatchEvent(new Event(kind, { bubbles: true }));
  }
  if (section && parts.length && at(section)) at(section).scrollIntoView();
}

document.addEventListener("change", ({ target }) => {
  if (!controls().includes(target)) return;
  changed.add(target.id);
  writeAddress();
});
// A link to a section keeps the state.
addEventListener("hashchange", () => {
  if (location.hash.includes("=")) readAddress();
  else { section = location.hash.slice(1); writeAddress(); }
});
readAddress();
