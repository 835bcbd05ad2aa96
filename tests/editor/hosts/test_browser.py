"""The served app in a real browser: headless Chromium, driven by Selenium."""

import contextlib
import json
import shutil

import pytest

from editor.documents.commands import clip
from kinetix.level.codec import save_level
from kinetix.level.model import Body, Circle, Level
from tests.editor.hosts.serving import Served, bodies, eventually

webdriver = pytest.importorskip("selenium.webdriver", reason="selenium is missing: make setup-test")
from selenium.webdriver.common.action_chains import ActionChains  # noqa: E402
from selenium.webdriver.common.actions.wheel_input import ScrollOrigin  # noqa: E402
from selenium.webdriver.common.keys import Keys  # noqa: E402

pytestmark = [pytest.mark.gl, pytest.mark.slow, pytest.mark.usefixtures("software_gl")]
_OPTIONS = (
    *("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"),
    *("--no-first-run", "--window-size=1200,900"),
)


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    driver = shutil.which("chromedriver")
    if chromium is None or driver is None:
        pytest.skip("chromium, chromedriver missing: install chromium chromium-driver")
    options = webdriver.ChromeOptions()
    options.binary_location = chromium
    for option in (*_OPTIONS, f"--user-data-dir={tmp_path_factory.mktemp('chromium')}"):
        options.add_argument(option)
    service = webdriver.ChromeService(executable_path=driver)
    driven = webdriver.Chrome(options=options, service=service)
    yield driven
    driven.quit()


class Page:
    """One page, used as a person does."""

    def __init__(self, browser, served: Served) -> None:
        self.browser, self.served = browser, served
        browser.execute_cdp_cmd(
            "Browser.grantPermissions",
            {"permissions": ["clipboardReadWrite", "clipboardSanitizedWrite"]},
        )
        self.open()

    def open(self) -> None:
        self.browser.get(self.served.url)
        eventually(lambda: self.frame > 0 and "Kinetix" in self.browser.title)
        self.rest()

    def run(self, code: str):
        return self.browser.execute_script(code)

    @property
    def frame(self) -> int:
        return int(self.run("return screen_.dataset.frame || 0"))

    @property
    def size(self) -> list[int]:
        return self.run("return [screen_.width, screen_.height]")

    @property
    def notice(self) -> str:
        return self.run(
            "return notice.classList.contains('shown') ? notice.innerText.split('\\n')[0] : ''"
        )

    def rest(self) -> None:
        """Wait until everything is said, and a few pictures more."""
        eventually(lambda: self.run("return !saying && said.length === 0"))
        self.run("window.since = [performance.now(), +screen_.dataset.frame]")
        eventually(
            lambda: self.run(
                "return performance.now() > since[0] + 1000 || screen_.dataset.frame > since[1] + 9"
            )
        )

    def keys(self, *keys: str, ctrl: bool = False) -> None:
        chain = ActionChains(self.browser)
        if ctrl:
            chain.key_down(Keys.CONTROL)
        for key in keys:
            chain.send_keys(key)
        if ctrl:
            chain.key_up(Keys.CONTROL)
        chain.perform()
        self.rest()

    def drag(self, x: int, y: int, dx: int, dy: int) -> None:
        """Drag from a place on the page [CSS px]."""
        chain = ActionChains(self.browser, duration=150)
        chain.w3c_actions.pointer_action.move_to_location(x, y)
        chain.w3c_actions.pointer_action.pointer_down()
        chain.w3c_actions.pointer_action.move_to_location(x + dx, y + dy)
        chain.w3c_actions.pointer_action.pointer_up()
        chain.perform()
        self.rest()

    def picture(self) -> list[int]:
        """Return the sums of the screen's pixels in a grid of 8 by 8."""
        return self.run(
            "const d = context.getImageData(0, 0, screen_.width, screen_.height).data;"
            "const s = Array(64).fill(0), w = screen_.width, h = screen_.height;"
            "for (let y = 0; y < h; y++) for (let x = 0; x < w; x++) {"
            "  const k = (y * 8 / h | 0) * 8 + (x * 8 / w | 0), i = (y * w + x) * 4;"
            "  s[k] += d[i] + d[i + 1] + d[i + 2]; } return s;"
        )


@pytest.fixture
def level(tmp_path):
    path = tmp_path / "drawn.json"
    save_level(Level(name="Drawn"), path)
    return path


@pytest.fixture
def ends():
    with contextlib.ExitStack() as stack:
        yield stack


@pytest.fixture
def page(browser, home, ends, level):
    return Page(browser, Served(home, ends, str(level)))


