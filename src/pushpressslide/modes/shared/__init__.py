"""Parts shared by several modes. No file here is a mode."""
