"""Task files: from YAML to a checked Task and back, the JSON Schema, and the
documentation of fields.
"""
