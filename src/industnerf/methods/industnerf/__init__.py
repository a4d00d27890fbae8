"""The paper's method: a point cloud with density and colour, trained by re-rendering its views."""
