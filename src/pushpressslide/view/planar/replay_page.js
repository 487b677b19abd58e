// The run seen from above: draw(time, frame) draws one moment of it.
const canvas = document.getElementById("view"), g = canvas.getContext("2d");
const N = D.pose.length;
const rad = a => a * Math.PI / 180;
const apply = (X, p) => { const c = Math.cos(rad(X[2])), s = Math.sin(rad(X[2]));
  return [X[0] + c * p[0] - s * p[1], X[1] + s * p[0] + c * p[1]]; };
const trace = D.pose.map((X, k) => apply(X, D.axles[k]));
// what rests in the stage of a frame, and the outline of what moves
const sceneOf = k => D.scenes[N ? D.scene[k] : 0];
const all = [...D.scenes.flatMap(s => [...s.path, ...s.obstacles.flatMap(o => o.corners)]), ...D.tips.flat().filter(p => p[0] !== null),
  ...D.goals.flat(), ...D.pose.flatMap((X, k) => sceneOf(k).outline.map(p => apply(X, p))),
  ...D.bases.flatMap(b => [[b[0] - 0.1, b[1] - 0.1], [b[0] + 0.1, b[1] + 0.1]])];
const low = [0, 1].map(i => Math.min(...all.map(p => p[i])) - 0.04), high = [0, 1].map(i => Math.max(...all.map(p => p[i])) + 0.04);
let scale = 1, shift = [0, 0];
const at = p => [shift[0] + (D.mirror ? -1 : 1) * scale * p[0], shift[1] - scale * p[1]];

