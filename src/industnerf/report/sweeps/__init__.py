"""Reports of sweeps: points, series, plots, tables of documents."""
