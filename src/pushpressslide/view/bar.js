// The play bar: it owns the clock of a replay, and calls show(time, frame) whenever
// another moment of the run is to be seen.
function playBar(course, show) {
  const part = name => document.getElementById("bar-" + name);
  const play = part("play"), seek = part("seek"), speed = part("speed"), phases = part("phases");
  const count = course.time.length, end = count ? course.time[count - 1] : 0;
  let now = 0, running = false, last = null;

  function frameAt(time) {  // the last frame that is not after it
    let low = 0, high = count - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (course.time[middle] <= time + 1e-9) low = middle; else high = middle - 1;
    }
    return low;
  }
  function lastBegun(parts, key) {
    return parts.reduce((found, p) => p[key] <= now + 1e-9 ? p : found, null);
  }
  function draw() {
    seek.value = now;
    part("time").textContent = now.toFixed(2) + " of " + end.toFixed(2) + " s";
    if (!count) { part("phase").textContent = "no ticks were recorded"; return; }
    const frame = frameAt(now), phase = lastBegun(course.phases, "start"), mark = lastBegun(course.marks, "time");
    const words = [phase ? phase.name : "", mark ? mark.name : ""];
    if (frame === count - 1) words.push(course.ending);
    part("phase").textContent = words.filter(Boolean).join(", ");
    part("force").textContent = "force " + course.force.map((rows, i) =>
      (course.arms.length > 1 ? course.arms[i].replace(" arm", "") + " " : "") + rows[frame].toFixed(1) + " N").join(", ");
    part("goal").textContent = "to the goal " + course.distance[frame].toFixed(0) + " mm, " + course.turn[frame].toFixed(0) + "°";
    show(now, frame);
  }
  function setRunning(on) {
    if (on && now >= end) now = 0;
    running = on && end > 0; last = null;
    play.textContent = running ? "Pause" : now >= end && end > 0 ? "Again" : "Play";
    draw();
  }
  function goTo(time) { now = Math.min(end, Math.max(0, time)); setRunning(false); }
  function tick(stamp) {
    if (running && last !== null) {
      now = Math.min(end, now + (stamp - last) / 1000 * Number(speed.value));
      if (now >= end) setRunning(false); else draw();
    }
    last = stamp;
    requestAnimationFrame(tick);
  }
  function span(css, title, start) {
    const made = document.createElement("div");
    made.className = css; made.title = title; made.style.left = 100 * start / (end || 1) + "%";
    phases.append(made);
    return made;
  }
  const names = [];
  for (const p of course.phases) {
    const made = span("phase " + p.name, p.name, p.start);
    made.style.width = 100 * (p.end - p.start) / (end || 1) + "%";
    names.push([made, p.name]);
  }
  function nameThese() {  // where a name fits
    for (const [made, name] of names) {
      made.textContent = name;
      if (made.scrollWidth > made.clientWidth) made.textContent = "";
    }
  }
  for (const m of course.marks) {
    if (m.text) span("mark failure", m.name + ": " + m.text, m.time).textContent = "✕";
    else span("mark", m.name, m.time);
  }
  nameThese();
  window.addEventListener("resize", nameThese);
  seek.max = end;
  play.onclick = () => setRunning(!running);
  seek.oninput = () => goTo(Number(seek.value));
  window.addEventListener("keydown", event => {
    if (event.target.matches("button, select, input")) return;
    if (event.key === " ") { event.preventDefault(); setRunning(!running); }
    else if (event.key === "ArrowLeft") goTo(now - 0.1);
    else if (event.key === "ArrowRight") goTo(now + 0.1);
  });
  requestAnimationFrame(tick);
  // #t=2.5 opens the page at rest at 2.5 s
  const wanted = new URLSearchParams(location.hash.slice(1)).get("t");
  if (wanted === null) setRunning(true); else goTo(Number(wanted) || 0);
  return { redraw: draw };
}
