"""Results folder, tables, console, model file, recording and pictures."""
