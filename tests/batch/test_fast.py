"""Whether numba is wanted."""

from pushpressslide.batch import fast


def test_numba_is_left_out_inside_and_comes_back(monkeypatch):
    monkeypatch.setattr(fast, "installed", lambda: fast)
    assert fast.compiler() is fast
    with fast.without_numba():
        assert fast.compiler() is None
        assert not fast.loaded()
    assert fast.compiler() is fast
