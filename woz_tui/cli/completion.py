"""`woz completion SHELL`: what completes commands, options and files in a shell."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from pathlib import Path

#: Files that `tools/completions.py` writes, as `woz.bash`.
FOLDER = Path(__file__).with_name("completions")
SHELLS = ("bash", "zsh", "fish")

_EXAMPLES = """\
once, then open a new terminal:
  bash  mkdir -p ~/.local/share/bash-completion/completions
        woz completion bash > ~/.local/share/bash-completion/completions/woz
  zsh   mkdir -p ~/.zfunc && woz completion zsh > ~/.zfunc/_woz
        in ~/.zshrc, before compinit: fpath+=~/.zfunc
  fish  woz completion fish > ~/.config/fish/completions/woz.fish

Once more after a newer version was installed."""


def add(parser: ArgumentParser) -> None:
    parser.formatter_class = RawDescriptionHelpFormatter
    parser.epilog = _EXAMPLES
    parser.add_argument("shell", choices=SHELLS, metavar="SHELL", help=", ".join(SHELLS))


def run(arguments: Namespace) -> int:
    """Print the file of the shell."""
    sys.stdout.write((FOLDER / f"woz.{arguments.shell}").read_text(encoding="utf-8"))
    return 0
