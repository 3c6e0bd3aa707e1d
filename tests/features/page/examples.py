"""Examples of what pages tell of themselves, for the golden files of the protocol."""

from woz_tui.features.page.kinds import AskPageTell, PageClosed, PageFailed, PageOpened

OPENED = PageOpened(
    address="http://192.168.4.1:8080", class_code="401882", roles=["watch", "answer"], console="c4"
)
MESSAGES = (
    OPENED,
    PageOpened(address="https://robot.lab:8443", roles=["answer"], encrypted=True, console="c5"),
    PageFailed(why="the page for those who watch has failed (KeyError)", console="c4"),
    PageClosed(address="http://192.168.4.1:8080"),
)
REQUESTS = (AskPageTell(ref=73, told=OPENED),)
