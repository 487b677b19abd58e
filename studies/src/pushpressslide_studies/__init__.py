"""The paper's experiments, the benchmarks, and push-T in the version of the package
gym-pusht.

All of these use ``pushpressslide``, which never imports them.
"""
