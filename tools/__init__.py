"""Programs that draw the pictures of docs/ and write those pages that come from the code.

Each runs by itself: `python -m tools.experiment_reference`. Tests keep the pages fresh.
"""

from pathlib import Path

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
IMAGES = DOCS / "images"
EXPERIMENTS = ROOT / "experiments"


def replaced(page: str, begin: str, end: str, text: str) -> str:
    """`page` with `text` between two marks. Raises `ValueError` if it lacks them."""
    before, _, rest = page.partition(begin)
    _, found, after = rest.partition(end)
    if not found:
        raise ValueError(f"the page has no marks {begin} and {end}")
    return f"{before}{begin}\n\n{text}\n\n{end}{after}"
