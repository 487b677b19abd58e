import pytest

from pushpressslide.batch import fast


@pytest.fixture(params=["python", "numba"])
def engine(request):
    """Each way to run a batch."""
    if request.param == "python":
        with fast.without_numba():
            yield request.param
        return
    if fast.compiler() is None:
        pytest.skip("numba is not installed: pip install 'pushpressslide[fast]'")
    yield request.param