function fit() {
  const ratio = window.devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
  canvas.width = w * ratio; canvas.height = h * ratio; g.setTransform(ratio, 0, 0, ratio, 0, 0);
  scale = Math.min(w / (high[0] - low[0]), h / (high[1] - low[1]));
  shift = [w / 2 - (D.mirror ? -1 : 1) * scale * (low[0] + high[0]) / 2, h / 2 + scale * (low[1] + high[1]) / 2];
  bar.redraw();
}
function line(points, color, width, dash = [], close = false, fill = null) {
  if (!points.length) return;
  g.beginPath(); points.forEach((p, i) => g[i ? "lineTo" : "moveTo"](...at(p))); if (close) g.closePath();
  if (fill) { g.fillStyle = fill; g.fill(); }
  g.setLineDash(dash); g.strokeStyle = color; g.lineWidth = width; g.lineJoin = "round"; g.stroke(); g.setLineDash([]);
}
function body(outline, X, color, width, dash, fill) { line(outline.map(p => apply(X, p)), color, width, dash, true, fill); }
function dot(p, r, fill, edge) {
  g.beginPath(); g.arc(...at(p), r, 0, 2 * Math.PI); g.fillStyle = fill; g.fill();
  if (edge) { g.strokeStyle = edge; g.lineWidth = 1.2; g.stroke(); }
}
function grid() {
  for (let i = 0; i < 2; i++) for (let k = Math.ceil(low[i] * 10); k <= high[i] * 10; k++) {
    const a = i ? [low[0], k / 10] : [k / 10, low[1]], b = i ? [high[0], k / 10] : [k / 10, high[1]];
    line([a, b], k === 0 ? "#c9ced4" : "#eceff2", 1);
  }
  const a = at([low[0], low[1]]), wide = 0.1 * scale, x = D.mirror ? a[0] - wide - 8 : a[0] + 8;
  g.strokeStyle = g.fillStyle = "#59636e"; g.lineWidth = 2; g.beginPath(); g.moveTo(x, a[1] - 8); g.lineTo(x + wide, a[1] - 8); g.stroke();
  g.font = "12px sans-serif"; g.fillText("0.1 m", x, a[1] - 13);
}
function arrow(tail, head, color) {
  const a = at(tail), b = at(head), t = Math.atan2(b[1] - a[1], b[0] - a[0]), r = 9;
  g.strokeStyle = g.fillStyle = color; g.lineWidth = 3; g.beginPath(); g.moveTo(...a);
  g.lineTo(b[0] - 0.7 * r * Math.cos(t), b[1] - 0.7 * r * Math.sin(t)); g.stroke();
  g.beginPath(); g.moveTo(...b);
  for (const d of [-0.42, 0.42]) g.lineTo(b[0] - r * Math.cos(t + d), b[1] - r * Math.sin(t + d));
  g.closePath(); g.fill();
}
function cone(apex, yaw) {
  const length = 0.12, half = Math.atan(D.friction);
  const edge = s => [apex[0] + length * Math.cos(yaw + s * half), apex[1] + length * Math.sin(yaw + s * half)];
  line([apex, edge(1), edge(-1)], "rgba(230,159,0,0.8)", 1, [], true, "rgba(230,159,0,0.25)");
}
function tip(i, k, X) {
  const p = D.tips[i][k], f = D.forces[i][k], size = Math.hypot(...f), load = D.loads[i][k], contact = D.contacts[i][k];
  if (p[0] === null) return;
  const r = Math.max(3, D.radii[i] * scale);
  let tail = p;
  if (contact === "top") {
    if (load > 0.1) dot(p, D.friction * load * D.forceScale * scale, "rgba(230,159,0,0.25)", "rgba(230,159,0,0.8)");
    dot(p, r, load > 0.1 ? "#cc79a7" : "rgba(204,121,167,0.2)", "#3b3f45");
  } else {
    dot(p, r, "#3b3f45");
    if (contact !== null && size > 0.1) {
      const yaw = rad(X[2] + contact);
      tail = [p[0] + D.radii[i] * Math.cos(yaw), p[1] + D.radii[i] * Math.sin(yaw)];
      cone(tail, yaw);
    }
  }
  if (size > 0.1) arrow(tail, [tail[0] + D.forceScale * f[0], tail[1] + D.forceScale * f[1]], "#a8387d");
  const text = size > 0.1 || load > 0.1 ? Math.hypot(size, load).toFixed(1) + " N" : "", at0 = at(p);
  g.fillStyle = "#1f2328"; g.font = "12px sans-serif"; g.fillText(text, at0[0] + r + 5, at0[1] - r - 2);
}
function draw(time, k) {
  g.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight);
  grid();
  const scene = sceneOf(k);
  for (const b of D.bases) dot(b, 0.09 * scale, "#dde3ea", "#6b7280");
  if (D.region.length) line(D.region, "#6b7280", 1.5, [], true);
  for (const o of scene.obstacles) { line(o.corners, "#6b7280", 1.5, [], true, "#b9bec6");
    const m = at([0, 1].map(i => o.corners.reduce((s, c) => s + c[i] / o.corners.length, 0)));
    g.fillStyle = "#1f2328"; g.font = "12px sans-serif"; g.textAlign = "center"; g.fillText(o.name, m[0], m[1] + 4); g.textAlign = "left"; }
  for (const goal of D.goals) line(goal, "#009e73", 2, [], true, "rgba(0,158,115,0.12)");
  line(scene.path, "#222", 1.6, [6, 5]);
  if (!N) return;
  const X = D.pose[k];
  if (D.moving[k]) body(scene.outline, D.reference[k], "#8a8a8a", 1.2, [4, 4], null);
  line(trace.slice(D.scene.indexOf(D.scene[k]), k + 1), "#0072b2", 2);
  body(scene.outline, X, "#8a5a1e", 2, [], "rgba(217,140,64,0.55)");
  const front = scene.outline.reduce((m, p) => Math.max(m, Math.hypot(...p)), 0);
  line([[X[0], X[1]], apply(X, [0.45 * front, 0])], "#8a5a1e", 2);
  dot(trace[k], 5, "#fff", "#0072b2"); dot(trace[k], 2, "#0072b2");
  D.tips.forEach((_, i) => tip(i, k, X));
}
window.onresize = fit;
