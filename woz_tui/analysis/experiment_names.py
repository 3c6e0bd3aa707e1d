"""Which sessions are of one experiment."""

from __future__ import annotations

from dataclasses import dataclass, field

from woz_tui.analysis.figures import SessionFigures


def file_of(experiment: str) -> str:
    """The name of an experiment file, without its folder."""
    return experiment.replace("\\", "/").rsplit("/", 1)[-1]


@dataclass(slots=True)
class ExperimentNames:
    """Names the experiments of sessions, one after the other.

    Sessions are of one experiment if their titles are the same, whatever their files are called: a
    copy with sentences that were typed has a name of its own. A log that tells no title (a redacted
    one) belongs where its file belongs. `woz design` has the same rule. An experiment is called
    like its first file; another one whose file has that name, too, has its title behind it.

    Attributes:
        files: The files of each experiment.
    """

    files: dict[str, dict[str, None]] = field(default_factory=dict)
    _by_title: dict[str, str] = field(default_factory=dict)
    _by_file: dict[str, str] = field(default_factory=dict)
    #: By file: experiments of which no log has told a title so far.
    _untitled: dict[str, str] = field(default_factory=dict)

    def of(self, title: str, experiment: str) -> str:
        """The experiment of this title (empty: not known), whose file is called so."""
        file = file_of(experiment)
        name = self._by_title.get(title) if title else self._by_file.get(file)
        if name is None and title:
            name = self._untitled.pop(file, None)
        if name is None:
            name = file or title
            if title and name in self.files:
                name = f"{name} ({title})"
            if file and not title:
                self._untitled[file] = name
        if title:
            self._by_title[title] = name
        files = self.files.setdefault(name, {})
        if file:
            self._by_file.setdefault(file, name)
            files[file] = None
        return name

    def of_session(self, figures: SessionFigures) -> str:
        """The experiment of a session."""
        return self.of("" if figures.redacted else figures.title, figures.experiment)
