"""The paper's experiments and the benchmarks. The library never imports them."""
