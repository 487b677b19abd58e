"""Whether numba is enabled."""

from pushpressslide.batch import fast


def test_numba_is_left_out_inside_and_comes_back(monkeypatch):
    monkeypatch.setattr(fast, "installed", lambda: fast)
    assert fast.compiler() is fast
    with fast.without_numba():
        assert fast.compiler() is None
        assert not fast.loaded()
    assert fast.compiler() is fast


def test_compiling_is_told_where_one_would_notice(monkeypatch):
    monkeypatch.setattr(fast, "_compiled", [])
    fast.note_compiled(0.4)
    assert fast.compiling() == ""
    fast.note_compiled(11.7)
    assert fast.compiling() == "12 s of it compiled kernels, once on this machine"
