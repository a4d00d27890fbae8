"""What a misspelled key, method or preset may have meant."""

from collections.abc import Iterable
from difflib import SequenceMatcher

MIN_SIMILARITY = 0.7  # of difflib; `cuont` has 0.8 of `count`
CONTAINED_SIMILARITY = 0.75  # of a name to a longer one that has it in it: `views`, `sweep-views`
MIN_CONTAINED = 4  # letters of such a name
TIE, MAX_SHOWN = 0.05, 3  # names so much less similar than the best are shown too, up to so many


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Such as ", did you mean `views.count`?"; empty where nothing of `known` is similar.

    Of a dotted key the last sections may be all that was written.
    """
    closest = closest_names(name, known)
    return f", did you mean {' or '.join(f'`{key}`' for key in closest)}?" if closest else ""


def closest_names(name: str, known: Iterable[str]) -> list[str]:
    """Those of `known` that are most similar to `name`, the best first."""
    similarities = {key: _similarity(name.lower(), key.lower()) for key in known}
    best = max(similarities.values(), default=0.0)
    if best < MIN_SIMILARITY:
        return []
    close = [key for key, value in similarities.items() if value > best - TIE]
    return sorted(close, key=lambda key: -similarities[key])[:MAX_SHOWN]


def _similarity(name: str, key: str) -> float:
    """Of `name` to `key`, or to as many of its last sections."""
    last_sections = ".".join(key.split(".")[-len(name.split(".")) :])
    shortened = TIE * (last_sections != key)
    contained = CONTAINED_SIMILARITY * (len(name) >= MIN_CONTAINED and name in last_sections)
    return max(contained, _ratio(name, key), _ratio(name, last_sections) - shortened)


def _ratio(left: str, right: str) -> float:
    matcher = SequenceMatcher(None, left, right, autojunk=False)
    if matcher.real_quick_ratio() < MIN_SIMILARITY:
        return 0.0
    return matcher.ratio()
