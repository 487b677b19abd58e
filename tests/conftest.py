"""Settings of the whole suite."""

from hypothesis import settings

# No test asserts wall time: a deadline of an example would be one, red on a busy
# machine. The examples are the same every time, so that a change is red for what it
# changed; ``pytest --hypothesis-profile=search`` draws others.
settings.register_profile(
    "pushpressslide", deadline=None, print_blob=True, derandomize=True
)
settings.register_profile(
    "search", deadline=None, print_blob=True, derandomize=False, max_examples=500
)
settings.load_profile("pushpressslide")
