"""Bodies and where they stand: instances, mirrors, units, triangles out of strips and polygons."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from industnerf.errors import BadPart
from industnerf.parts.io.readers.polygons import triangulate_polygon
from industnerf.parts.validation.checks import volume_mm3
from tests.parts.io.readers import samples
from tests.parts.io.readers.samples import CORNERS, FACES, SIZE

TWICE = np.tile(CORNERS, (2, 1))  # glTF and COLLADA have the corners once for each color
MIRROR = [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.1, 0, 0, 1]  # columns: x -> 0.1 m - x


def volumes(solids):
    return [volume_mm3(solid.mesh.vertices, solid.mesh.faces) for solid in solids.solids]


def test_gltf_nodes_are_solids_wherever_they_stand_and_mirrors_keep_their_outside(read):
    tree, data = samples.gltf_tree()
    tree["nodes"] = [
        {"children": [1, 2], "scale": [2, 2, 2]},
        {"mesh": 0, "name": "left", "matrix": MIRROR},
        {
            "mesh": 0,
            "name": "right",
            "rotation": [0, 0, 0.5**0.5, 0.5**0.5],
            "translation": [1, 0, 0],
        },
    ]
    solids = read("two.glb", samples.glb(tree, data))
    assert [solid.name for solid in solids.solids] == ["left", "right"]
    assert volumes(solids) == pytest.approx([48_000, 48_000], rel=1e-6)
    left, right = (solid.mesh.vertices for solid in solids.solids)
    assert left.max(axis=0) == pytest.approx((200, 40, 20), rel=1e-6)
    # a quarter turn about the file's z, which is our -y: the 30 along z, the 10 along -x
    assert np.ptp(right, axis=0) == pytest.approx((20, 40, 60), rel=1e-6)
    assert right.max(axis=0) == pytest.approx((2000, 40, 60), rel=1e-6)


@pytest.mark.parametrize(("mode", "order"), [(5, [0, 1, 2, 3]), (6, [0, 1, 3, 2])])
def test_gltf_strips_and_fans_are_the_same_square(read, mode, order):
    tree, _ = samples.gltf_tree()
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)], "<f4")[order]
    # strip 0 1 2 3 and fan 0 1 3 2 both cover the unit square counter-clockwise
    tree["bufferViews"] = [{"buffer": 0, "byteLength": 48}]
    tree["accessors"] = [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}]
    tree["meshes"] = [{"primitives": [{"mode": mode, "attributes": {"POSITION": 0}}]}]
    tree["buffers"] = [{"byteLength": 48}]
    mesh = read("strip.glb", samples.glb(tree, points.tobytes())).solids[0].mesh
    a, b, c = mesh.triangles.swapaxes(0, 1)
    # twice half a square meter, along the file's z: our -y
    assert np.cross(b - a, c - a)[:, 1].tolist() == [-1e6, -1e6]


@pytest.mark.parametrize(
    ("unit", "factor"),
    [("micron", 1e-3), ("millimeter", 1), ("centimeter", 10), ("inch", 25.4), ("foot", 304.8)],
)
def test_3mf_units(read, unit, factor):
    mesh = read("unit.3mf", samples.threemf(unit=unit)).solids[0].mesh
    assert np.ptp(mesh.vertices, axis=0) == pytest.approx(np.array(SIZE) * factor)


@pytest.mark.parametrize(
    ("unit", "factor"),
    [
        ('<unit name="inch" meter="0.0254"/>', 25.4),
        ('<unit name="mm" meter="0.001"/>', 1),
        ("", 1000),
    ],
)
def test_collada_units(read, unit, factor):
    mesh = read("unit.dae", samples.dae(unit=unit, scale=1)).solids[0].mesh
    assert np.ptp(mesh.vertices, axis=0) == pytest.approx(np.array(SIZE) * factor, rel=1e-6)


@pytest.mark.parametrize("up", samples.UP_CORNERS)
def test_collada_says_which_way_is_up(read, up):
    solids = read("up.dae", samples.dae(up=up))
    assert solids.warnings == ()
    # the very corners, not only the size: a mirror image would have its volume, and no faults
    np.testing.assert_allclose(solids.solids[0].mesh.vertices, TWICE, atol=1e-6)
    assert volumes(solids) == pytest.approx([6000], rel=1e-6)


def test_collada_with_an_unheard_of_up_is_taken_for_the_default(read):
    content = samples.dae(up="Y_UP").replace(b"Y_UP", b"W_UP")
    solids = read("up.dae", content)
    np.testing.assert_allclose(solids.solids[0].mesh.vertices, TWICE, atol=1e-6)
    assert solids.warnings == ("up_axis 'W_UP' is none of X_UP, Y_UP, Z_UP; taken for Y_UP",)


def test_gltf_has_y_up_whatever_its_nodes_do(read):
    """What a node does to its mesh happens in the file's axes: the turn comes last."""
    tree, data = samples.gltf_tree()
    tree["nodes"] = [{"mesh": 0, "translation": [0, 1, 0]}]  # a meter up
    mesh = read("high.glb", samples.glb(tree, data)).solids[0].mesh
    np.testing.assert_allclose(mesh.vertices, TWICE + np.array([0, 0, 1000]), atol=1e-4)


