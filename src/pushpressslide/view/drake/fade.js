// Arms that hide a contact or a goal from the camera are seen through, as fade.py has it
// in pictures. All points are in three.js's axes, y-up.
const FAINT = 0.15, HOLD = 400, SOFTEN = 300;  // opacity, of several surfaces in a row; [ms] after a point was hidden; [ms] of a change
const OWN = 0.05, SHARE = 0.3;  // [m] next to a contact that do not count; of a goal's points, from which on it is hidden

function segmentDistance(a, b, c, d) {
  const u = minus(b, a), v = minus(d, c), w = minus(a, c);
  const uu = Math.max(dot(u, u), 1e-12), vv = Math.max(dot(v, v), 1e-12), uv = dot(u, v), uw = dot(u, w), vw = dot(v, w);
  const clip = x => Math.min(1, Math.max(0, x));
  let s = clip((uv * vw - vv * uw) / Math.max(uu * vv - uv * uv, 1e-12));
  const t = clip((uv * s + vw) / vv);
  s = clip((uv * t - uw) / uu);
  return Math.hypot(...plus(plus(w, u, s), v, -t));
}

function hides(joints, radius, target, eye) {  // whether links between joints hide enough of a target's points
  let count = 0;
  for (const point of target) {
    const line = minus(eye, point), near = plus(point, line, Math.min(1, OWN / Math.max(1e-9, Math.hypot(...line))));
    if (joints.some((joint, i) => i && segmentDistance(near, eye, joints[i - 1], joint) < radius)) count++;
  }
  return count > SHARE * target.length;
}

function fadeArms(viewer, scene) {
  const object = path => viewer.scene_tree.find(path).object;
  const goals = scene.goals.map(points => points.map(toCamera)), contacts = scene.contacts.map(at => at.map(p => [toCamera(p)]));
  const arms = scene.arms.map((links, i) => ({ links, tip: scene.tips[i], opacity: 1, hidden: -Infinity })), radius = scene.radius;
  let frame = 0, through = false, last = null;

  function place(path) {
    const body = object(path);
    body.updateWorldMatrix(true, false);
    return [...body.matrixWorld.elements.slice(12, 15)];
  }
  function joints(arm) {  // and the flange, on the way to the tip
    const places = arm.links.map(place), last = places[places.length - 1], rod = minus(place(arm.tip), last);
    return [...places, plus(last, rod, Math.min(1, scene.flange / Math.max(1e-9, Math.hypot(...rod))))];
  }
  function paint(arm) {
    for (const path of arm.links) object(path).traverse(part => {
      for (const m of [].concat(part.material || [])) {  // a mesh may have several
        m.transparent = arm.opacity < 1; m.opacity = arm.opacity; m.depthWrite = arm.opacity === 1; m.needsUpdate = true;
      }
    });
    viewer.set_dirty();
  }
  function look(now) {
    const eye = viewer.camera.position.toArray(), targets = goals.concat(contacts[frame] || []);
    for (const arm of arms) {
      const places = joints(arm);
      if (through || targets.some(target => hides(places, radius, target, eye))) arm.hidden = now;
      const wanted = now - arm.hidden <= HOLD ? FAINT : 1, step = last === null ? 1 : (now - last) / SOFTEN;
      const next = Math.min(Math.max(wanted, arm.opacity - step), arm.opacity + step);
      if (next !== arm.opacity) { arm.opacity = next; paint(arm); }
    }
    last = now;
  }
  function loop(now) { look(now); requestAnimationFrame(loop); }
  requestAnimationFrame(loop);
  return {
    show: at => { frame = at; },
    through: on => { through = on; },
    paint: () => arms.forEach(paint),
  };
}
