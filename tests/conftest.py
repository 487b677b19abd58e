"""Settings of the whole suite."""

from hypothesis import settings

# No test asserts wall time: a deadline of an example would be one, red on a busy
# machine.
settings.register_profile("pushpressslide", deadline=None, print_blob=True)
settings.load_profile("pushpressslide")
