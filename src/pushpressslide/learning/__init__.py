"""Environments to learn pushing in, a mode's controller as a policy, demonstrations.

Importing this registers the environments with Gymnasium, where that is installed.
"""

from pushpressslide.learning.registration import register

register()
