"""What a perfect random cloud scores by its number of points, in floors (external/density.py)."""

import numpy as np

from industnerf.geometry.sampling import sample_surface
from industnerf.metrics.emd import emd
from industnerf.metrics.subsample import farthest_points
from industnerf.parts.catalogue.entries import EMBEDDED_FOLDER, load_catalogue_mesh, read_catalogue

PARTS = ("gate-valve-dn50-pn16", "gantry-plate-c-beam-xl", "screw-iso10642-m8x30")  # dev
COMPARED, DENSE = 4096, 65536  # points of the protocol
COUNTS = (512, 1024, 2048, 4096, 8192, 16384, 32768)


def main() -> None:
    entries = {entry.id: entry for entry in read_catalogue(EMBEDDED_FOLDER)}
    print("| part | " + " | ".join(map(str, COUNTS)) + " |\n" + "|---" * (len(COUNTS) + 1) + "|")
    for part_id in PARTS:
        mesh = load_catalogue_mesh(entries[part_id])
        vertices = mesh.vertices / np.linalg.norm(np.ptp(mesh.vertices, axis=0))
        rng = np.random.default_rng(0)

        def even(count: int) -> np.ndarray:
            points = sample_surface(vertices, mesh.faces, count, rng)[0]  # noqa: B023
            return farthest_points(points, COMPARED)

        truth = even(DENSE)
        floor = emd(even(DENSE), truth).value
        print(
            f"| {part_id} |",
            *(f"{emd(even(count), truth).value / floor:.2f} |" for count in COUNTS),
        )


if __name__ == "__main__":
    main()
