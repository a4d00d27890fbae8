"""One short script a DVC stage, and the sweep.  Paths and names here; arithmetic in src/."""
