"""Colors: decoded once, told apart up to 256, and never invented."""

import io

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from industnerf.artifacts.part import UNSPECIFIED
from industnerf.parts.io.readers.colors import (
    MAX_FINISHES,
    TEXTURE_REDUCED,
    TEXTURE_UNREADABLE,
    linear_to_srgb8,
    parse_hex,
    quantize_finishes,
    sample_texture,
    srgb_to_linear,
)
from industnerf.parts.io.readers.mesh_content import MeshBody
from tests.parts.io.readers import samples
from tests.parts.io.readers.samples import CORNERS, FACES, TOP


def body(albedo):
    count = len(albedo)
    faces = np.arange(3 * count).reshape(-1, 3)
    return MeshBody("b", np.zeros((3 * count, 3)), faces, np.asarray(albedo, float).reshape(-1, 3))


def test_every_8_bit_color_comes_back():
    ramp = np.repeat(np.arange(256)[:, None], 3, axis=1)
    np.testing.assert_array_equal(linear_to_srgb8(srgb_to_linear(ramp / 255)), ramp)


def test_the_decoding_is_that_of_the_standard():
    # IEC 61966-2-1: linear below 0.04045, and 0.5 decodes to 0.214041
    assert srgb_to_linear(np.array([[0.0, 0.02, 0.5]]))[0] == pytest.approx(
        (0, 0.02 / 12.92, 0.214041), 1e-5
    )
    assert srgb_to_linear(np.array([[1.0, 2.0, -1.0]])).tolist() == [[1, 1, 0]]


@pytest.mark.parametrize(
    ("text", "color"),
    [("#ff0000", (1, 0, 0)), ("#00FF0080", (0, 1, 0)), ("red", None), ("#ff00", None), ("", None)],
)
def test_hex_colors(text, color):
    parsed = parse_hex(text)
    assert (parsed is None) == (color is None)
    assert color is None or tuple(parsed) == color


