"""Serves the pages of one session to browsers: HTML, forms, and a stream of news to each page.

A process of its own beside the robot process, with one connection to the session for all who
watch. No request plays the robot, and none stops it.
"""

from __future__ import annotations

import asyncio
import logging
import ssl
from collections.abc import Awaitable, Callable, Collection, Sequence
from functools import partial
from pathlib import Path

from aiohttp import web
from aiohttp.http import HttpProcessingError

from woz_tui.client import WozError, connect
from woz_tui.console.link.message_feed import Loss
from woz_tui.features.page.answer_page import answer_page
from woz_tui.features.page.debrief import HEADERS as DEBRIEF_HEADERS
from woz_tui.features.page.debrief import DebriefError, report_of
from woz_tui.features.page.failures import Failures
from woz_tui.features.page.follower import SessionFollower
from woz_tui.features.page.html import ASSETS, asset, code_form, say
from woz_tui.features.page.news import News, within
from woz_tui.features.page.pictures import WatchedPictures
from woz_tui.features.page.same_page import (
    SECURITY_HEADERS,
    is_own_form,
    is_own_host,
    is_own_stream,
)
from woz_tui.features.page.seat import NotSentError, ParticipantSeat, SelfBegun
from woz_tui.features.page.visitors import Browser, PageRole, TooOftenError, Visitors
from woz_tui.features.page.watch_page import watch_page
from woz_tui.features.page.watch_view import View, watch_view
from woz_tui.features.questionnaires.kinds import AskQuestionnaire
from woz_tui.network.listen_address import ListenAddress
from woz_tui.system.clock import Clock, RealClock
from woz_tui.system.tasks import end_tasks

#: Seconds between two updates of the watch page at least, and at most: its times go on by
#: themselves.
UPDATE_S, TICK_S = 0.2, 1.0
#: Seconds for which the session may take to say what holds.
_WELCOME_S = 3.0
#: Streams of news at the same time.
MOST_STREAMS = 100
#: Bytes of a form: an answer in words, each character of it written as several.
_FORM_BYTES = 1 << 18
#: Seconds for which the pages of a session that is over can still be loaded.
FAREWELL_S = 10.0
#: Seconds after which pages end whose session's process has gone without an end.
GONE_S = 20.0
#: Browsers in which somebody answers at the same time.
MOST_SEATS = 8

#: What a browser shows where something of ours has failed.
_WRONG = ("It has been told to whoever runs the session.", "Please load this page again.")
_STANDS_STILL = "This page stands still: something in it has failed, and was told."

log = logging.getLogger(__name__)


