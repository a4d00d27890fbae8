"""Files of the samples, and reading in one word."""

import pytest

from industnerf.parts.io.readers import read_solids
from tests.parts.io.readers.samples import MTL


@pytest.fixture
def read(tmp_path):
    """Write bytes under a name, and read them."""

    def read(name, content, units="mm"):
        (tmp_path / name).write_bytes(content)
        return read_solids(tmp_path / name, units)

    (tmp_path / "box.mtl").write_bytes(MTL)
    return read
