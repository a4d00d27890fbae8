"""Figures as PNG, and the layout of the SVG plots of the page."""
