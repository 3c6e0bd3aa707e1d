"""Has `woz page` run beside the session where the file says so, and tells where the pages are."""

from __future__ import annotations

from msgspec.structs import replace

from woz_tui.drivers.contract import Finding
from woz_tui.features.page.history import PageHistory
from woz_tui.features.page.kinds import MOST_TEXT, AskPageTell, PageClosed, PageFailed
from woz_tui.features.page.section import PAGE, command_line
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.session_features import Client, SessionFeature

#: For whom pages are, in words.
_FOR = {"watch": "to watch", "answer": "for the participant"}


class PageInSession(SessionFeature):
    """What one session has of its pages; they themselves are in another process."""

    requests = (AskPageTell,)

    def carry_out(self, request: AskPageTell, client: Client) -> str:
        if client.role != "program":
            raise RequestError(
                Sentence("page.only_program", "only the program of the pages tells of them")
            )
        told = request.told
        if len(told.why if isinstance(told, PageFailed) else told.address) > MOST_TEXT:
            raise RequestError(
                Sentence("page.too_long", "more than {most_text} characters", most_text=MOST_TEXT)
            )
        self.session.hub.publish(replace(told, console=client.console))
        return ""

    def lose(self, console: str) -> None:
        """With its connection a page is gone."""
        opened = self.session.state.history(PageHistory).opened.values()
        for address in [page.address for page in opened if console and page.console == console]:
            self.session.hub.publish(PageClosed(address=address))

    def companion(self) -> str:
        settings = PAGE.of(self.session.experiment)
        return command_line(settings) if settings is not None else ""

    def findings(self) -> list[Finding]:
        opened = self.session.state.history(PageHistory).opened.values()
        findings = []
        for page in opened:
            code = f", code {page.class_code}" if page.class_code else ""
            whom = ", ".join(_FOR.get(each, each) for each in page.roles)
            text = f"{page.address}{code} ({whom})"
            plain = Sentence("page.plain", "not encrypted: for a network of your own only")
            findings.append(Finding("ok", "page", text, "" if page.encrypted else plain))
        if not findings and PAGE.of(self.session.experiment) is not None:
            start = f"woz page {self.session.identity.session}"
            text = Sentence("page.not_running", "`woz page` does not run")
            findings.append(Finding("warning", "page", text, start))
        return findings
