"""Task files: YAML to a checked Task and back, the schema, and its documentation."""
