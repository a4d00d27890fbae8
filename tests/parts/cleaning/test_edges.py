"""The edge table against a dictionary, and pieces against their number."""

from collections import defaultdict

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from industnerf.parts.checks import bad_edges, bodies
from industnerf.parts.cleaning.edges import edges_of, pieces_of
from tests.parts.cleaning.shapes import ball, box, together

FACES = st.lists(st.permutations(range(7)).map(lambda p: p[:3]), min_size=1, max_size=12).map(
    lambda rows: np.array(rows, np.int32)
)


@given(FACES)
def test_edges_are_those_that_a_loop_over_the_faces_finds(faces):
    found = defaultdict(list)
    for number, (a, b, c) in enumerate(faces.tolist()):
        for start, end in ((a, b), (b, c), (c, a)):
            found[min(start, end), max(start, end)].append((number, start < end))
    edges = edges_of(faces)
    assert [tuple(ends) for ends in edges.ends.tolist()] == sorted(found)
    for ends, count, forward in zip(edges.ends, edges.count, edges.forward, strict=True):
        assert count == len(found[tuple(ends)])
        assert forward == sum(up for _, up in found[tuple(ends)])
    pairs, alike = edges.neighbours()
    doubles = [sides for _, sides in sorted(found.items()) if len(sides) == 2]
    assert pairs.tolist() == [[f, g] for (f, _), (g, _) in doubles]
    assert alike.tolist() == [up != other for (_, up), (_, other) in doubles]
    np.testing.assert_array_equal(edges.ends[~edges.sound], bad_edges(faces))


def test_pieces_are_the_bodies():
    mesh = together(box(), ball(1.0, (40, 0, 0)), box(centre=(0, 0, 50)))
    pieces = pieces_of(mesh.faces)
    assert len(np.unique(pieces)) == bodies(mesh.faces) == 3
    assert np.bincount(pieces).tolist() == [12, 320, 12]
