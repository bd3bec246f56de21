"""Whatever of a page could leave this machine: in its HTML, and once a browser has built it."""

from html.parser import HTMLParser

from playwright.sync_api import Page

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
