"""Zip containers and XML, opened so that a small file cannot unfold into a huge one."""

import io
import zipfile
from pathlib import Path
from typing import Any

from industnerf.errors import BadPart

MAX_RATIO, FREE_BYTES = (
    200,
    1 << 20,
)  # meshes as XML shrink 10 to 30 times; small files are left alone


def read_archive(path: Path) -> dict[str, bytes]:
    """Every file of the zip at `path`; raises BadPart if it is torn, locked or a bomb.

    Python reads no more of a member than its header promises, so the promises can be added up.
    """
    size = path.stat().st_size
    try:
        with zipfile.ZipFile(path) as archive:
            declared = sum(member.file_size for member in archive.infolist())
            if declared > FREE_BYTES + MAX_RATIO * size:
                raise BadPart(
                    f"the archive of {size} bytes unfolds to {declared}: more than "
                    f"{MAX_RATIO} times"
                )
            return {name: archive.read(name) for name in archive.namelist() if name[-1:] != "/"}
    except (zipfile.BadZipFile, RuntimeError, NotImplementedError, EOFError, OSError) as error:
        raise BadPart(f"its archive cannot be unpacked: {error}") from None
    except zipfile.zlib.error as error:
        raise BadPart(f"its archive cannot be unpacked: {error}") from None


def parse_xml(data: bytes) -> Any:
    """The root of an XML text; entities stay unexpanded, nothing is fetched."""
    from lxml import etree

    reject_entities(data)
    parser = etree.XMLParser(resolve_entities=False, no_network=True, huge_tree=True)
    try:
        return etree.parse(io.BytesIO(data), parser).getroot()
    except etree.XMLSyntaxError as error:
        raise BadPart(f"its XML is broken: {error}") from None


def reject_entities(data: bytes) -> None:
    """Raise BadPart if the XML text declares entities: no CAD format needs them, bombs do."""
    if b"<!ENTITY" in data:
        raise BadPart("its XML declares entities, which no CAD program writes")
