"""Environments for learning to push, a mode's controller as a policy, and
demonstrations.

Importing this registers the environments with Gymnasium if that is installed.
"""

from pushpressslide.learning.registration import register

register()
