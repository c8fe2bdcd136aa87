"""report.html in a real browser: what people see, click, hover and zoom."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page

from tests.commands.browser import chromium, open_page
from tests.commands.running import BAG, FIXTURES, MCAP, done

CAMERA = FIXTURES / "camera-a.mcap"


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the page of everything that was found in one folder."""
    out = tmp_path_factory.mktemp("report")
    done("learn", BAG, MCAP, CAMERA, "-o", out, "-q")
    done("evaluate", "-o", out, "-q")
    done("novelty", BAG, MCAP, "--sensor", "scan", "--window", 20, "-o", out, "-q")
    return out / "report.html"


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """Return a Chromium for all tests."""
    with chromium() as started:
        yield started


@pytest.fixture
def page(browser: Browser, report: Path) -> Iterator[Page]:
    """Return the page on a laptop."""
    opened = open_page(browser, report)
    yield opened
    opened.close()


def numbers(page: Page, attribute: str) -> list[float]:
    """Return a number of every card of the clusters of scans, in the order shown."""
    cards = page.locator("#clusters-scan .card").all()
    return [float(card.get_attribute(f"data-{attribute}") or "nan") for card in cards]


def test_sections_are_there(page: Page) -> None:
    """The summary says what was found; every section has its pictures."""
    summary = page.locator("#summary").inner_text()

    assert "laser scans of 3 input files" in summary
    assert "held-out AUC" in summary
    assert page.locator("#clusters-scan .card svg.scan").count() > 3
    assert page.locator("#clusters-image .card img.patch").count() > 1
    assert page.locator("#scores .plot svg").count() == 2
    assert page.locator("#time .plot svg").count() == 3
    assert page.locator("#novelty .plot svg").count() == 1
    assert page.locator("#presses .card svg.scan").count() > 4
    assert page.locator("#tables td").count() > 20


def test_pictures_are_whole(page: Page) -> None:
    """Every photograph can be decoded."""
    script = "[...document.images].map(image => image.decode().then(() => image.naturalWidth))"
    widths = page.evaluate(f"Promise.all({script})")

    assert len(widths) > 5
    assert min(widths) > 10


def test_clusters_are_sorted_by_click(page: Page) -> None:
    """By probability at first, then by size, then by number."""
    p = numbers(page, "p")
    page.locator("#clusters-scan [data-sort=size]").click()
    sizes = numbers(page, "size")
    page.locator("#clusters-scan [data-sort=number]").click()
    order = numbers(page, "number")

    assert p == sorted(p, reverse=True)
    assert sizes == sorted(sizes, reverse=True)
    assert order == sorted(order)
    assert len(set(p)) > 2


def test_presses_are_filtered(page: Page) -> None:
    """Missed and announced ones are all presses together."""
    cards = page.locator("#presses .press:visible")
    everything = cards.count()
    page.locator("[data-show=missed]").click()
    missed = cards.count()
    page.locator("[data-show=announced]").click()
    announced = cards.count()

    assert everything == missed + announced
    assert everything > 0


def test_hover_tells_values(page: Page) -> None:
    """The pointer over a curve brings time and probability."""
    plot = page.locator("#time .plot").first
    plot.scroll_into_view_if_needed()
    plot.hover(position={"x": 300, "y": 60})

    tip = plot.locator(".tip").inner_text()

    assert "seconds in the log:" in tip
    assert "p(collision):" in tip


def test_drag_zooms_and_double_click_resets(page: Page) -> None:
    """The stretch dragged over fills the chart; all comes back."""
    plot = page.locator("#time .plot").first
    plot.scroll_into_view_if_needed()
    box = plot.bounding_box()
    assert box is not None
    shown = "document.querySelector('#time figure').chart.shown"
    whole = page.evaluate(shown)

    page.mouse.move(box["x"] + 300, box["y"] + 50)
    page.mouse.down()
    page.mouse.move(box["x"] + 500, box["y"] + 60)
    page.mouse.up()
    zoomed = page.evaluate(shown)
    plot.dblclick(position={"x": 200, "y": 50})
    reset = page.evaluate(shown)

    assert whole[0] < zoomed[0] < zoomed[1] < whole[1]
    assert zoomed[1] - zoomed[0] < 0.3 * (whole[1] - whole[0])
    assert reset == whole


def test_keys_work_without_a_mouse(page: Page) -> None:
    """Arrows move through the curve, plus zooms, Escape resets."""
    page.locator("#novelty .plot").focus()
    shown = "document.querySelector('#novelty figure').chart.shown"
    whole = page.evaluate(shown)

    page.keyboard.press("ArrowRight")
    tip = page.locator("#novelty .tip").inner_text()
    page.keyboard.press("+")
    zoomed = page.evaluate(shown)
    page.keyboard.press("Escape")

    assert "new as it went on learning" in tip
    assert zoomed[1] - zoomed[0] == pytest.approx((whole[1] - whole[0]) / 2)
    assert page.evaluate(shown) == whole


def brightness(page: Page) -> float:
    """Return how bright the ground of the page is, 0 to 255."""
    color = page.evaluate("getComputedStyle(document.body).backgroundColor")
    return sum(map(int, color.removeprefix("rgb(").removesuffix(")").split(","))) / 3


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_light_and_dark(browser: Browser, report: Path, scheme: str) -> None:
    """The page follows the system; the button goes through auto, light, dark."""
    page = open_page(browser, report, scheme=scheme)
    by_system = brightness(page)
    button = page.locator("#theme")
    button.click()
    light = brightness(page)
    button.click()
    dark = brightness(page)
    page.close()

    assert (by_system > 128) == (scheme == "light")
    assert light > 200
    assert dark < 60


def test_phone(browser: Browser, report: Path) -> None:
    """Nothing sticks out of a narrow screen; wide tables scroll on their own."""
    page = open_page(browser, report, width=360)

    width = page.evaluate("document.documentElement.scrollWidth")
    charts = page.locator(".plot svg").evaluate_all("all => all.map(one => one.clientWidth)")
    page.close()

    assert width <= 360
    assert max(charts) <= 340
