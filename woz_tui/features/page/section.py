"""The section `page`: pages in browsers that are open as long as the session.

page:
  at: 0.0.0.0:8080
  plain: true
  for: [watch]
"""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from woz_tui.config.experiment import Experiment
from woz_tui.config.feature_section import FeatureSection, FileContents
from woz_tui.config.problems import quoted
from woz_tui.config.reload_changes import changed_settings
from woz_tui.config.yaml_cursor import Cursor, texts_of
from woz_tui.drivers.contract import LEAVES
from woz_tui.drivers.fields import Doc, NotEmpty, OneOf, Path, Unique
from woz_tui.features.page.visitors import PageRole
from woz_tui.features.questionnaires.section import QUESTIONNAIRES
from woz_tui.network.listen_address import ListenAddress, is_loopback
from woz_tui.protocol.sentence import Sentence, said_by

#: Where pages are unless something else is said: on this computer alone.
HERE = "127.0.0.1:8080"
ROLES = tuple(role.value for role in PageRole)


@dataclass(frozen=True, slots=True)
class PageSettings:
    """How `woz page` is begun with a session."""

    at: Annotated[str, Doc("where browsers find it, HOST:PORT")] = HERE
    for_: Annotated[
        tuple[str, ...],
        OneOf(ROLES),
        Unique(),
        NotEmpty(),
        Doc("for whom: to watch, or for the participant to answer"),
    ] = ROLES
    plain: Annotated[
        bool,
        Doc(
            "allow other computers without encryption: everybody in the network can read the pages"
            " and what participants answer"
        ),
    ] = False
    certificate: Annotated[
        str, Path(must_exist=True), Doc("encrypt with this certificate (PEM); needs key")
    ] = ""
    key: Annotated[str, Path(must_exist=True), Doc("the certificate's private key")] = ""
    names: Annotated[
        tuple[str, ...], Unique(), Doc("further names by which browsers call this computer")
    ] = ()
    questionnaire: Annotated[
        str, Doc("begins by itself when the participant opens the page: its name")
    ] = ""
    pictures: Annotated[
        tuple[str, ...],
        Unique(),
        Doc("drivers whose camera's pictures all see who watch; none unless they are named"),
    ] = ()
    tablet: Annotated[bool, Doc("the robot's own tablet shows the participant's page")] = False


@dataclass(frozen=True, kw_only=True)
class PageKeys:
    """The key `page`."""

    page: Annotated[
        PageSettings | None, Doc("pages in browsers, begun with the session (`woz page`)")
    ] = None


class PageSection(FeatureSection[PageSettings | None]):
    """The section, or None where the file has none."""

    def read(
        self, table: Mapping[str, Cursor], file: Any, contents: FileContents
    ) -> PageSettings | None:
        settings: PageSettings | None = file.page
        cursor = table.get("page")
        if cursor is None or settings is None:
            return settings
        keys = dict(cursor.entries())
        if bool(settings.certificate) != bool(settings.key):
            cursor.error(
                Sentence("page.certificate_and_key", "certificate and key belong together")
            )
        try:
            at = ListenAddress.read(settings.at)
        except ValueError as error:
            keys.get("at", cursor).error(said_by(error))
            return settings
        if not (settings.plain or settings.certificate or is_loopback(at.host)):
            keys.get("at", cursor).error(
                Sentence(
                    "page.nothing_encrypted",
                    "{at} lets other computers in, and nothing is encrypted: a"
                    " certificate and its key encrypt, `plain: true` says that this is"
                    " meant, in a network of your own",
                    at=settings.at,
                )
            )
        if settings.pictures:
            keys["pictures"].warning(
                Sentence(
                    "page.shows_camera", "whoever watches the page sees who is before the camera"
                )
            )
        return settings

    def check(self, experiment: Experiment, table: Mapping[str, Cursor]) -> None:
        settings = self.of(experiment)
        name = settings.questionnaire if settings is not None else ""
        asked = [each.name for each in QUESTIONNAIRES.of(experiment).questionnaires]
        if name and name not in asked:
            entry = dict(table["page"].entries())["questionnaire"]
            near = entry.report.hint(
                name, asked, or_list=Sentence("page.questionnaires_are", "questionnaires are")
            )
            entry.error(
                Sentence(
                    "page.no_questionnaire",
                    "there is no questionnaire {name}{near}",
                    name=quoted(name),
                    near=near,
                )
            )
        drivers = [each.name for each in experiment.drivers]
        for entry, camera in texts_of(_pictures(table)) if settings is not None else ():
            if camera not in drivers:
                near = entry.report.hint(
                    camera, drivers, or_list=Sentence("page.drivers_are", "drivers are")
                )
                entry.error(
                    Sentence(
                        "page.no_driver",
                        "there is no driver {name}{near}",
                        name=quoted(camera),
                        near=near,
                    )
                )

    def trained(self, section: PageSettings | None) -> PageSettings | None:
        return None  # nobody takes part in one

    def changes(self, old: PageSettings | None, new: PageSettings | None) -> Iterable[str]:
        return changed_settings("page", old, new)

    def people_data(self, experiment: Experiment) -> Iterable[tuple[str, str]]:
        settings = self.of(experiment)
        if settings is None:
            return
        how = "encrypted" if settings.certificate else "not encrypted"
        seen = f", with pictures of {', '.join(settings.pictures)}" if settings.pictures else ""
        yield LEAVES, f"to browsers at {settings.at}, {how}: {', '.join(settings.for_)}{seen}"

    def summary(self, experiment: Experiment) -> Iterable[tuple[str, str]]:
        settings = self.of(experiment)
        if settings is not None:
            how = "encrypted" if settings.certificate else "not encrypted"
            yield "page", f"`woz page` at {settings.at}, {how}: {', '.join(settings.for_)}"


def _pictures(table: Mapping[str, Cursor]) -> Cursor | None:
    return dict(table["page"].entries()).get("pictures")


def command_line(settings: PageSettings) -> str:
    """The command of `woz` that opens such pages, without the session."""
    words = ["page", "--at", settings.at]
    for role in settings.for_:
        words += ["--for", role]
    for name in settings.names:
        words += ["--name", name]
    words += ["--plain"] if settings.plain else []
    if settings.certificate:
        words += ["--certificate", settings.certificate, "--key", settings.key]
    words += ["--questionnaire", settings.questionnaire] if settings.questionnaire else []
    for camera in settings.pictures:
        words += ["--pictures", camera]
    words += ["--tablet"] if settings.tablet else []
    return shlex.join(words)


PAGE = PageSection(PageKeys, None)
