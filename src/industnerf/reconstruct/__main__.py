"""Run the method on posed photographs of your own.

python -m industnerf.reconstruct --cameras transforms.json --images DIR --out cloud.ply

The cloud is in the frame and the unit of the cameras.  An interrupted run goes on where it was
when the same command is given again, without --no-resume.  Exit code: 0, 1 if the method finds no
surface, 2 if what it was given is wrong, 3 if the result is written and is not the part, 130 after
Ctrl-C.
"""

import sys
import time

from industnerf import environment
from industnerf.errors import SuiteError
from industnerf.reconstruct.cli import Options, parse_args
from industnerf.runner.device import check_device


def main() -> int:
    start_time = time.time()
    options = parse_args(sys.argv[1:], __doc__)
    try:
        environment.read_local_file()
        check_device(here=True)
        from industnerf.reconstruct.main import reconstruct  # late: --help needs none of it

        reconstruct(options)
    except SuiteError as error:
        print(f"error: {error}", file=sys.stderr)
        return error.exit_code
    except KeyboardInterrupt:
        print(f"interrupted; {_resume_hint(options, start_time)}", file=sys.stderr)
        return 130
    return 0


def _resume_hint(options: Options, start_time: float) -> str:
    """What is kept, and how to go on; `start_time` is when this run began."""
    path = options.checkpoint
    if not path.exists() or (options.no_resume and path.stat().st_mtime < start_time):
        return "nothing of this run is kept"
    command = "the same command without --no-resume" if options.no_resume else "the same command"
    return f"{command} goes on from {options.checkpoint}"


if __name__ == "__main__":
    sys.exit(main())
