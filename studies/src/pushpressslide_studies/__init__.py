"""The paper's experiments, the benchmarks, and push-T: built on ``pushpressslide``, which
never imports them.
"""
