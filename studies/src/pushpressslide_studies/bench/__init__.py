"""The benchmarks: closed forms beside their alternatives."""
