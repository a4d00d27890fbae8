"""What a run writes, and that it costs a user nothing that is there."""

from collections.abc import Iterable
from pathlib import Path

from industnerf.artifacts.files import check_writable
from industnerf.errors import BadArtifact
from industnerf.reconstruct.cli import Options


def check_outputs(options: Options) -> None:
    """Raise BadArtifact if a file is in the way, or cannot be written, before any work is done."""
    outputs = _output_paths(options)
    if len({path.resolve() for path in outputs.values()}) < len(outputs):
        raise BadArtifact(f"{', '.join(outputs)} must be different files")
    check_not_inputs(options, [options.cameras])
    overwritten = [path for path in (options.out, options.npz, options.mesh) if path]
    is_resuming = (
        options.checkpoint.exists() and not options.no_resume
    )  # then the preview is its own
    if options.has_explicit_preview and options.preview_every and not is_resuming:
        overwritten.append(options.preview)
    for path in overwritten:
        if path.exists() and not (options.force or path.is_dir()):
            raise BadArtifact(f"{path} is there already; --force overwrites it")
    for option, path in outputs.items():
        check_writable(path, option)


def check_not_inputs(options: Options, inputs: Iterable[Path]) -> None:
    """Raise BadArtifact if an output is one of `inputs`: --force is no leave to destroy those."""
    input_ids = {_file_id(path) for path in inputs}
    for option, path in _output_paths(options).items():
        if _file_id(path) in input_ids:
            raise BadArtifact(
                f"{option} {path}: is an input of this run, which not even --force overwrites; "
                "name another file"
            )


def _output_paths(options: Options) -> dict[str, Path]:
    """Every file that will be written, by the option that says where."""
    outputs = {"--out": options.out, "--checkpoint": options.checkpoint}
    outputs |= {"--preview": options.preview} if options.preview_every else {}
    outputs |= {"--npz": options.npz} if options.npz else {}
    return outputs | ({"--mesh": options.mesh} if options.mesh else {})


def _file_id(path: Path) -> object:
    """Equal for two names of one file, be it by a link or on a disk that ignores case."""
    try:
        stat = path.stat()
    except OSError:
        return path.resolve()
    return stat.st_dev, stat.st_ino
