"""The paper's experiments, claims and corrections."""
