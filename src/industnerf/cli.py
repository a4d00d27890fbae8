"""The command line of every stage: paths in, one clear message out."""

import inspect
import os
import shutil
import sys
from collections.abc import Callable
from typing import Any

from industnerf import config, environment
from industnerf.errors import BadParams, SuiteError
from industnerf.runner import die_with_parent

BROKEN_PIPE = 141  # as a shell reports SIGPIPE


def run_as_stage(main: Callable[..., None], name: str) -> None:
    """Run `main(cfg, *arguments of the command line)` as the DVC stage `name`.

    `cfg` holds the parameters that dvc.yaml lists for the stage, and no others.
    """
    die_with_parent()
    arguments = sys.argv[1:]

    def job() -> None:
        _check_arguments(main, name, arguments)
        main(config.load_stage(name).select_params(config.load_params()), *arguments)

    exit_with_message(job)


def _check_arguments(main: Callable[..., None], name: str, arguments: list[str]) -> None:
    signature = inspect.signature(main)
    try:
        signature.bind(None, *arguments)
    except TypeError:
        expected = " ".join(parameter.upper() for parameter in list(signature.parameters)[1:])
        raise BadParams(
            f"python -m pipeline.stages.{name} takes {expected}, {len(arguments)} arguments were "
            f"given; `dvc repro {name}` gives it the right ones"
        ) from None


def run_command(main: Callable[..., None]) -> None:
    """Run `main(*arguments of the command line)`; --help prints what its module says.

    Keyword-only parameters are options: `min_opacity` is given as `--min-opacity VALUE`.
    Raises BadParams with the same text for another number of arguments.
    """
    arguments = sys.argv[1:]
    usage = sys.modules[main.__module__].__doc__

    def job() -> None:
        if "--help" in arguments or "-h" in arguments:
            print(usage)
            return
        signature = inspect.signature(main)
        positional, options = _split_options(arguments, signature)
        try:
            signature.bind(*positional, **options)
        except TypeError:
            raise BadParams(f"{len(positional)} arguments were given.\n\n{usage}") from None
        main(*positional, **options)

    exit_with_message(job)


def _split_options(
    arguments: list[str], signature: inspect.Signature
) -> tuple[list[str], dict[str, str]]:
    """The arguments without options, and the options by the names of their parameters."""
    flags = {
        f"--{name.replace('_', '-')}": name
        for name, parameter in signature.parameters.items()
        if parameter.kind is parameter.KEYWORD_ONLY
    }
    positional: list[str] = []
    options: dict[str, str] = {}
    rest = iter(arguments)
    for argument in rest:
        flag, _, value = argument.partition("=")
        if flag in flags:
            options[flags[flag]] = value or next(rest, "")
        else:
            positional.append(argument)
    return positional, options


def require_dvc() -> None:
    """Raises BadParams where the shell does not find `dvc`."""
    if shutil.which("dvc") is None:
        raise BadParams("`dvc` is not found: first `source .venv/bin/activate`")


def exit_with_message(job: Callable[[], Any]) -> None:
    """Run `job`; end with its refusal as text and exit code, or 130 after Ctrl-C."""
    try:
        environment.read_local_file()
        job()
    except SuiteError as error:
        print(f"error: {error}", file=sys.stderr)
        sys.exit(error.exit_code)
    except BrokenPipeError:  # `... --help | head` has read enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # or Python's end says so
        sys.exit(BROKEN_PIPE)
    except KeyboardInterrupt:
        print("interrupted; finished parts are kept, the same command goes on", file=sys.stderr)
        sys.exit(130)
