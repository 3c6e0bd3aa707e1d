"""Scripts that read the tables of a bundle: in R, in Python (nothing but Python is needed) and in
SPSS. They label what the codebook labels.
"""

from __future__ import annotations

from collections.abc import Sequence

from woz_tui.features.bundle.codebook import ANSWERS, Variable
from woz_tui.features.bundle.data_tables import table_file

_PYTHON = '''\
"""Means of all items by condition: of each participant the mean, then the mean over participants;
of choices, whose codes have no order, how often each was made.

Run it in any place: python3 analysis/read.py
"""
import csv
from collections import Counter, defaultdict
from pathlib import Path

TABLE = Path(__file__).resolve().parents[1] / "{table}"
CHOICES = {choices}

with TABLE.open(encoding="utf-8", newline="") as file:
    rows = list(csv.DictReader(file))
keys = ("participant", "session", "condition", "round")
values = defaultdict(lambda: defaultdict(list))
for row in rows:
    for item in (name for name in row if name not in (*keys, *CHOICES) and row[name] != ""):
        values[item, row["condition"]][row["participant"]].append(float(row[item]))
print("item,condition,n,mean")
for (item, condition), people in sorted(values.items()):
    means = [sum(each) / len(each) for each in people.values()]
    print(f"{{item}},{{condition}},{{len(means)}},{{sum(means) / len(means):.4f}}")
for item in CHOICES:
    print("\\nitem,condition,value,count")
    made = Counter((row["condition"], int(row[item])) for row in rows if row[item] != "")
    for (condition, value), count in sorted(made.items()):
        print(f"{{item}},{{condition}},{{value}},{{count}}")
'''

_R = """\
# Reads the answers with their labels. From the folder of the bundle: Rscript analysis/read.R
answers <- read.csv("{table}", na.strings = "", fileEncoding = "UTF-8",
                    stringsAsFactors = FALSE, check.names = TRUE)
answers$condition <- factor(answers$condition)
labels <- list(
{labels}
)
for (name in names(labels)) attr(answers[[name]], "label") <- labels[[name]]
{values}
# Means of participants by condition, item by item
choices <- c({choices})  # codes without an order: counted
items <- setdiff(names(answers), c("participant", "session", "condition", "round", choices))
for (item in items) {{
  each <- answers[!is.na(answers[[item]]), ]
  if (nrow(each) == 0) next
  each$condition <- factor(ifelse(is.na(each$condition), "", as.character(each$condition)))
  people <- aggregate(each[[item]], list(participant = each$participant,
                                         condition = each$condition), mean)
  print(aggregate(people$x, list(item = rep(item, nrow(people)),
                                 condition = people$condition), mean))
}}
for (item in choices) {{
  condition <- ifelse(is.na(answers$condition), "", as.character(answers$condition))
  cat("\\n", item, "\\n")
  print(table(condition = condition, value = answers[[item]]))
}}
# A model to begin with, for scores: lme4::lmer(score ~ condition + (1 | participant), data)
# for single items: ordinal::clmm(factor(item) ~ condition + (1 | participant), data)
"""

_SPSS = """\
* Reads the answers with their labels. Set the folder of the bundle first: CD 'FOLDER'.
GET DATA /TYPE=TXT /FILE='{table}' /ENCODING='UTF8' /ARRANGEMENT=DELIMITED
  /DELIMITERS=',' /QUALIFIER='"' /FIRSTCASE=2
  /VARIABLES={variables}.
{labels}
EXECUTE.
"""


def python_script(study: str, items: Sequence[Variable]) -> str:
    """Reproduces means of the report."""
    return _PYTHON.format(table=table_file(study, ANSWERS), choices=_choices(items))


def _choices(items: Sequence[Variable]) -> tuple[str, ...]:
    """Names of variables whose numbers have no order."""
    return tuple(
        each.name
        for each in items
        if each.of is not None and each.of.item.asks == "choice" and not each.withheld
    )


def r_script(study: str, items: Sequence[Variable]) -> str:
    """Reads and labels the answers."""
    shown = [each for each in items if not each.withheld]
    labels = ",\n".join(f"  {each.name} = {_quoted(each.label)}" for each in shown)
    values = "\n".join(
        f'attr(answers${each.name}, "labels") <- c('
        + ", ".join(f"{_quoted(label)} = {value}" for value, label in each.labels.items())
        + ")"
        for each in shown
        if each.labels
    )
    choices = ", ".join(map(_quoted, _choices(items)))
    table = table_file(study, ANSWERS)
    return _R.format(table=table, labels=labels, values=values, choices=choices)


def spss_script(study: str, items: Sequence[Variable]) -> str:
    """Reads and labels the answers."""
    shown = [each for each in items if not each.withheld]
    keys = [("participant", "A16"), ("session", "A16"), ("condition", "A64"), ("round", "F4")]
    columns = [*keys, *((each.name, "F8.2" if each.is_score else "F8") for each in shown)]
    variables = " ".join(f"{name} {form}" for name, form in columns)
    labels = []
    for each in shown:
        labels.append(f"VARIABLE LABELS {each.name} {_spss(each.label)}.")
        if each.labels:
            named = " ".join(f"{value} {_spss(label)}" for value, label in each.labels.items())
            labels.append(f"VALUE LABELS {each.name} {named}.")
        labels.append(f"VARIABLE LEVEL {each.name} ({_level(each)}).")
    return _SPSS.format(
        table=table_file(study, ANSWERS), variables=variables, labels="\n".join(labels)
    )


def _level(each: Variable) -> str:
    """Codes of choices have no order; points of a scale have one; what is counted has distances."""
    if each.low is None and not each.is_score:
        return "NOMINAL"
    return "ORDINAL" if each.labels else "SCALE"


def _quoted(text: str) -> str:
    plain = " ".join(text.split()).replace("\\", "\\\\").replace('"', '\\"')
    return f'"{plain}"'


def _spss(text: str) -> str:
    return "'" + " ".join(text.split()).replace("'", "''") + "'"