@given(st.lists(st.integers(0, 400), min_size=1, max_size=600), st.booleans())
def test_up_to_256_finishes_keep_every_color_and_more_are_reduced(numbers, bare):
    """Each face gets a finish near its color: exactly, while all fit."""
    colors = np.array([(n % 20 * 12, n // 20 * 12, n % 7 * 30) for n in numbers], np.uint8)
    albedo = srgb_to_linear(colors / 255)
    rows = np.concatenate([albedo, np.full((int(bare), 3), np.nan)])
    finishes, (finish,), warnings = quantize_finishes((body(rows),))
    distinct = len(np.unique(colors, axis=0))
    assert len(finishes) <= MAX_FINISHES
    assert (distinct + bare > MAX_FINISHES) == bool(warnings)
    assert (finishes[0] == UNSPECIFIED) == bare
    if not warnings:
        kept_albedo = np.array([finishes[i].albedo for i in finish[: len(colors)]])
        np.testing.assert_allclose(kept_albedo, albedo, atol=1e-6)  # rounded to 6 digits
        assert len(finishes) == distinct + bare
    if bare:
        assert finish[-1] == 0


@pytest.mark.parametrize(("bare", "kept"), [(False, 256), (True, 255)])
def test_no_color_stated_takes_one_of_the_256_places(bare, kept):
    gray = np.repeat(np.arange(256)[:, None], 3, axis=1)
    rows = np.concatenate([srgb_to_linear(gray / 255), np.full((int(bare), 3), np.nan)])
    finishes, (finish,), _ = quantize_finishes((body(rows),))
    assert len(finishes) <= kept + bare
    assert finish.max() < len(finishes)
    assert len(np.unique(finish[:256])) > 200  # the reduced ones are still told apart


def test_a_reduced_palette_says_how_far_off_it_is(read):
    ramp = np.stack(np.meshgrid(*[np.arange(0, 256, 25)] * 3), axis=-1).reshape(-1, 3)
    finishes, (finish,), (warning,) = quantize_finishes((body(srgb_to_linear(ramp / 255)),))
    hex_colors = np.array([bytes.fromhex(finishes[i].name[1:]) for i in finish])
    reduced = np.array([list(row) for row in hex_colors])
    worst = int(np.abs(reduced - ramp).max())
    assert warning == f"1331 colors reduced to {len(finishes)}, at most {worst} of 255 off"
    assert worst <= 40  # 1331 grid colors, 25 apart, to 256: each stands for a 2x2x2 block or so


def two_color_png(left, right):
    memory = io.BytesIO()
    pixels = np.zeros((4, 8, 3), np.uint8)
    pixels[:, :4], pixels[:, 4:] = left, right
    Image.fromarray(pixels).save(memory, "PNG")
    return memory.getvalue()


TEXTURED = b"""mtllib quad.mtl
v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nv 1 0 0\nv 1 1 0
vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0.5 0\nvt 0.5 1
usemtl skin
f 1/1 5/5 6/6 4/4\nf 5/5 2/2 3/3 6/6
"""


def test_a_picture_becomes_the_color_under_the_middle_of_each_face(read, tmp_path):
    (tmp_path / "my skin.png").write_bytes(two_color_png((255, 0, 0), (0, 255, 0)))
    (tmp_path / "quad.mtl").write_bytes(b"newmtl skin\nKd 1 1 1\nmap_Kd -s 1 1 1 my skin.png\n")
    solids = read("quad.obj", TEXTURED)
    names = [solids.finishes[i].name for i in solids.solids[0].mesh.finish]
    assert names == ["#ff0000", "#ff0000", "#00ff00", "#00ff00"]
    assert solids.warnings == (TEXTURE_REDUCED,)


def test_a_missing_or_torn_picture_leaves_the_materials_color(read, tmp_path):
    (tmp_path / "quad.mtl").write_bytes(b"newmtl skin\nKd 1 0 0\nmap_Kd gone.png\n")
    assert [f.name for f in read("quad.obj", TEXTURED).finishes] == ["#ff0000"]
    (tmp_path / "gone.png").write_bytes(two_color_png((1, 2, 3), (4, 5, 6))[:50])
    solids = read("quad.obj", TEXTURED)
    assert [f.name for f in solids.finishes] == ["#ff0000"]
    assert solids.warnings == ("picture gone.png cannot be read",)


def test_a_texture_repeats_and_its_first_row_is_the_top():
    pixels = np.array([[(255, 0, 0)], [(0, 0, 255)]], np.uint8)
    memory = io.BytesIO()
    Image.fromarray(pixels).save(memory, "PNG")
    corners = np.array([[(0.5, 0.9)] * 3, [(0.5, 0.1)] * 3, [(-3.5, 2.9)] * 3, [(np.nan, 7.1)] * 3])
    sampled = sample_texture(memory.getvalue(), corners)
    assert sampled.tolist() == [[1, 0, 0], [0, 0, 1], [1, 0, 0], [0, 0, 1]]


def test_vertex_colors_are_mixed_as_light(read):
    """Half white and half black is 0.5 of the light, not 0.5 of the code."""
    content = b"v 0 0 0 1 1 1\nv 1 0 0 1 1 1\nv 0 1 0 0 0 0\nf 1 2 3\n"
    (finish,) = read("vertex.obj", content).finishes
    assert finish.albedo == pytest.approx((2 / 3,) * 3, abs=4e-3)  # 8 bits of sRGB


@pytest.mark.parametrize(
    ("form", "color"), [("ply", "#c86432"), ("obj", "#c86432"), ("off", "unstated")]
)
def test_trimeshs_own_files_with_vertex_colors(read, form, color):
    mesh = trimesh.Trimesh(CORNERS, FACES, process=False)
    mesh.visual.vertex_colors = np.tile((200, 100, 50, 255), (8, 1))
    content = mesh.export(file_type=form)
    solids = read(f"a.{form}", content if form == "ply" else content.encode())
    assert [finish.name for finish in solids.finishes] == [color]


def test_vertex_colors_of_gltf_are_linear_shares_and_multiply_the_factor(read):
    """Red 1 as 255 of 255, halved by the factor, is 0.5 of the light: 188 in sRGB."""
    tree, data = samples.gltf_tree()
    data = data.ljust(-(-len(data) // 4) * 4, b"\0")
    colors = bytes(8 * (255, 0, 0, 255))
    tree["bufferViews"].append({"buffer": 0, "byteOffset": len(data), "byteLength": len(colors)})
    tree["buffers"][0]["byteLength"] = len(data) + len(colors)
    accessor = {"bufferView": 3, "componentType": 5121, "normalized": True, "type": "VEC4"}
    tree["accessors"].append(accessor | {"count": 8})
    for part in tree["meshes"][0]["primitives"]:
        part["attributes"]["COLOR_0"] = 3
    tree["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"] = [0.5, 1, 1, 1]
    del tree["meshes"][0]["primitives"][0]["material"]
    solids = read("painted.glb", samples.glb(tree, data + colors))
    assert [finish.name for finish in solids.finishes] == ["#bc0000", "#ff0000"]
    np.testing.assert_array_equal(solids.solids[0].mesh.finish, ~TOP)


def test_gltf_factors_are_linear_and_multiply_the_picture(read):
    tree, data = samples.gltf_tree()
    image = two_color_png((255, 255, 255), (255, 255, 255))
    data = data.ljust(-(-len(data) // 4) * 4, b"\0")
    uvs = np.zeros((8, 2), "<f4").tobytes()
    tree["bufferViews"] += [
        {"buffer": 0, "byteOffset": len(data), "byteLength": len(uvs)},
        {"buffer": 0, "byteOffset": len(data) + len(uvs), "byteLength": len(image)},
    ]
    tree["buffers"][0]["byteLength"] = len(data) + len(uvs) + len(image)
    tree["accessors"].append({"bufferView": 3, "componentType": 5126, "count": 8, "type": "VEC2"})
    tree["images"], tree["textures"] = [{"bufferView": 4, "mimeType": "image/png"}], [{"source": 0}]
    tree["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    tree["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 3
    solids = read("skin.glb", samples.glb(tree, data + uvs + image))
    assert [f.name for f in solids.finishes] == ["#000080", "#ff0000"]
    assert solids.warnings == (TEXTURE_REDUCED,)
    np.testing.assert_array_equal(solids.solids[0].mesh.finish, TOP)


def test_a_gltf_whose_picture_is_missing_keeps_its_shape_and_says_so(read):
    tree, data = samples.gltf_tree()
    tree["images"], tree["textures"] = [{"uri": "paint.png"}], [{"source": 0}]
    tree["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    tree["accessors"].append({"componentType": 5126, "count": 8, "type": "VEC2"})
    tree["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 3
    solids = read("skin.glb", samples.glb(tree, data))
    assert len(solids.solids[0].mesh.faces) == 12
    assert solids.warnings == (TEXTURE_UNREADABLE,)


def test_a_gltf_material_that_states_nothing_is_unstated(read):
    tree, data = samples.gltf_tree()
    tree["materials"] = [{}, {"pbrMetallicRoughness": {"metallicFactor": 1}}]
    assert read("bare.glb", samples.glb(tree, data)).finishes == (UNSPECIFIED,)
