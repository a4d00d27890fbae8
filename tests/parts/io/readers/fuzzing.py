"""Torn copies of the samples; in a module of its own, so that child processes can import it."""

import io
import re
import warnings
import zipfile
from pathlib import Path

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from industnerf.artifacts.solids import Solids
from industnerf.errors import BadPart
from industnerf.parts.io.readers import read_solids
from tests.parts.io.readers.samples import SAMPLES, zipped

EXAMPLES = 60
HUGE = (b"\xff\xff\xff\xff", b"\xff\xff\xff\x7f", b"\0\0\0\x80", b"\xff\xff\0\0")
NONSENSE_NUMBERS = (
    b"4294967295",
    b"99999999999999999999",
    b"-1",
    b"1e999",
    b"nan",
    b"",
    b"\0",
    b"\xff",
)


@st.composite
def torn_bytes(draw, whole: bytes) -> bytes:
    """`whole`, cut short, with bits flipped, counts made huge, and numbers made nonsense."""
    data = bytearray(whole)
    for _ in range(draw(st.integers(0, 3))):
        position = draw(st.integers(0, len(data) - 1))
        data[position] ^= 1 << draw(st.integers(0, 7))
    if draw(st.booleans()):
        position, huge = draw(st.integers(0, len(data) - 4)), draw(st.sampled_from(HUGE))
        data[position : position + 4] = huge
    numbers = list(re.finditer(rb"-?\d+(\.\d+)?", bytes(data)))
    if numbers and draw(st.booleans()):
        number = draw(st.sampled_from(numbers))
        data[number.start() : number.end()] = draw(st.sampled_from(NONSENSE_NUMBERS))
    return bytes(data[: draw(st.integers(0, len(data)))] if draw(st.booleans()) else data)


@st.composite
def torn_file(draw, whole: bytes) -> bytes:
    """`whole` torn; an archive is torn from outside, or in one of its members."""
    if not whole.startswith(b"PK") or draw(st.integers(0, 3)) == 0:
        return draw(torn_bytes(whole))
    with zipfile.ZipFile(io.BytesIO(whole)) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    name = draw(st.sampled_from(sorted(members)))
    return zipped(members | {name: draw(torn_bytes(members[name]))})


def fuzz(name: str, folder: Path) -> None:
    """Read `EXAMPLES` torn copies of the sample; anything but solids or a BadPart raises."""
    warnings.simplefilter("error")  # as in the suite
    path = folder / name

    @settings(
        max_examples=EXAMPLES,
        derandomize=True,
        deadline=None,
        database=None,
        suppress_health_check=list(HealthCheck),
    )
    @given(torn_file(SAMPLES[name]))
    def check(content: bytes) -> None:
        path.write_bytes(content)
        try:
            solids = read_solids(path, "mm")
        except BadPart as error:
            if not str(error).startswith(f"{name}: ") or "\n" in str(error):
                raise AssertionError(f"not one sentence that names the file: {error}") from None
            return
        solids.save(folder)
        Solids.load(folder)  # which looks at every index

    check()
