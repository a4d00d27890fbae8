"""A box of 30 x 20 x 10, red above and blue elsewhere, written in every format by hand.

Nothing here comes from the readers, and no file is kept: each is a few hundred bytes.
"""

import io
import json
import struct
import zipfile

import numpy as np

SIZE = (30.0, 20.0, 10.0)
RED, BLUE = (255, 0, 0), (0, 0, 128)  # sRGB
CORNERS = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * SIZE
# Counter-clockwise seen from outside; the last quad is the top.
QUADS = np.array(
    [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
)
FACES = np.array([t for a, b, c, d in QUADS for t in ((a, b, c), (a, c, d))])
TOP = np.arange(12) >= 10
# Where x, y, z of the box lie in a file whose up is another axis: each keeps its right hand on +x.
UP_CORNERS = {
    "X_UP": np.stack([CORNERS[:, 2], -CORNERS[:, 0], -CORNERS[:, 1]], axis=1),
    "Y_UP": np.stack([CORNERS[:, 0], CORNERS[:, 2], -CORNERS[:, 1]], axis=1),
    "Z_UP": CORNERS,
}


def binary_stl(vertices=CORNERS, faces=FACES, header=b"", count=None):
    record = np.zeros(len(faces), [("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    record["v"] = np.asarray(vertices)[faces]
    count = len(faces) if count is None else count
    return header.ljust(80, b"\0") + struct.pack("<I", count) + record.tobytes()


def text_stl(name="box", number="{:.6f}"):
    lines = [f"solid {name}"]
    for face in FACES:
        rows = [" ".join(number.format(x) for x in CORNERS[i]) for i in face]
        lines += ["facet normal 0 0 0", "outer loop", *(f"vertex {row}" for row in rows)]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, f"endsolid {name}", ""]).encode()


def obj(materials="box.mtl"):
    lines = [f"mtllib {materials}", "o box", *(f"v {x} {y} {z}" for x, y, z in CORNERS)]
    for quad, material in zip(QUADS, 5 * ["blue"] + ["red"], strict=True):
        lines += [f"usemtl {material}", "f " + " ".join(str(i + 1) for i in quad)]
    return "\n".join([*lines, ""]).encode()


MTL = b"newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 0.501961\n"


def off():
    rows = [f"{x} {y} {z}" for x, y, z in CORNERS]
    for quad, color in zip(QUADS, 5 * [BLUE] + [RED], strict=True):
        rows.append(f"4 {' '.join(map(str, quad))} {' '.join(map(str, color))}")
    return "\n".join(["OFF", "8 6 0", *rows, ""]).encode()


def ply(text=False, number="float", faces=12, vertices=8):
    kind = "ascii" if text else "binary_little_endian"
    head = [
        "ply",
        f"format {kind} 1.0",
        f"element vertex {vertices}",
        *(f"property {number} {axis}" for axis in "xyz"),
        f"element face {faces}",
        "property list uchar int vertex_indices",
        *(f"property uchar {name}" for name in ("red", "green", "blue")),
        "end_header",
    ]
    rows = [(*face, *(RED if top else BLUE)) for face, top in zip(FACES, TOP, strict=True)]
    if text:
        body = "".join(f"{x} {y} {z}\n" for x, y, z in CORNERS)
        body += "".join(f"3 {' '.join(map(str, row))}\n" for row in rows)
        return ("\n".join(head) + "\n" + body).encode()
    data = CORNERS.astype("<f4" if number == "float" else "<f8").tobytes()
    data += b"".join(struct.pack("<B3i3B", 3, *row) for row in rows)
    return ("\n".join(head) + "\n").encode() + data


def gltf_tree(uri=None):
    """JSON and buffer of two primitives, one per color, in meters, y up."""
    parts = [FACES[~TOP], FACES[TOP]]
    data = (UP_CORNERS["Y_UP"] / 1000).astype("<f4").tobytes()
    views, accessors = [{"buffer": 0, "byteOffset": 0, "byteLength": 96}], []
    accessors.append({"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"})
    for faces in parts:
        flat = faces.astype("<u2").tobytes()
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(flat)})
        accessors.append(
            {
                "bufferView": len(views) - 1,
                "componentType": 5123,
                "count": faces.size,
                "type": "SCALAR",
            }
        )
        data += flat
    factors = [(0, 0, 0.215861, 1), (1, 0, 0, 1)]  # linear: 128/255 in sRGB is 0.215861
    materials = [{"pbrMetallicRoughness": {"baseColorFactor": list(f)}} for f in factors]
    primitives = [
        {"attributes": {"POSITION": 0}, "indices": i + 1, "material": i} for i in range(2)
    ]
    tree = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "box"}],
        "meshes": [{"primitives": primitives}],
        "materials": materials,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(data)} | ({"uri": uri} if uri else {})],
    }
    return tree, data


