"""What a run writes, and that it costs a user nothing that is there."""

from collections.abc import Iterable
from pathlib import Path

from industnerf.artifacts.whole import check_folder
from industnerf.errors import BadArtifact
from industnerf.reconstruct.options import Options


def check_outputs(options: Options) -> None:
    """Raise BadArtifact if a file is in the way, or cannot be written, before any work is done."""
    outputs = _named(options)
    if len({path.resolve() for path in outputs.values()}) < len(outputs):
        raise BadArtifact(f"{', '.join(outputs)} must be different files")
    check_apart(options, [options.cameras])
    in_the_way = [path for path in (options.out, options.npz, options.mesh) if path]
    goes_on = options.checkpoint.exists() and not options.fresh  # then the preview is its own
    if options.preview_named and options.preview_every and not goes_on:
        in_the_way.append(options.preview)
    for path in in_the_way:
        if path.exists() and not (options.force or path.is_dir()):
            raise BadArtifact(f"{path} is there already; --force overwrites it")
    for option, path in outputs.items():
        check_folder(path, option)


def check_apart(options: Options, inputs: Iterable[Path]) -> None:
    """Raise BadArtifact if an output is one of `inputs`: --force is no leave to destroy those."""
    taken = {_identity(path) for path in inputs}
    for option, path in _named(options).items():
        if _identity(path) in taken:
            raise BadArtifact(
                f"{option} {path}: is an input of this run, which not even --force overwrites; "
                "name another file"
            )


def _named(options: Options) -> dict[str, Path]:
    """Every file that will be written, by the option that says where."""
    outputs = {"--out": options.out, "--checkpoint": options.checkpoint}
    outputs |= {"--preview": options.preview} if options.preview_every else {}
    outputs |= {"--npz": options.npz} if options.npz else {}
    return outputs | ({"--mesh": options.mesh} if options.mesh else {})


def _identity(path: Path) -> object:
    """Equal for two names of one file, be it by a link or on a disk that ignores case."""
    try:
        there = path.stat()
    except OSError:
        return path.resolve()
    return there.st_dev, there.st_ino
