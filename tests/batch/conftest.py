import pytest

from pushpressslide.batch import loops


@pytest.fixture(params=["numpy", "numba"])
def engine(request, monkeypatch):
    """Each way to run a formula."""
    if request.param == "numpy":
        monkeypatch.setattr(loops, "compiler", lambda: None)
    elif loops.compiler() is None:
        pytest.skip("numba is not installed: pip install 'pushpressslide[fast]'")
    return request.param