def circle_at(page: Page) -> None:
    """Draw a circle in the middle of the arena."""
    width, height = page.run("return [innerWidth, innerHeight]")
    page.keys("c")
    page.drag(width // 2, height // 2, 40, 0)


def test_a_circle_is_drawn_and_saved(page, level):
    assert page.browser.title.startswith("drawn.json")
    before = page.picture()
    circle_at(page)
    eventually(lambda: page.browser.title.startswith("● "))
    assert page.picture() != before
    page.keys("s", ctrl=True)
    eventually(lambda: bodies(level) == 1)
    eventually(lambda: not page.browser.title.startswith("● "))
    assert [each for each in page.browser.get_log("browser") if each["level"] == "SEVERE"] == []


def test_text_is_typed_with_accents(page, level):
    ActionChains(page.browser).key_down(Keys.CONTROL).key_down(Keys.SHIFT).send_keys("p").key_up(
        Keys.SHIFT
    ).key_up(Keys.CONTROL).perform()
    page.rest()
    page.keys("name of the level")
    page.keys(Keys.RETURN)
    page.keys("a", ctrl=True)
    page.keys("Brücke 1", Keys.RETURN)
    page.keys("s", ctrl=True)
    eventually(lambda: json.loads(level.read_text())["name"] == "Brücke 1")


def test_the_clipboard_goes_both_ways(page, level):
    circle_at(page)
    page.keys("a", ctrl=True)
    page.keys("c", ctrl=True)
    copied = page.browser.execute_async_script(
        "const done = arguments[0]; navigator.clipboard.readText().then(done, e => done(String(e)))"
    )
    taken = clip.loads(copied)
    assert taken is not None and len(taken.bodies) == 1
    two = [Body(id=k + 1, shape=Circle(radius=0.2), position=(1.0 + k, 3.0)) for k in range(2)]
    other = clip.dumps(clip.copied(Level(name="Two", bodies=tuple(two)), (1, 2)))
    page.browser.execute_async_script(
        "const [text, done] = arguments; navigator.clipboard.writeText(text).then(done)", other
    )
    page.keys("v", ctrl=True)
    page.keys("s", ctrl=True)
    eventually(lambda: bodies(level) == 3)


def test_the_page_may_be_resized(page):
    page.browser.set_window_size(900, 700)
    eventually(lambda: page.size == page.run("return [innerWidth, innerHeight]"))
    page.browser.set_window_size(1200, 900)
    eventually(lambda: page.size == page.run("return [innerWidth, innerHeight]"))


def test_a_dense_screen_gets_more_pixels(page):
    page.browser.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": 800, "height": 600, "deviceScaleFactor": 2, "mobile": False},
    )
    try:
        page.run("dispatchEvent(new Event('resize'))")
        eventually(lambda: page.size == [1600, 1200])
    finally:
        page.browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def test_the_wheel_zooms(page):
    before = page.picture()
    width, height = page.run("return [innerWidth, innerHeight]")
    middle = ScrollOrigin.from_viewport(width // 2, height // 2)
    ActionChains(page.browser).scroll_from_origin(middle, 0, -300).perform()
    eventually(lambda: page.picture() != before)


def test_two_fingers_zoom_the_view_and_not_the_page(page):
    before, ratio = page.picture(), page.run("return [devicePixelRatio, visualViewport.scale]")
    width, height = page.run("return [innerWidth, innerHeight]")
    ctrl = 2
    page.browser.execute_cdp_cmd(
        "Input.dispatchMouseEvent",
        {
            "type": "mouseWheel",
            "x": width // 2,
            "y": height // 2,
            "deltaX": 0,
            "deltaY": -60,
            "modifiers": ctrl,
        },
    )
    eventually(lambda: page.picture() != before)
    assert page.run("return [devicePixelRatio, visualViewport.scale]") == ratio


def test_it_goes_on_where_the_page_was_closed(page, level):
    circle_at(page)
    page.browser.get("about:blank")
    page.open()
    assert page.browser.title.startswith("● ")
    page.keys("s", ctrl=True)
    eventually(lambda: bodies(level) == 1)


def test_a_second_page_is_refused_in_one_sentence(page):
    first = page.browser.current_window_handle
    page.browser.switch_to.new_window("tab")
    try:
        page.browser.get(page.served.url)
        eventually(lambda: "another page" in page.notice)
        assert page.notice.count(".") == 1
    finally:
        page.browser.close()
        page.browser.switch_to.window(first)
    assert page.notice == ""


def test_it_plays(page, level):
    circle_at(page)
    before = page.picture()
    page.keys(Keys.SPACE)
    eventually(lambda: page.picture() != before, 60)
    ActionChains(page.browser).send_keys(Keys.ESCAPE).perform()


def test_the_end_of_the_app_is_told(page):
    assert page.served.stop() == 0
    assert "has been closed" in eventually(lambda: page.notice)
    # The answer to what the page said last may arrive after that.
    page.run("tell('Kinetix is open in another page')")
    assert "has been closed" in page.notice


@contextlib.contextmanager
def heard(page: Page):
    """Collect what the page says to the app."""
    page.run(
        "window.log = []; window.plain ??= say; window.say = new Proxy(plain, {"
        "  apply(f, self, message) { log.push(message); return f(...message); } })"
    )
    messages: list = []
    yield messages
    page.rest()
    messages += page.run("return log.filter(message => message[0] !== 'drawn')")


def act(page: Page, *events: tuple[str, dict], then: str = ""):
    """Let events happen at once, however slow the machine is; returns what a script says then."""
    return page.browser.execute_script(
        "screen_.setPointerCapture = () => {};"
        "for (const [kind, values] of arguments[0]) {"
        "  if (kind.startsWith('key')) document.dispatchEvent(new KeyboardEvent(kind, values));"
        "  else screen_.dispatchEvent(new PointerEvent(kind, "
        "    { bubbles: true, isPrimary: true, pointerType: 'mouse', ...values }));"
        "}" + then,
        events,
    )


def test_a_refused_message_is_told_and_the_page_goes_on(page, level):
    page.run("say('eval', 1)")
    eventually(lambda: "not a known message" in page.notice)
    page.run("document.getElementById('again').click()")
    assert page.notice == ""
    circle_at(page)
    page.keys("s", ctrl=True)
    eventually(lambda: bodies(level) == 1)
    assert page.notice == ""


def test_buttons_are_let_go_of_in_any_order(page):
    at = {"clientX": 300, "clientY": 300}
    with heard(page) as said:
        act(
            page,
            ("pointerdown", {"button": 0, "buttons": 1, **at}),
            ("pointermove", {"button": 2, "buttons": 3, **at}),
            ("pointermove", {"button": 0, "buttons": 2, **at}),
            ("pointermove", {"button": -1, "buttons": 2, **at}),
            ("pointerup", {"button": 2, "buttons": 0, **at}),
        )
    expected = [["down", 0], ["down", 2], ["up", 0], ["move"], ["up", 2]]
    assert [[each[0], *each[3:]] for each in said] == expected


def test_two_fingers_zoom_and_press_nothing(page):
    def finger(kind, number, x):
        which = {"pointerId": number, "pointerType": "touch", "isPrimary": number == 1}
        button = -1 if kind == "pointermove" else 0
        return kind, {"clientX": x, "clientY": 300, "button": button, **which}

    with heard(page) as said:
        act(
            page,
            finger("pointerdown", 1, 200),
            finger("pointerdown", 2, 300),
            finger("pointermove", 2, 400),
            finger("pointerup", 1, 200),
            finger("pointerup", 2, 400),
        )
    assert [each[0] for each in said] == ["pinch"]
    assert said[0][1] == pytest.approx(2.0)
    with heard(page) as said:
        act(page, finger("pointerdown", 1, 200), finger("pointerup", 1, 200))
    assert [each[0] for each in said] == ["down", "up"]


def test_what_the_browser_cancels_is_no_click(page):
    def finger(kind):
        which = {"pointerId": 1, "pointerType": "touch", "isPrimary": True, "button": 0}
        return kind, {"clientX": 200, "clientY": 300, **which}

    with heard(page) as said:
        act(page, finger("pointerdown"), finger("pointercancel"))
    assert said == []
    mouse = {"clientX": 300, "clientY": 300, "button": 2, "buttons": 2}
    with heard(page) as said:
        act(page, ("pointerdown", mouse), ("pointercancel", {**mouse, "button": 0}))
    assert [each[0] for each in said] == ["down", "focus", "focus"]


def test_the_delay_of_a_touch_presses_no_later_one(page):
    def finger(kind):
        which = {"pointerId": 1, "pointerType": "touch", "isPrimary": True, "button": 0}
        return kind, {"clientX": 200, "clientY": 300, **which}

    page.run("window.setTimeout_ = setTimeout; window.late = [];")
    page.run("setTimeout = (f, ...more) => setTimeout_(() => { late.push(1); f(); }, ...more);")
    act(page, finger("pointerdown"), finger("pointerup"))
    page.rest()
    assert page.run("return late.length") == 0


def test_a_key_is_released_under_the_name_that_it_was_pressed_under(page):
    with heard(page) as said:
        act(
            page,
            ("keydown", {"code": "KeyY", "key": "z"}),
            ("keyup", {"code": "KeyY", "key": "»"}),
        )
    assert said == [["key", "KeyY", "z", True], ["key", "KeyY", "z", False]]


@pytest.mark.parametrize("press", [{"key": "м"}, {"key": "V", "shiftKey": True}])
def test_the_keys_that_paste_wait_for_the_clipboard(page, press):
    down = ("keydown", {"code": "KeyV", "ctrlKey": True, **press})
    assert act(page, down, then="return pasting !== null")


def test_a_text_that_is_too_long_is_told_and_not_pasted(page):
    with heard(page) as said:
        act(
            page,
            ("keydown", {"code": "KeyV", "key": "v", "ctrlKey": True}),
            then="const data = new DataTransfer();"
            "data.setData('text/plain', 'a'.repeat(LONGEST + 1));"
            "document.dispatchEvent(new ClipboardEvent('paste', {clipboardData: data}))",
        )
        assert "too long" in page.notice
    assert said == []
