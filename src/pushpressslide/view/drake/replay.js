// Drives a saved Meshcat page: its animation from the play bar, and its camera from
// the views. Meshcat's world is z-up, the camera's own axes are three.js's, y-up.
const toCamera = p => [p[0], p[2], -p[1]];
const fromCamera = p => [p[0], -p[2], p[1]];
const turned = (p, a) => [Math.cos(a) * p[0] - Math.sin(a) * p[1], Math.sin(a) * p[0] + Math.cos(a) * p[1], p[2]];
const minus = (a, b) => a.map((v, i) => v - b[i]);
const plus = (a, b, s = 1) => a.map((v, i) => v + s * b[i]);
const dot = (a, b) => a.reduce((sum, v, i) => sum + v * b[i], 0);
const unit = a => a.map(v => v / Math.hypot(...a));
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

// The nearest camera from a direction that holds all points, as fit_view of camera.py.
function fitCamera(points, direction, field, aspect, fill) {
  const ahead = unit(direction).map(v => -v), right = unit(cross(ahead, [0, 0, 1])), down = cross(ahead, right);
  const low = [0, 1, 2].map(i => Math.min(...points.map(p => p[i]))), high = [0, 1, 2].map(i => Math.max(...points.map(p => p[i])));
  let target = low.map((v, i) => (v + high[i]) / 2);
  const reach = Math.tan(field / 2) * fill, size = Math.max(...points.map(p => Math.hypot(...minus(p, target))));
  let distance = size / (reach * Math.min(1, aspect)) + size;
  for (let k = 0; k < 20; k++) {
    const seen = points.map(p => { const d = minus(p, target), depth = dot(d, ahead) + distance;
      return [dot(d, right) / depth, dot(d, down) / depth]; });
    const [across, below] = [0, 1].map(i => [Math.min(...seen.map(s => s[i])), Math.max(...seen.map(s => s[i]))]);
    target = plus(plus(target, right, distance * (across[0] + across[1]) / 2), down, distance * (below[0] + below[1]) / 2);
    const needed = Math.max((across[1] - across[0]) / aspect, below[1] - below[0]);
    distance *= Math.pow(needed / (2 * reach), 0.7);
  }
  return { position: plus(target, ahead, -distance), target };
}

function lightUp(viewer, look) {
  // one light from above casts the shadows; nothing that is seen through or only drawn does
  const sun = viewer.scene_tree.find(["Lights", "FillLight", "<object>"]).object;
  const center = toCamera(look.center), from = toCamera(plus(look.center, look.light, 3));
  viewer.scene_tree.find(["Lights", "FillLight"]).object.updateMatrixWorld(true);
  sun.position.set(...plus(look.center, look.light, 3));
  sun.target.position.set(...center); sun.target.updateMatrixWorld();
  sun.castShadow = true; sun.intensity = 1.6;
  sun.shadow.mapSize.set(2048, 2048); sun.shadow.bias = -0.0005; sun.shadow.normalBias = 0.004; sun.shadow.radius = 2;
  const box = sun.shadow.camera;
  box.left = box.bottom = -look.radius; box.right = box.top = look.radius; box.near = 0.1; box.far = 6;
  box.updateProjectionMatrix();
  for (const side of ["PointLightNegativeX", "PointLightPositiveX"])
    viewer.set_property(["Lights", side, "<object>"], "intensity", 9);
  viewer.set_property(["Lights", "AmbientLight", "<object>"], "intensity", 1.1);
  const arrows = [];
  viewer.scene.traverse(part => {
    if (!part.isMesh) return;
    let name = "";
    for (let p = part; p; p = p.parent) name = p.name + "/" + name;
    part.castShadow = !/\/marks\//.test(name) && !part.material.transparent;
    part.receiveShadow = !/\/marks\//.test(name);
    if (/\/marks\/(force|press)_/.test(name)) arrows.push(part);
  });
  for (const part of arrows) {  // what hides a force lets it shine through
    const pale = part.clone();
    pale.material = part.material.clone();
    Object.assign(pale.material, { depthFunc: 6, depthWrite: false, transparent: true, opacity: 0.4 });  // 6: three.js's GreaterDepth
    pale.name = "hidden"; pale.castShadow = pale.receiveShadow = false;
    part.parent.add(pale);
  }
  return from;
}

function whenLoaded(viewer, start) {
  if (viewer.animator.actions.length) start();
  else requestAnimationFrame(() => whenLoaded(viewer, start));
}

function startReplay(viewer, course, views, look) {
  const pane = document.getElementById("meshcat-pane"), bar = document.getElementById("views");
  const fading = fadeArms(viewer, look.hiding);
  const animator = viewer.animator, camera = viewer.camera, controls = viewer.controls;
  let view = views[0], frame = 0, moved = false, before = null, yaw = 0;
  animator.play(); animator.pause();  // its actions are active, and only seek moves them
  viewer.gui.domElement.style.display = "none";
  camera.fov = look.field;

  const turn = at => view.turn.length ? view.turn[Math.min(at, view.turn.length - 1)] : 0;
  const place = at => view.follow.length ? view.follow[Math.min(at, view.follow.length - 1)] : [0, 0, 0];
  function aim() {
    const aspect = pane.offsetWidth / Math.max(1, pane.offsetHeight);
    before = place(frame); yaw = turn(frame);
    const points = view.points.map(p => plus(p, before));
    const fit = fitCamera(points, turned(view.direction, yaw), look.field * Math.PI / 180, aspect, look.fill);
    camera.position.set(...toCamera(fit.position)); controls.target.set(...toCamera(fit.target));
    controls.update(); moved = false; viewer.set_dirty();
  }
  function show(time, at) {
    frame = at; fading.show(at);
    animator.seek(time);
    if (view.follow.length) {
      const now = place(at), step = toCamera(minus(now, before)), angle = turn(at) - yaw;
      const target = controls.target.toArray(), away = fromCamera(minus(camera.position.toArray(), target));
      const moved = plus(target, step);
      controls.target.set(...moved); camera.position.set(...plus(moved, toCamera(turned(away, angle))));
      before = now; yaw = turn(at);
    }
    viewer.set_dirty();
  }
  function fit() { viewer.set_3d_pane_size(); if (!moved) aim(); }
  function button(text, title, press) {
    const made = document.createElement("button");
    made.type = "button"; made.textContent = text; made.title = title; made.onclick = () => press(made);
    bar.append(made);
    return made;
  }
  const buttons = views.map(v => button(v.name, v.name + " view", made => choose(v, made)));
  function choose(v, made) {
    view = v;
    for (const other of buttons) other.setAttribute("aria-pressed", other === made);
    fading.through(view.through);
    aim();
  }
  const put = viewer.set_object;  // meshes of arms may come later
  viewer.set_object = (path, object) => { put.call(viewer, path, object); fading.paint(); };
  button("Meshcat", "Meshcat's own controls: hide parts of the scene, save a picture", () => {
    const own = viewer.gui.domElement.style;
    own.display = own.display === "none" ? "" : "none"; own.top = "40px"; viewer.gui.open();
  }).className = "more";
  if (window.innerWidth < 640) document.getElementById("legend").open = false;
  controls.addEventListener("start", () => { moved = true; });
  lightUp(viewer, look);
  // #view=Top opens the page with that view
  const wanted = new URLSearchParams(location.hash.slice(1)).get("view");
  const first = Math.max(0, views.findIndex(v => v.name === wanted));
  choose(views[first], buttons[first]);
  new ResizeObserver(fit).observe(pane);
  playBar(course, show);
}
