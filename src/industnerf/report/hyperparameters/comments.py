"""What the comments of params.yaml say of each key."""

import re

KEY = re.compile(r"^(?P<indent> *)(?P<dash>- )?(?P<key>\w+):(?P<rest>.*)$")
COMMENT = re.compile(r"\s#\s+(.*)$")
ALTERNATIVE = re.compile(r"\w+: ")
# Methods that share their settings' names, and the one beside which they are explained.
EXPLAINED_BY = dict.fromkeys(
    ("industnerf_plus", "industnerf_depth", "industnerf_shared", "nerf"), "industnerf"
)
ITEM = re.compile(r"\[\d+\]")


def comments(text: str) -> dict[str, str]:
    """Dotted key -> comment, of values and of sections.

    A comment stands behind its key and may go on in indented lines; that of a top-level key may
    stand in a line before it.  `text` is in block style as params.yaml is: members of a list of
    sections begin with a dash.
    """
    found: dict[str, str] = {}
    above: list[tuple[int, str]] = []  # sections that are open, with their indents
    members: dict[str, int] = {}
    last = before = ""
    for line in text.splitlines():
        match = KEY.match(line)
        if match:
            indent = len(match["indent"])
            above = [(i, name) for i, name in above if i < indent]
            parent = above[-1][1] if above else ""
            if match["dash"]:
                index = members[parent] = members.get(parent, -1) + 1
                parent, indent = f"{parent}[{index}]", indent + 2
                above.append((indent - 2, parent))
            last = f"{parent}.{match['key']}" if parent else match["key"]
            above.append((indent, last))
            comment = COMMENT.search(match["rest"])
            found[last] = " ".join((comment[1] if comment else before).split())
            before = ""
        elif not line.startswith(" "):
            before = line.strip("# ")
        elif last and line.strip().startswith("#"):
            found[last] = _joined(found[last], line.strip("# "))
    return found


def _joined(text: str, further: str) -> str:
    """A further line goes on with the sentence, or it is the next `value: what it means`."""
    return f"{text}{'; ' if ALTERNATIVE.match(further) else ' '}{further}".strip()


def meaning(key: str, said: dict[str, str]) -> str:
    """What `key` means: its own comment, or where it has none that of the key it stands for.

    That is the first member of a list for the others, and for the NeRFs the paper's method.
    """
    head, _, rest = key.partition(".")
    method, _, below = rest.partition(".")
    first = ITEM.sub("[0]", key)
    candidates = [key, first]
    if head == "method" and method in EXPLAINED_BY:
        twin = f"method.{EXPLAINED_BY[method]}.{below}"
        candidates += [twin, ITEM.sub("[0]", twin)]
    return next((said[name] for name in candidates if said.get(name)), "")
