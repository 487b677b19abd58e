"""The play bar works in a real browser: it plays, stops, seeks and changes the view."""

import html
import json
import re
import shutil
import subprocess
import warnings

import pytest

from pushpressslide.view.drake.replay import write_replay
from pushpressslide.view.planar.replay import write_replay as write_planar

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
# a headless page that nothing looks at is not drawn, and is given no frames
CLOCK = """<script>
window.requestAnimationFrame = draw => setTimeout(() => draw(performance.now()), 16);
</script>"""
DRIVER = """
<script>
const part = name => document.getElementById("bar-" + name);
const wait = ms => new Promise(done => setTimeout(done, ms));
// plays for some frames; returns from where, to where, and how long that took
const played = async (from, speed) => {
  const seek = part("seek");
  seek.value = from; seek.dispatchEvent(new Event("input"));
  part("speed").value = speed; part("play").click();
  const first = await new Promise(requestAnimationFrame);
  let last = first;
  for (let i = 0; i < 20; i++) last = await new Promise(requestAnimationFrame);
  const now = Number(seek.value);
  part("play").click();
  return [now - from, (last - first) / 1000];
};
const seconds = () => parseFloat(part("time").textContent);
(async () => {
  while (!part("time").textContent) await wait(50);
  const seen = {};
  try { await (@STEPS@)(seen); } catch (error) { seen.error = String(error); }
  const out = document.createElement("pre");
  out.id = "seen";
  out.textContent = JSON.stringify(seen);
  document.body.append(out);
})();
</script>
"""
COMMON = """
  seen.start = seconds();
  seen.words = part("play").textContent;
  const seek = part("seek");
  seek.value = 1.5; seek.dispatchEvent(new Event("input"));
  seen.sought = seconds();
  seen.phase = part("phase").textContent;
  seen.force = part("force").textContent;
  seen.goal = part("goal").textContent;
  seen.slow = await played(0.5, "0.1"); seen.fast = await played(0.5, "0.5");
  const stopped = seconds(); await wait(300);
  seen.stood = seconds() - stopped;
  seek.value = seek.max; seek.dispatchEvent(new Event("input"));
  seen.end = [seconds(), part("play").textContent, part("phase").textContent];
"""


@pytest.fixture
def browser():
    """Return a function that opens a page, takes steps there and says what it saw."""
    found = next(filter(None, map(shutil.which, NAMES)), None)
    if found is None:
        warnings.warn("no Chromium here: no replay page was opened", stacklevel=1)
        pytest.skip("no Chromium here: no replay page was opened")

    def drive(page, steps):
        driver = DRIVER.replace("@STEPS@", "async seen => {" + steps + "}")
        driven = page.with_name("driven.html")
        before, end, after = page.read_text("utf-8").rpartition("</body>")
        before = before.replace("<head>", "<head>" + CLOCK, 1)
        driven.write_text(before + driver + end + after, "utf-8")
        flags = ["--headless=new", "--no-sandbox", "--disable-gpu", "--dump-dom"]
        flags += ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
        flags += ["--virtual-time-budget=20000", "--window-size=320,300"]
        where = f"--user-data-dir={page.parent / 'profile'}"
        address = f"{driven.as_uri()}#t=0.25"
        command = [found, *flags, where, address]
        done = subprocess.run(command, capture_output=True, text=True, timeout=240)
        answer = re.search(r'<pre id="seen">(.*?)</pre>', done.stdout, re.DOTALL)
        assert answer, done.stderr[-2000:]
        return json.loads(html.unescape(answer[1]))

    return drive


def check_the_bar(seen):
    assert "error" not in seen, seen["error"]
    assert seen["start"] == 0.25
    assert seen["words"] == "Play"
    assert seen["sought"] == 1.5
    assert seen["phase"] == "move"
    assert seen["force"] == "force 3.2 N"
    assert re.fullmatch(r"to the goal \d+ mm, \d+°", seen["goal"])
    for speed, name in ((0.1, "slow"), (0.5, "fast")):
        ran, elapsed = seen[name]
        assert ran > 0.0
        assert ran == pytest.approx(min(3.99, speed * elapsed), abs=0.01)
    assert seen["stood"] == 0.0
    assert seen["end"] == [4.49, "Again", "release, goal reached"]


def test_the_planar_replay_is_played_and_sought(browser, run, tmp_path):
    page = write_planar(run.plan, run.record, tmp_path / "replay.html")
    check_the_bar(browser(page, COMMON))


def test_the_replay_in_space_is_played_sought_and_seen_from_elsewhere(
    browser, arm_run, tmp_path
):
    page = write_replay(arm_run.plan, arm_run.record, tmp_path / "replay.html")
    steps = """
  const place = () => viewer.scene_tree.find(["drake", "visualizer", "object"])
    .object.matrix.elements.slice(12, 14);
  const goTo = t => { seek.value = t; seek.dispatchEvent(new Event("input"));
    viewer.scene.updateMatrixWorld(true); return place(); };
"""
    steps = COMMON + steps
    steps += """
  seen.first = goTo(0.0); seen.last = goTo(4.49);
  seen.hidden = [];
  viewer.scene.traverse(part => {
    if (part.name === "hidden") seen.hidden.push([part.material.depthFunc, part.material.opacity]);
  });
  const camera = () => viewer.camera.position.toArray();
  seen.views = [...document.querySelectorAll("#views button")].map(b => b.textContent);
  seen.before = camera();
  document.querySelectorAll("#views button")[2].click();
  seen.above = camera(); seen.field = viewer.camera.fov;
"""
    seen = browser(page, steps)
    check_the_bar(seen)
    poses = arm_run.record.arrays["object_pose"]
    assert seen["first"] == pytest.approx(poses[0, :2], abs=1e-4)
    assert seen["last"] == pytest.approx(poses[-1, :2], abs=1e-4)
    assert seen["views"][:4] == ["Contact", "All", "Top", "Side"]
    assert seen["above"] != pytest.approx(seen["before"], abs=0.05)
    # shaft and head of the one force, where something is in front of it
    assert seen["hidden"] == [[6, 0.4]] * 2
    assert 40.0 <= seen["field"] <= 50.0