def test_3mf_items_and_components_are_placed_and_supports_left_out(read):
    pair = (
        '<object id="3"><components><component objectid="1"/>'
        '<component objectid="1" transform="-1 0 0 0 1 0 0 0 1 100 0 0"/></components></object>'
        '<object id="4" type="support"><mesh><vertices/><triangles/></mesh></object>'
    )
    build = '<item objectid="3" transform="2 0 0 0 2 0 0 0 2 0 0 7"/><item objectid="4"/>'
    solids = read("pair.3mf", samples.threemf(extra_objects=pair, build=build))
    assert volumes(solids) == pytest.approx([48_000, 48_000])
    assert solids.solids[1].mesh.vertices.max(axis=0).tolist() == [200, 40, 27]
    assert solids.warnings == ("objects of type 'support' left out",)


def test_obj_objects_are_solids_and_groups_are_not(read):
    points = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS)
    faces = "".join("f {} {} {}\n".format(*(face + 1)) for face in FACES)
    content = f"{points}o first\ng a\n{faces}g b\n{faces}o second\n{faces}".encode()
    solids = read("two.obj", content)
    assert [(s.name, len(s.mesh.faces)) for s in solids.solids] == [("first", 24), ("second", 12)]


@pytest.mark.parametrize(
    ("head", "color_text"),
    [
        ("COFF", "255 0 0 255"),
        ("COFF", "255 0 0"),
        ("CNOFF", "0 0 1 255 0 0"),
        ("CNOFF", "0 0 1 1.0 0.0 0.0 1.0"),
    ],
)
def test_coff_colors_of_vertices(read, head, color_text):
    """They stand behind the normal, if there is one, and may have a fourth number."""
    rows = "".join(f"{x} {y} {z} {color_text}\n" for x, y, z in CORNERS)
    faces = "".join("3 {} {} {}\n".format(*face) for face in FACES)
    assert [f.name for f in read("c.off", f"{head}\n8 12 0\n{rows}{faces}".encode()).finishes] == [
        "#ff0000"
    ]


def test_an_obj_may_name_several_libraries_in_a_line(read, tmp_path):
    """Of one that is missing it is said; a name with a blank in it is one name."""
    for name, color in (("a.mtl", "1 0 0"), ("b.mtl", "0 0 1"), ("a b.mtl", "0 1 0")):
        (tmp_path / name).write_text(f"newmtl {name[0]}\nKd {color}\n")
    points = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS)
    faces = ["f {} {} {}\n".format(*(face + 1)) for face in FACES]
    halves = "usemtl a\n" + "".join(faces[:6]) + "usemtl b\n" + "".join(faces[6:])
    two = read("two.obj", f"mtllib a.mtl b.mtl gone.mtl\n{points}{halves}".encode())
    assert sorted(finish.name for finish in two.finishes) == ["#0000ff", "#ff0000"]
    assert "its materials are missing: gone.mtl" in two.warnings
    mixed = read("mixed.obj", f"mtllib a b.mtl b.mtl\n{points}{halves}".encode())
    assert sorted(finish.name for finish in mixed.finishes) == ["#0000ff", "#00ff00"]
    one = read("one.obj", f"mtllib a b.mtl\n{points}usemtl a\n{''.join(faces)}".encode())
    assert [finish.name for finish in one.finishes] == ["#00ff00"]


