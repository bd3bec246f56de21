"use strict";
// What the report and the explorer share: how charts look, and the V-M chart.
const CHART_FONT = { size: 13 };
const CHART_CONFIG = { displaylogo: false, responsive: true, showSendToCloud: false, plotlyServerURL: "" }; // by default every plot offers to upload itself to a cloud
const at = (id) => document.getElementById(id);
const axis = (title, more) => ({ title: { text: title }, gridcolor: "#dddddd", zerolinecolor: "#999999", ...more });

function chart(id, traces, layout) {
  return Plotly.react(id, traces, { margin: { l: 60, r: 20, t: 20, b: 50 }, font: CHART_FONT, legend: { orientation: "h", y: -0.2 }, paper_bgcolor: "white", plot_bgcolor: "white", showlegend: true, ...layout }, CHART_CONFIG);
}

// A curve or point: its shear (N), torque (N m), name and whatever else Plotly has for a trace.
const vmTrace = ({ shear, torque, ...style }) => ({ x: shear, y: torque, ...style });

function vmChart(id, traces, layout) {
  chart(id, traces, { xaxis: axis("shear V (N)", { rangemode: "tozero" }), yaxis: axis("torque M (N m)", { rangemode: "tozero" }), ...layout });
}