class PageServer:
    """The pages of one session.

    Args:
        session: The session's socket.
        names: Names by which browsers may call this computer, beside its addresses.
        tell: Is told what whoever began this has to know, such as a new code for the class.
        explain: As for `HostConnection`.
        clock: For times that pass here.
        name: What the wizard's events call it.
        debrief: Whoever watches can read the session's report when it is over, until this is
            closed.
        roles: In which browsers can come in.
        begins: The questionnaire that begins by itself when the participant opens the page; empty:
            none does.
        cameras: Drivers whose pictures all see who watch.
    """

    def __init__(
        self,
        session: Path,
        names: Collection[str] = (),
        tell: Callable[[str], None] = lambda text: None,
        explain: Callable[[Loss], Loss] | None = None,
        *,
        clock: Clock | None = None,
        name: str = "page",
        debrief: bool = False,
        roles: Collection[PageRole] = tuple(PageRole),
        begins: str = "",
        cameras: Sequence[str] = (),
    ) -> None:
        clock = clock or RealClock()
        self.failures = Failures(tell)
        self.watching = SessionFollower(
            session, "watcher", explain, clock, name=name, failed=self.failures.tell
        )
        self.visitors = Visitors(self._tell_class, clock, roles)
        self._clock, self._is_far = clock, explain is not None
        self._lost_us = 0
        self._pictures = WatchedPictures(self.watching, cameras, clock)
        #: Called when the class has another code.
        self.on_class_code: Callable[[], None] = _nothing
        self._session, self._tell, self._debriefs = session, tell, debrief
        self._report = ""
        self._reporting: asyncio.Task[None] | None = None
        self._names = frozenset(name.lower() for name in names)
        self._join_session = partial(
            ParticipantSeat,
            session,
            clock,
            explain,
            name,
            failed=self.failures.tell,
            begins=SelfBegun(begins, self._begin_questionnaire),
        )
        self._seats: dict[str, ParticipantSeat] = {}
        self._news = News()
        self._over = asyncio.Event()
        self._cookie = ""
        self._following: asyncio.Task[None] | None = None
        self._runner: web.AppRunner | None = None

    # -- beginning and ending -----------------------------------------------------------------

    async def start(self, at: ListenAddress, tls: ssl.SSLContext | None = None) -> tuple[str, int]:
        """Join the session and listen; returns address and port. Raises `ConnectionError`, if there
        is no session, or `OSError`.
        """
        await self.watching.start()
        await within(_WELCOME_S, self.watching.news.wait())
        application = web.Application(middlewares=[self._guarded], client_max_size=_FORM_BYTES)
        application.on_response_prepare.append(_add_headers)
        application.add_routes(self._routes())
        http_log = log.getChild("http")
        http_log.addFilter(_is_ours)
        self._runner = web.AppRunner(
            application,
            access_log=None,  # it would have the codes
            handle_signals=False,
            logger=http_log,
            lingering_time=0,
            shutdown_timeout=1.0,
        )
        await self._runner.setup()
        await web.TCPSite(self._runner, at.host or None, at.port, ssl_context=tls).start()
        host, port = self._runner.addresses[0][:2]
        # Cookies know no ports: two servers on one computer must not take each other's.
        self._cookie = f"woz-page-{port}"
        self._following = asyncio.create_task(self._follow(), name="watch page")
        return host, port

    def _tell_class(self, code: str) -> None:
        self._tell(f"Too many wrong codes: the class's code is {code} now.")
        self.on_class_code()

    async def _begin_questionnaire(self, name: str) -> bool:
        """Begin it as the program that whoever plays the robot has started."""
        try:
            async with connect(self._session, name="page") as client:
                await client.request(AskQuestionnaire(questionnaire=name, source="program"))
        except WozError as error:
            self._tell(f"The questionnaire {name} has not begun: {error}")
            return False
        return True

    async def renew(self, roles: Collection[PageRole]) -> None:
        """Other codes for these roles. Whom the old ones have let in gets nothing any more."""
        self.visitors.renew(roles)
        if PageRole.ANSWER in roles:
            gone, self._seats = self._seats, {}
            for seat in gone.values():
                await seat.close()
        if PageRole.WATCH in roles:
            self._news.close()
            self._news = News()
            self._news.publish(self._view())
            self.on_class_code()

    async def until_over(self) -> None:
        """Wait until the session has ended and its last words could be read."""
        await self._over.wait()
        if self._report:
            await asyncio.Event().wait()  # it is read until somebody ends this
        await asyncio.sleep(FAREWELL_S)

    async def close(self) -> None:
        """Let everybody go."""
        await end_tasks(self._following, self._reporting)
        self._news.close()
        for seat in self._seats.values():
            await seat.close()
        self.watching.close()
        if self._runner is not None:
            await self._runner.cleanup()

    def _routes(self) -> list[web.RouteDef]:
        return [
            web.get("/", self._front),
            web.post("/code", self._typed_code),
            web.get("/join/{code}", self._join),
            web.get("/watch", self._watch),
            web.get("/watch/news", self._watch_news),
            web.get(r"/watch/picture/{place:\d{1,3}}", self._watch_picture),
            web.get("/watch/debrief", self._debrief),
            web.get("/answer", self._answer),
            web.post("/answer", self._answered),
            web.get("/answer/news", self._answer_news),
            web.get(r"/answer/picture/{offer:\d{1,18}}/{place:\d{1,3}}", self._answer_picture),
            web.get("/favicon.ico", _no_icon),
            *(web.get(f"/{name}", _give_asset) for name in ASSETS),
        ]

    # -- who comes in ----------------------------------------------------------------------------

    @web.middleware
    async def _guarded(
        self,
        request: web.Request,
        handler: Callable[[web.Request], Awaitable[web.StreamResponse]],
    ) -> web.StreamResponse:
        here = request.transport.get_extra_info("sockname") if request.transport else None
        if not is_own_host(request.host, here[0] if here else "", self._names):
            return _refused(
                421,
                "Not the name of this page",
                f"The browser asked for {request.host}, which is no address of this computer. Who"
                " began the page gives it further names with --name.",
            )
        reads = request.method in ("GET", "HEAD")
        if not reads and not is_own_form(request.headers, _own_origin(request)):
            return _refused(403, "Not from here", "No page of this server has sent this form.")
        try:
            return await handler(request)
        except (web.HTTPException, ConnectionError):
            raise
        except Exception as error:  # noqa: BLE001 - it is told, and the next page may be right
            self.failures.tell(f"the page {request.path.split('/')[1] or 'of the code'}", error)
            return _refused(500, "This went wrong", *_WRONG)

    def _browser(self, request: web.Request, role: PageRole) -> Browser | None:
        """The browser that sent a request, if it was let in in this role."""
        browser = self.visitors.browser(request.cookies.get(self._cookie, ""))
        return browser if browser is not None and browser.role is role else None

    def _admitted(self, request: web.Request, browser: Browser) -> web.Response:
        """Its cookie, and the way on: no redirection, as behind a link on somebody else's page that
        would still be a request from there, to which browsers give no cookie.
        """
        title = self.watching.state.plan.title or "woz"
        response = _html(say(title, "You are in.", onward=f"/{browser.role.value}"))
        response.set_cookie(
            self._cookie,
            browser.cookie,
            httponly=True,
            samesite="Strict",
            secure=request.secure,
            path="/",
        )
        return response

    async def _front(self, request: web.Request) -> web.Response:
        return _html(code_form())

    async def _typed_code(self, request: web.Request) -> web.Response:
        typed = (await request.post()).get("code", "")
        try:
            browser = self.visitors.by_class_code(str(typed), request.remote or "")
        except TooOftenError:
            return _html(code_form("Too many wrong codes from here: wait a minute."), 429)
        if browser is None:
            return _html(code_form("This is not the code."), 403)
        return self._admitted(request, browser)

    async def _join(self, request: web.Request) -> web.Response:
        browser = self.visitors.by_address(request.match_info["code"])
        if browser is None:
            return _refused(404, "Not here", "This address does not exist, or its session is over.")
        return self._admitted(request, browser)

    # -- watching ----------------------------------------------------------------------------------

    async def _watch(self, request: web.Request) -> web.Response:
        if self._browser(request, PageRole.WATCH) is None:
            return _html(code_form("A code is needed to watch."), 403)
        cameras = self._pictures.cameras
        return _html(watch_page(self._view(), big="big" in request.query, cameras=cameras))

    async def _watch_picture(self, request: web.Request) -> web.Response:
        if self._browser(request, PageRole.WATCH) is None:
            return _refused(403, "Not here", "A code is needed to watch.")
        try:
            camera = self._pictures.cameras[int(request.match_info["place"])]
            picture = await self._pictures.newest(camera)
        except LookupError as error:
            return _refused(404, "Not here", str(error))
        return web.Response(body=picture, content_type="image/png")

    async def _watch_news(self, request: web.Request) -> web.StreamResponse:
        if self._browser(request, PageRole.WATCH) is None:
            return _refused(403, "Not here", "A code is needed to watch.")
        return await self._streamed(request, self._news)

    # -- answering ---------------------------------------------------------------------------------

    async def _seat(self, request: web.Request) -> ParticipantSeat:
        """That of the browser which sent a request; it joins the session with the first one. Raises
        `web.HTTPException`.
        """
        browser = self._browser(request, PageRole.ANSWER)
        if browser is None:
            raise web.HTTPForbidden(
                text=say("Not here", "The address with the code is needed."),
                content_type="text/html",
            )
        seat = self._seats.get(browser.cookie)
        if seat is None:
            while len(self._seats) >= MOST_SEATS:  # a tablet that has forgotten its cookie
                idle = [cookie for cookie, each in self._seats.items() if not each.news.readers]
                await self._seats.pop((idle or [*self._seats])[0]).close()
            seat = self._seats[browser.cookie] = self._join_session()
        try:
            await seat.start()
        except ConnectionError:
            text = say("Not now", "The session does not answer. Please load this page again.")
            unavailable = web.HTTPServiceUnavailable(text=text, content_type="text/html")
            raise unavailable from None
        return seat

    async def _answer(self, request: web.Request) -> web.Response:
        seat = await self._seat(request)
        await seat.begin_by_itself()
        return _html(answer_page(seat, request.query))

    async def _answered(self, request: web.Request) -> web.Response:
        """The next page comes by its own address, so that loading it anew sends nothing."""
        seat, form = await self._seat(request), await request.post()
        try:
            await seat.take({name: str(value) for name, value in form.items()})
        except NotSentError:
            return _html(say(seat.words.not_sent, seat.words.moment, onward="/answer"), 503)
        raise web.HTTPSeeOther("/answer")

    async def _answer_picture(self, request: web.Request) -> web.Response:
        """Of what is offered now alone."""
        seat = await self._seat(request)
        try:
            kind, content = await seat.picture(
                int(request.match_info["offer"]), int(request.match_info["place"])
            )
        except LookupError as error:
            return _refused(404, "Not here", str(error))
        return web.Response(body=content, content_type=kind)

    async def _answer_news(self, request: web.Request) -> web.StreamResponse:
        seat = await self._seat(request)
        seat.publish()  # a page that is just loaded is newer than what was told
        return await self._streamed(request, seat.news)

    # -- news --------------------------------------------------------------------------------------

    async def _make_report(self, log: Path) -> None:
        try:
            self._report = await report_of(log)
        except (DebriefError, OSError, ValueError) as error:
            self._tell(f"There is no report for those who watched: {error}")
            self._debriefs = False
        self._over.set()

    async def _debrief(self, request: web.Request) -> web.Response:
        if self._browser(request, PageRole.WATCH) is None:
            return _html(code_form("A code is needed to watch."), 403)
        if not self._report:
            return _refused(404, "Not yet", "The report comes when the session is over.")
        answer = _html(self._report)
        answer.headers.update(DEBRIEF_HEADERS)
        return answer

    async def _streamed(self, request: web.Request, news: News) -> web.StreamResponse:
        if not is_own_stream(request.headers, _own_origin(request)):
            return _refused(403, "Not from here", "No page of this server has asked for this.")
        if news.readers >= MOST_STREAMS:
            return _refused(503, "Full", f"{MOST_STREAMS} browsers are the most.")
        return await news.stream(request)

    def _view(self) -> View:
        """What the page shows now, without the codes, which a program may have sent to a tablet."""
        codes = self.visitors.codes.values()
        view = watch_view(self.watching.state, self.watching.now, codes)
        return view | {"over": view["over"] and not self._debriefs, "debrief": bool(self._report)}

    async def _follow(self) -> None:
        """Look at the session, at most so many times a second."""
        while True:
            await within(TICK_S, self.watching.news.wait())
            self.watching.news.clear()
            try:
                self._look()
            except Exception as error:  # noqa: BLE001 - what comes next may be shown again
                self.failures.tell("the page for those who watch", error)
                self._news.publish({**self._news.now, "lost": _STANDS_STILL})
            await asyncio.sleep(UPDATE_S)

    def _look(self) -> None:
        """Show what is now, and see whether the session is over."""
        state = self.watching.state
        if state.ended and state.lost and self._debriefs and self._reporting is None:
            self._reporting = asyncio.create_task(self._make_report(Path(state.log)))
        if state.ended and not self._debriefs:
            self._over.set()
        self._news.publish(self._view())
        self._end_if_gone()

    def _end_if_gone(self) -> None:
        """Pages that nobody ends would keep their port from those of the next session. A session on
        another computer is looked for as long as somebody wants.
        """
        state, now = self.watching.state, self._clock.now_us()
        if not state.lost or state.ended or self._is_far:
            self._lost_us = 0
        elif not self._lost_us:
            self._lost_us = now
        elif now - self._lost_us >= GONE_S * 1e6 and not self._over.is_set():
            self._tell("The robot process is gone, so the pages end, too.")
            self._over.set()


def _nothing() -> None:
    """Nobody has to know."""


def _is_ours(record: logging.LogRecord) -> bool:
    """Whether it tells a failure of ours, and not of a request that was none."""
    raised = record.exc_info[1] if record.exc_info else None
    return not isinstance(raised, HttpProcessingError)


def _own_origin(request: web.Request) -> str:
    return f"{request.scheme}://{request.host}"


async def _add_headers(request: web.Request, response: web.StreamResponse) -> None:
    """Unless a page has its own."""
    for name, value in SECURITY_HEADERS.items():
        response.headers.setdefault(name, value)
    response.headers["Server"] = "woz"


def _html(text: str, status: int = 200) -> web.Response:
    return web.Response(text=text, status=status, content_type="text/html", charset="utf-8")


def _refused(status: int, title: str, *lines: str) -> web.Response:
    return _html(say(title, *lines), status)


async def _no_icon(request: web.Request) -> web.Response:
    return web.Response(status=204)


async def _give_asset(request: web.Request) -> web.Response:
    name = request.path.removeprefix("/")
    return web.Response(text=asset(name), content_type=ASSETS[name], charset="utf-8")
