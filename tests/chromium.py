"""Pages in a real browser."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from html.parser import HTMLParser
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

CHROMIUM = shutil.which("chromium")
PATIENCE = 60_000  # ms, on a machine that does much else
FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]

needs_browser = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")


@contextmanager
def chromium() -> Iterator[Browser]:
    """A browser that is closed at the end."""
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield opened
        opened.close()


def until(page: Page, expression: str) -> None:
    """Wait until ``expression`` holds; pages forbid the ``eval`` by which Playwright waits."""
    for _ in range(PATIENCE // 100):
        if page.evaluate(expression):
            return
        page.wait_for_timeout(100)
    raise TimeoutError(expression)


class Opened:
    """A page in a browser, with what it said and asked for."""

    def __init__(self, page: Page) -> None:
        self.page = page
        page.set_default_timeout(PATIENCE)
        self.errors: list[str] = []
        self.requests: list[str] = []
        page.on("console", self._heard)
        page.on("pageerror", lambda error: self.errors.append(str(error)))
        page.on("request", lambda request: self.requests.append(request.url))

    def _heard(self, message: Any) -> None:
        if message.type == "error":
            self.errors.append(message.text)

    def traces(self, plot: str) -> list[dict[str, Any]]:
        found = self.page.evaluate(
            f"document.getElementById('{plot}').data.map(t => ({{name: t.name, x: [...t.x]}}))"
        )
        return list(found)


# --- whatever of a page could leave this machine: in its HTML, and once it is built --------------
OUTWARD = ("href", "src", "action", "formaction", "ping", "background", "data", "poster")
WATCH = "window.left = []; window.open = (address) => { window.left.push(String(address)); };"
CLICK_ALL = """() => {
  for (const button of document.querySelectorAll('.modebar-btn, button')) button.dispatchEvent(
    new MouseEvent('click', { bubbles: true }));
}"""
LEAVING = """() => [
  ...window.left,
  ...[...document.querySelectorAll('form')].map((form) => `form ${form.action}`),
  ...[...document.querySelectorAll('[href], [src], [formaction], [ping]')].flatMap((part) =>
    ['href', 'src', 'formaction', 'ping'].filter((name) => part.hasAttribute(name)).map(
      (name) => new URL(part.getAttribute(name), location.href).href)
    ).filter((url) => !/^(data|blob):/.test(url)
      && (location.protocol === 'file:' ? url.split('#')[0] !== location.href.split('#')[0]
        : new URL(url).origin !== location.origin)),
  ...[...document.querySelectorAll('.modebar-btn')].map((button) => button.dataset.title).filter(
    (title) => /share|cloud|studio|upload/i.test(title)),
  ...[...document.querySelectorAll('.js-plotly-plot')].map((plot) => plot._context).filter(
    (config) => config.showSendToCloud || config.plotlyServerURL).map(
    (config) => config.plotlyServerURL),
]"""


class _Outward(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag == "form":
            self.found.append("form")
        for name, value in attrs:
            if name in OUTWARD and (value or "").startswith(("http:", "https:", "//", "ws")):
                self.found.append(f"{tag} {name}={value}")


def leaving_in_html(text: str) -> list[str]:
    """Forms, and elements of ``text`` that point to another machine."""
    parser = _Outward()
    parser.feed(text)
    return parser.found


def leaving_in_browser(page: Page) -> list[str]:
    """The same of a page that is built, after a click on each of its buttons.

    `WATCH` must have been an initial script of ``page``.
    """
    page.evaluate(CLICK_ALL)
    return list(page.evaluate(LEAVING))
