"""IndustNeRF: industrial CAD parts from images, its baselines, and how they are measured."""

from industnerf import processor

processor.pin()  # numeric libraries read their environment as they load
