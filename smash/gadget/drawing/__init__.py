"""Pictures of gadgets, instances and pebble motions (matplotlib); PNG, PDF, SVG or GIF by the file's suffix."""
