"""Programs that write and draw what docs/ shows.

`python -m tools.generated` (`make generated`) writes every page, table and schema that comes from
the code. The others draw pictures (`make screenshots`) or record sessions, each by its name.
"""

from pathlib import Path

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
IMAGES = DOCS / "images"
EXPERIMENTS = ROOT / "experiments"


def replaced(page: str, name: str, text: str) -> str:
    """`page` with `text` between its marks of that name. Raises `ValueError` if it lacks them."""
    begin, end = f"<!-- {name}: begin -->", f"<!-- {name}: end -->"
    before, _, rest = page.partition(begin)
    _, found, after = rest.partition(end)
    if not found:
        raise ValueError(f"the page has no marks {begin} and {end}")
    return f"{before}{begin}\n\n{text}\n\n{end}{after}"
