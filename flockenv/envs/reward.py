"""Terms of the reward. Their values come from the Rust core; weights are options."""

from flockenv import _core

__all__ = ["TERMS", "terms_table"]

#: Name and meaning of each term; every term is larger for better.
TERMS: dict[str, str] = dict(_core.REWARD_TERMS)


def terms_table() -> str:
    """Return the terms as a Markdown table."""
    lines = ["| term | meaning |", "| --- | --- |"]
    return "\n".join(lines + [f"| `{name}` | {meaning} |" for name, meaning in TERMS.items()])
