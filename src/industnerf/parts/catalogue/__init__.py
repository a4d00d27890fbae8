"""The embedded and the non-industrial parts: recipes, stored meshes, data card."""
