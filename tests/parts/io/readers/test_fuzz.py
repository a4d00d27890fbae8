"""Files that were cut, flipped and lied to: solids or a BadPart, in bounded memory and time.

The examples of one format run in one child process of 1.5 GB of addresses and two minutes: what
allocates by a promise, hangs or dies ends that child, and the test.
"""

from functools import partial

import pytest

from industnerf.runner import ProcessRunner
from tests.parts.io.readers.fuzzing import fuzz
from tests.parts.io.readers.samples import SAMPLES

MEMORY_MB, SECONDS = 1500, 120.0


@pytest.mark.parametrize("name", SAMPLES)
def test_a_torn_file_is_read_or_refused(name, tmp_path):
    (outcome,) = ProcessRunner(1).map([partial(fuzz, name, tmp_path)], SECONDS, MEMORY_MB)
    assert outcome.error is None
