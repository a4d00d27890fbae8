"""Everything the suite refuses, and nothing else, derives from `SuiteError`.

SuiteError            shown to the user as one message, without a traceback
|- BadParams          params.yaml, a preset or a command-line override
|  |- BadValue               a value out of its range, named within its section
|  `- UndeclaredParameter   a stage reads a key that its `params:` in dvc.yaml does not list
|- BadPart            a CAD file or a mesh that cannot become a part
|- BadArtifact        a file between stages that is missing, torn or of another schema
|- UndeclaredInput    a method reaches for an input that it does not declare
|- ReconstructionFailed     a method gave no usable cloud
|  `- RegionInsteadOfPart      it gave the ball about the part, or a piece of the scene
|- MetricError        a score that cannot be computed exactly
`- PartsFailed        some parts of a stage failed; the others are stored
"""

from typing import ClassVar

BAD_INPUT = 2  # as argparse ends


class SuiteError(Exception):
    """A refusal whose text says what, where, how much, and which setting to change."""

    exit_code: ClassVar[int] = 1  # of a command that ends with it


class BadParams(SuiteError):
    exit_code = BAD_INPUT


class BadValue(BadParams):
    pass


class UndeclaredParameter(BadParams):
    pass


class BadPart(SuiteError):
    exit_code = BAD_INPUT


class BadArtifact(SuiteError):
    exit_code = BAD_INPUT


class UndeclaredInput(SuiteError):
    pass


class ReconstructionFailed(SuiteError):
    pass


class RegionInsteadOfPart(ReconstructionFailed):
    exit_code = 3


class MetricError(SuiteError):
    pass


class PartsFailed(SuiteError):
    pass
