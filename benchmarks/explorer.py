"""Time of a slider step: the explorer's answer, and its drawing in the browser."""

import shutil
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from statistics import median

import psutil
from playwright.sync_api import Page, sync_playwright

from analysis.explore.app import LOOPBACK, serve

MOST_LOCKS = 15
PATIENCE = 60_000  # ms
SETTLED = "#answer[aria-busy=false]"


def step_seconds() -> float | None:
    """Median processor seconds of a step from 2 to 15 locks; None without Chromium.

    Of this process, which serves, and of the browser; without the curve, which comes later.
    """
    chromium = shutil.which("chromium")
    if chromium is None:
        return None
    with served() as url, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1400, "height": 900})
        page.route("**/curve", lambda route: route.fulfill(status=204))
        page.goto(f"{url}/?locks=2&a=61")
        page.wait_for_selector(SETTLED, timeout=PATIENCE)
        page.focus("#locks")
        seconds = [_step(page) for _ in range(2, MOST_LOCKS)]
        browser.close()
    return median(seconds)


def _step(page: Page) -> float:
    before = _processor_seconds()
    page.keyboard.press("ArrowRight")
    page.wait_for_selector(SETTLED, timeout=PATIENCE)
    return _processor_seconds() - before


@contextmanager
def served() -> Iterator[str]:
    """The explorer on a free port; its address."""
    server, explorer = serve(0)
    explorer.warm_up()
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield f"http://{LOOPBACK}:{server.port}"
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


def _processor_seconds() -> float:
    """Of this process and of the browser; not of what drives the browser."""
    total = time.process_time()
    for process in psutil.Process().children(recursive=True):
        try:
            if "chrom" in process.name():
                used = process.cpu_times()
                total += used.user + used.system
        except psutil.Error:
            continue
    return total
