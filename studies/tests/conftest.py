"""Settings of the studies' tests, when they run alone."""

from importlib.util import find_spec

from hypothesis import settings

collect_ignore = ["drake"] if find_spec("pydrake") is None else []

# as in tests/conftest.py: no deadline, the same examples every time
settings.register_profile(
    "pushpressslide", deadline=None, print_blob=True, derandomize=True
)
settings.load_profile("pushpressslide")
