"""The edge table against a dictionary, and pieces against their number."""

from collections import defaultdict

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from industnerf.parts.repair.edges import build_edges
from industnerf.parts.validation.checks import bad_edges, count_bodies, surface_components
from tests.parts.repair.shapes import ball, box, concatenated

FACES = st.lists(st.permutations(range(7)).map(lambda p: p[:3]), min_size=1, max_size=12).map(
    lambda rows: np.array(rows, np.int32)
)


@given(FACES)
def test_edges_are_those_that_a_loop_over_the_faces_finds(faces):
    sides_of_edge = defaultdict(list)
    for number, (a, b, c) in enumerate(faces.tolist()):
        for start, end in ((a, b), (b, c), (c, a)):
            sides_of_edge[min(start, end), max(start, end)].append((number, start < end))
    edges = build_edges(faces)
    assert [tuple(ends) for ends in edges.ends.tolist()] == sorted(sides_of_edge)
    for ends, count, forward in zip(edges.ends, edges.face_count, edges.forward_count, strict=True):
        assert count == len(sides_of_edge[tuple(ends)])
        assert forward == sum(up for _, up in sides_of_edge[tuple(ends)])
    pairs, is_consistent = edges.adjacent_faces()
    doubles = [sides for _, sides in sorted(sides_of_edge.items()) if len(sides) == 2]
    assert pairs.tolist() == [[f, g] for (f, _), (g, _) in doubles]
    assert is_consistent.tolist() == [up != other for (_, up), (_, other) in doubles]
    np.testing.assert_array_equal(edges.ends[~edges.is_sound], bad_edges(faces))


def test_pieces_are_the_bodies():
    mesh = concatenated(box(), ball(1.0, (40, 0, 0)), box(center=(0, 0, 50)))
    pieces = surface_components(mesh.faces)
    assert len(np.unique(pieces)) == count_bodies(mesh.faces) == 3
    assert np.bincount(pieces).tolist() == [12, 320, 12]
