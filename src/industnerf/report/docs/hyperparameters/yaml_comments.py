"""What the comments of params.yaml say of each key."""

import re

KEY = re.compile(r"^(?P<indent> *)(?P<dash>- )?(?P<key>\w+):(?P<rest>.*)$")
COMMENT = re.compile(r"\s#\s+(.*)$")
ALTERNATIVE = re.compile(r"\w+: ")
# Methods that share their settings' names, and the one beside which they are explained.
EXPLAINED_BY = dict.fromkeys(
    ("industnerf_plus", "industnerf_depth", "industnerf_shared", "nerf"), "industnerf"
)
LIST_INDEX = re.compile(r"\[\d+\]")


def parse_comments(text: str) -> dict[str, str]:
    """Dotted key -> comment, of values and of sections.

    A comment stands behind its key and may go on in indented lines; that of a top-level key may
    stand in a line before it.  `text` is in block style as params.yaml is: members of a list of
    sections begin with a dash.
    """
    parsed: dict[str, str] = {}
    open_sections: list[tuple[int, str]] = []  # sections that are open, with their indents
    member_counts: dict[str, int] = {}
    last_key = preceding = ""
    for line in text.splitlines():
        match = KEY.match(line)
        if match:
            indent = len(match["indent"])
            open_sections = [(i, name) for i, name in open_sections if i < indent]
            parent = open_sections[-1][1] if open_sections else ""
            if match["dash"]:
                index = member_counts[parent] = member_counts.get(parent, -1) + 1
                parent, indent = f"{parent}[{index}]", indent + 2
                open_sections.append((indent - 2, parent))
            last_key = f"{parent}.{match['key']}" if parent else match["key"]
            open_sections.append((indent, last_key))
            comment = COMMENT.search(match["rest"])
            parsed[last_key] = " ".join((comment[1] if comment else preceding).split())
            preceding = ""
        elif not line.startswith(" "):
            preceding = line.strip("# ")
        elif last_key and line.strip().startswith("#"):
            parsed[last_key] = _join_lines(parsed[last_key], line.strip("# "))
    return parsed


def _join_lines(text: str, continuation: str) -> str:
    """A further line goes on with the sentence, or it is the next `value: what it means`."""
    return f"{text}{'; ' if ALTERNATIVE.match(continuation) else ' '}{continuation}".strip()


def find_meaning(key: str, comments: dict[str, str]) -> str:
    """What `key` means: its own comment, or where it has none that of the key it stands for.

    That is the first member of a list for the others, and for the NeRFs the paper's method.
    """
    head, _, rest = key.partition(".")
    method, _, subkey = rest.partition(".")
    first_member = LIST_INDEX.sub("[0]", key)
    candidates = [key, first_member]
    if head == "method" and method in EXPLAINED_BY:
        equivalent = f"method.{EXPLAINED_BY[method]}.{subkey}"
        candidates += [equivalent, LIST_INDEX.sub("[0]", equivalent)]
    return next((comments[name] for name in candidates if comments.get(name)), "")
