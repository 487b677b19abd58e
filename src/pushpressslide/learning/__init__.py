"""Environments in which to learn pushing, the controllers of modes as policies, and
demonstrations.

Importing this package registers the environments with Gymnasium, if that is installed.
"""

from pushpressslide.learning.registration import register

register()
