"""How a value of params.yaml is refused."""

from industnerf.errors import BadParams


def require(holds: bool, key: str, value: object, rule: str) -> None:
    """Raise BadParams unless `holds`."""
    if not holds:
        raise BadParams(f"params.yaml: {key} is {value!r}, must be {rule}")