def threedxml_pair(loop=""):
    import io
    import zipfile

    files = {n: zipfile.ZipFile(io.BytesIO(samples.threedxml())).read(n) for n in ("box.3DRep",)}
    instance = (
        '<Instance3D id="{}" name="x"><IsAggregatedBy>1</IsAggregatedBy><IsInstanceOf>9'
        "</IsInstanceOf><RelativeMatrix>0 1 0 -1 0 0 0 0 1 {} 0 0</RelativeMatrix></Instance3D>"
    )
    tree = (
        '<Model_3dxml xmlns="http://www.3ds.com/xsd/3DXML"><ProductStructure root="1">'
        '<Reference3D id="1" name="pair"/><Reference3D id="9" name="box"/>'
        '<ReferenceRep id="2" format="TESSELLATED" associatedFile="urn:3DXML:box.3DRep"/>'
        '<InstanceRep id="3"><IsAggregatedBy>9</IsAggregatedBy><IsInstanceOf>2</IsInstanceOf>'
        f"</InstanceRep>{instance.format(4, 0)}{instance.format(5, 50)}{loop}"
        "</ProductStructure></Model_3dxml>"
    )
    manifest = '<Manifest xmlns="http://www.3ds.com/xsd/3DXML"><Root>t.3dxml</Root></Manifest>'
    return samples.zipped({**files, "Manifest.xml": manifest, "t.3dxml": tree})


def test_3dxml_instances_stand_where_the_tree_puts_them(read):
    solids = read("pair.3dxml", threedxml_pair())
    assert [solid.name for solid in solids.solids] == ["box", "box"]
    assert volumes(solids) == pytest.approx([6000, 6000])
    # columns (0 1 0), (-1 0 0): x goes to y, y to -x; then the shift
    assert solids.solids[1].mesh.vertices.min(axis=0).tolist() == [30, 0, 0]
    assert solids.solids[1].mesh.vertices.max(axis=0).tolist() == [50, 30, 10]


def test_3dxml_assemblies_that_hold_themselves_are_refused(read):
    loop = (
        '<Instance3D id="6"><IsAggregatedBy>9</IsAggregatedBy><IsInstanceOf>1</IsInstanceOf>'
        "</Instance3D>"
    )
    with pytest.raises(BadPart, match="holds itself"):
        read("loop.3dxml", threedxml_pair(loop))


def area(points, corners):
    a, b, c = points[corners].swapaxes(0, 1)
    return np.cross(b - a, c - a).sum(axis=0) / 2


@given(
    st.lists(st.floats(0.2, 1.0), min_size=4, max_size=24),
    st.floats(0, 6),
    st.floats(-100, 100),
)
def test_a_star_is_filled_exactly(radii, tilt, far):
    """Of a star-shaped outline, the triangles' areas sum to the outline's, none is turned over."""
    angle = np.linspace(0, 2 * np.pi, len(radii), endpoint=False)
    flat = np.array(radii)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    frame = np.array([(np.cos(tilt), np.sin(tilt), 0), (0, 0.6, 0.8)])
    points = flat @ frame + far
    corners = triangulate_polygon(points)
    assert len(corners) == len(radii) - 2
    around = points - points.mean(axis=0)
    outline = np.cross(around, np.roll(around, -1, axis=0)).sum(axis=0) / 2
    # coordinates of 1e2 with 1e-16 relative rounding: areas of 1 to 1e-13 and some
    np.testing.assert_allclose(area(points, corners), outline, atol=1e-11)
    each = np.array([area(points, row[None]) for row in corners])
    assert (each @ outline >= -1e-9).all()


def test_a_polygon_without_area_and_one_that_crosses_itself_still_have_triangles():
    line = np.array([(float(i), 0, 0) for i in range(5)])
    assert len(triangulate_polygon(line)) == 3
    star = np.array([(np.cos(4 * np.pi * i / 5), np.sin(4 * np.pi * i / 5), 0) for i in range(5)])
    assert len(triangulate_polygon(star)) == 3
