"use strict";
// What the report and the explorer share: how charts look, on a screen, in the dark and on paper.
const CHART_FONT_SIZE = 13, PAPER_WIDTH = 660, PAPER_HEIGHT = 340; // px: of a chart on A4 with its margins
const CHART_CONFIG = { displaylogo: false, responsive: true, showSendToCloud: false, plotlyServerURL: "" }; // by default every plot offers to upload itself to a cloud
const LIGHT = { ink: "#1c1f24", grid: "#dddddd", zero: "#999999", back: "#ffffff", instead: {} };
// `instead`: colours of traces that would not be seen in the dark.
const DARK = { ink: "#e6e9ef", grid: "#3a4150", zero: "#7a8394", back: "#14171c", instead: { "#000000": "#e6e9ef", "#555555": "#aab2c0", "#0072b2": "#4a9ede", "#8a6d00": "#c9a93c", "#2f4b7c": "#8ba3d6" } };
const SNAPSHOT_AFTER = 900; // ms without a change, until a picture is taken of a view in three dimensions
const at = (id) => document.getElementById(id);
const axis = (title, more) => ({ title: { text: title }, ...more });
const darkScreen = matchMedia("(prefers-color-scheme: dark)"), paper = matchMedia("print");
const charts = new Map(); // by id: traces and layout, as they were given
const snapshots = new Map(); // by id: the timer of the next
let printing = false;

const theme = () => (darkScreen.matches && !printing ? DARK : LIGHT);

function recoloured(value, instead) {
  if (Array.isArray(value) || value === null || typeof value !== "object") return instead[value] || value;
  return Object.fromEntries(Object.entries(value).map(([key, each]) => [key, /^(color|line|marker|error_y|textfont)$/.test(key) ? recoloured(each, instead) : each]));
}

const onAxes = (layout, { grid, zero }) => Object.fromEntries(Object.entries(layout).map(([key, value]) => [key, /^[xyz]axis\d*$/.test(key) ? { automargin: true, gridcolor: grid, zerolinecolor: zero, ...value } : key === "scene" ? onAxes(value, { grid, zero }) : value]));

function styled(traces, { why, ...layout }, look) {
  const empty = why && !traces.length ? { annotations: [{ text: why.replace(/(.{40,}?) /g, "$1<br>"), showarrow: false, xref: "paper", yref: "paper", x: 0.5, y: 0.5, font: { size: 15 } }], xaxis: { visible: false }, yaxis: { visible: false } } : {};
  const whole = { margin: { l: 60, r: 20, t: 20, b: 50 }, font: { size: CHART_FONT_SIZE, color: look.ink }, legend: { orientation: "h", yref: "container", y: 0, yanchor: "bottom" }, paper_bgcolor: look.back, plot_bgcolor: look.back, showlegend: traces.length > 0, ...layout, ...empty };
  return [traces.map((trace) => recoloured(trace, look.instead)), onAxes(whole, look)];
}

function draw(id) {
  const { traces, layout } = charts.get(id);
  const [themed, whole] = styled(traces, layout, theme());
  if (printing) return Plotly.react(id, themed, { ...whole, width: PAPER_WIDTH, height: PAPER_HEIGHT, autosize: false }, CHART_CONFIG);
  return Plotly.react(id, themed, { ...whole, width: undefined, height: undefined, autosize: true }, CHART_CONFIG);
}

function chart(id, traces, layout) {
  charts.set(id, { traces, layout });
  if (layout.scene) takeSnapshot(id);
  return draw(id);
}

// A curve or point: its shear (N), torque (N m), name and whatever else Plotly has for a trace.
const vmTrace = ({ shear, torque, ...style }) => ({ x: shear, y: torque, ...style });

function vmChart(id, traces, layout) {
  chart(id, traces, { xaxis: axis("shear V (N)", { rangemode: "tozero" }), yaxis: axis("torque M (N m)", { rangemode: "tozero" }), ...layout });
}

// Browsers may leave a view in three dimensions out of what they print: a picture takes its place.
function takeSnapshot(id) {
  clearTimeout(snapshots.get(id));
  snapshots.set(id, setTimeout(async () => {
    const { traces, layout } = charts.get(id), plot = at(id);
    if (!plot.clientWidth || printing) return;
    const [data, whole] = styled(traces, layout, LIGHT);
    const scene = { ...whole.scene, camera: plot.layout.scene.camera || whole.scene.camera };
    const source = await Plotly.toImage({ data, layout: { ...whole, scene }, config: CHART_CONFIG }, { format: "png", width: 900, height: 640 });
    let picture = plot.nextElementSibling;
    if (!picture || !picture.classList.contains("printed")) {
      picture = Object.assign(document.createElement("img"), { className: "printed", alt: plot.getAttribute("aria-label") });
      plot.after(picture);
    }
    picture.src = source;
  }, SNAPSHOT_AFTER));
}

function redraw(now) {
  if (printing === now && now) return;
  printing = now;
  for (const [id, { layout }] of charts) if (!(printing && layout.scene)) draw(id);
}

darkScreen.addEventListener("change", () => redraw(printing));
addEventListener("beforeprint", () => redraw(true));
addEventListener("afterprint", () => redraw(false));
paper.addEventListener("change", ({ matches }) => redraw(matches));