def glb(tree=None, data=None):
    if tree is None:
        tree, data = gltf_tree()
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    chunks += struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def zipped(files):
    memory = io.BytesIO()
    with zipfile.ZipFile(memory, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(zipfile.ZipInfo(name), data, zipfile.ZIP_DEFLATED)
    return memory.getvalue()


def threemf(unit="millimeter", build='<item objectid="1"/>', extra_objects="", paint=True):
    vertex_xml = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in CORNERS)
    rows = [
        f'<triangle v1="{a}" v2="{b}" v3="{c}"' + (f' pid="2" p1="{int(top)}"/>' if paint else "/>")
        for (a, b, c), top in zip(FACES, TOP, strict=True)
    ]
    model = (
        f'<?xml version="1.0"?><model unit="{unit}" '
        'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" '
        'xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02"><resources>'
        '<m:colorgroup id="2"><m:color color="#000080"/><m:color color="#FF0000FF"/></m:colorgroup>'
        f'<object id="1" name="box" type="model"><mesh><vertices>{vertex_xml}</vertices>'
        f"<triangles>{''.join(rows)}</triangles></mesh></object>{extra_objects}</resources>"
        f"<build>{build}</build></model>"
    )
    return zipped({"3D/3dmodel.model": model.encode()})


def dae(unit='<unit name="meter" meter="1"/>', scale=1000, up=None):
    """Without `up` the file is silent of it, which means Y_UP."""
    numbers = " ".join(str(x / scale) for x in UP_CORNERS[up or "Y_UP"].ravel())
    up_axis = f"<up_axis>{up}</up_axis>" if up else ""

    def material(name, color):
        return (
            f'<effect id="{name}-e"><profile_COMMON><technique sid="t"><lambert><diffuse>'
            f"<color>{color} 1</color></diffuse></lambert></technique></profile_COMMON></effect>"
        )

    def triangles(name, faces):
        indices = " ".join(map(str, faces.ravel()))
        return (
            f'<triangles count="{len(faces)}" material="{name}"><input semantic="VERTEX" '
            f'source="#v" offset="0"/><p>{indices}</p></triangles>'
        )

    names = ("red", "blue")
    library = "".join(
        f'<material id="{n}"><instance_effect url="#{n}-e"/></material>' for n in names
    )
    bind = "".join(f'<instance_material symbol="{n}" target="#{n}"/>' for n in names)
    return (
        '<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" '
        f'version="1.4.1"><asset><created>2020-01-01T00:00:00Z</created>'
        f"<modified>2020-01-01T00:00:00Z</modified>{unit}{up_axis}</asset><library_effects>"
        f"{material('red', '1 0 0')}{material('blue', '0 0 0.501961')}</library_effects>"
        f"<library_materials>{library}</library_materials><library_geometries>"
        '<geometry id="g" name="box"><mesh><source id="p">'
        f'<float_array id="pa" count="24">{numbers}'
        '</float_array><technique_common><accessor source="#pa" count="8" stride="3">'
        '<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>'
        '</accessor></technique_common></source><vertices id="v"><input semantic="POSITION" '
        f'source="#p"/></vertices>{triangles("red", FACES[TOP])}{triangles("blue", FACES[~TOP])}'
        '</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s">'
        '<node id="n"><instance_geometry url="#g"><bind_material><technique_common>'
        f"{bind}</technique_common></bind_material></instance_geometry></node></visual_scene>"
        '</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>'
    ).encode()


def threedxml():
    space = 'xmlns="http://www.3ds.com/xsd/3DXML"'

    def face(faces, red, blue):
        return (
            f'<Face triangles="{" ".join(map(str, faces.ravel()))}"><SurfaceAttributes>'
            f'<Color red="{red}" green="0" blue="{blue}" '
            'xsi:type="RGBAColorType" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"/>'
            "</SurfaceAttributes></Face>"
        )

    positions = ",".join(f"{x} {y} {z}" for x, y, z in CORNERS)
    rep = (
        f"<XMLRepresentation {space}><Root><Rep><Faces>{face(FACES[TOP], 1, 0)}"
        f"{face(FACES[~TOP], 0, 0.50197)}</Faces><VertexBuffer><Positions>{positions}</Positions>"
        f"<Normals>{positions}</Normals></VertexBuffer></Rep></Root></XMLRepresentation>"
    )
    tree = (
        f'<Model_3dxml {space}><ProductStructure root="1"><Reference3D id="1" name="box"/>'
        '<ReferenceRep id="2" format="TESSELLATED" associatedFile="urn:3DXML:box.3DRep" name="r"/>'
        '<InstanceRep id="3" name="i"><IsAggregatedBy>1</IsAggregatedBy><IsInstanceOf>2'
        "</IsInstanceOf></InstanceRep></ProductStructure></Model_3dxml>"
    )
    manifest = f"<Manifest {space}><Root>tree.3dxml</Root></Manifest>"
    return zipped({"Manifest.xml": manifest, "tree.3dxml": tree, "box.3DRep": rep})


SAMPLES = {
    "binary.stl": binary_stl(),
    "text.stl": text_stl(),
    "box.obj": obj(),
    "box.off": off(),
    "binary.ply": ply(),
    "text.ply": ply(text=True),
    "box.glb": glb(),
    "box.3mf": threemf(),
    "box.dae": dae(),
    "box.zae": zipped({"box.dae": dae(up="Z_UP")}),
    "box.3dxml": threedxml(),
}
