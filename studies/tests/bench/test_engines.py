"""One push in several engines, which agree in everything that they all model."""

import importlib.util

import pytest

from pushpressslide_studies.bench import engines


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    monkeypatch.setattr(engines, "ROUNDS", 1)
    monkeypatch.setattr(engines, "BODIES", 20)
    monkeypatch.setattr(engines, "EXACT_BODIES", 2)


def test_the_box_comes_to_about_the_same_place():
    pytest.importorskip("numba", reason=engines.NO_NUMBA)
    rows = {row["what"]: row for row in engines.engines()}
    alone = rows["one by one, closed form"]
    batch = rows["batch, compiled"]
    assert batch["y_mm"] == pytest.approx(alone["y_mm"], abs=1e-6)
    assert batch["yaw_deg"] == pytest.approx(alone["yaw_deg"], abs=1e-6)
    planar = rows["planar engine, one by one"]
    exact = rows["batch, exact surface, compiled"]
    for figure in ("x_mm", "y_mm", "yaw_deg"):
        assert exact[figure] == pytest.approx(planar[figure], abs=1e-6)
    # the tip gives way, by friction over damping: 1.5 mm in a second
    assert exact["x_mm"] == pytest.approx(alone["x_mm"], abs=1.6)
    assert exact["yaw_deg"] == pytest.approx(alone["yaw_deg"], abs=0.6)
    drake = rows["Drake, hydroelastic"]
    assert drake["y_mm"] == pytest.approx(alone["y_mm"], abs=1.0)
    assert drake["yaw_deg"] == pytest.approx(alone["yaw_deg"], abs=0.5)
    assert drake["ratio"] > rows["one by one, closed form"]["ratio"]
    if importlib.util.find_spec("mujoco") is None:
        assert "pushpressslide-studies[bench]" in rows["MuJoCo"]["note"]
    else:
        assert rows["MuJoCo"]["x_mm"] == pytest.approx(alone["x_mm"], abs=3.0)
