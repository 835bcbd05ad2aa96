"""The renderer's picture in Play: asked for one at a time, shown only while it is recent."""

import numpy as np

from editor.base.controls import NOOP
from editor.base.settings import Settings
from editor.play.mode import Mode
from editor.session import Session
from editor.window.play_image import PlayImage
from editor.worker.jobs import Worker
from editor.worker.requests import Advance, Image, RenderState, StartEpisode
from editor.worker.snapshots import Snapshot, Trace
from kinetix.level.model import Body, Circle, Level

LEVEL = Level(name="Ball", bodies=(Body(id=1, shape=Circle(radius=0.3), position=(2.5, 2.5)),))


class Simulation:
    """Stands in for the worker's side: one still ball, grey pictures."""

    def __init__(self) -> None:
        self.drawn: list[RenderState] = []
        self.step = 0

    def snapshot(self) -> Snapshot:
        return Snapshot(
            step=self.step,
            position=np.array([[2.5, 2.5]]),
            angle=np.zeros(1),
            velocity=np.zeros((1, 2)),
            angular_velocity=np.zeros(1),
            motor=np.zeros(0),
            thruster=np.zeros(0),
            state="opaque",
        )

    def perform(self, request, progress):
        del progress
        match request:
            case RenderState(size=(width, height)):
                self.drawn.append(request)
                pixels = np.full((height, width, 3), 128, np.uint8)
                return Image(pixels=pixels, centre=request.centre, scale=request.scale)
            case StartEpisode():
                self.step = 0
                return self.snapshot()
            case Advance(actions=actions):
                snapshots = []
                for _ in actions:
                    self.step += 1
                    snapshots.append(self.snapshot())
                return tuple(snapshots)


def showing(simulation: Simulation) -> Session:
    return Session(
        settings=Settings(renderer_picture=True),
        worker=Worker(perform=simulation.perform),
        level=LEVEL,
    )


def settle(gui) -> None:
    gui.session.worker.wait(5.0)
    gui.frames(2)


def test_prepares_in_edit_and_shows_what_is_recent(make_gui):
    simulation = Simulation()
    session = showing(simulation)
    gui = make_gui(session=session)
    images = gui.host.ui.workplace.canvas.images
    assert isinstance(images, PlayImage) and not images.enabled
    gui.frames(3)
    assert not simulation.drawn, "nothing may be asked of the worker before Play is prepared"
    images.enabled = True
    gui.frames(2)
    settle(gui)
    assert [request.state for request in simulation.drawn] == [None]
    assert images.picture(session) is None, "Edit shows vectors"
    gui.key("space")
    # Pictures are drawn beside the steps: one that comes late is not shown, the next one may be.
    for _ in range(200):
        settle(gui)
        if images.picture(session) is not None and session.playback.step_count > 1:
            break
    assert session.mode is Mode.PLAYING and session.action == NOOP
    assert session.playback.step_count > 1
    assert simulation.drawn[-1].state == "opaque"
    picture = images.picture(session)
    assert picture is not None and picture.pixels.shape[2] == 3
    gui.key("escape")
    gui.frames(2)
    assert images.picture(session) is None


def test_a_picture_of_another_episode_is_not_shown(make_gui):
    simulation = Simulation()
    session = showing(simulation)
    gui = make_gui(session=session)
    images = gui.host.ui.workplace.canvas.images
    images.enabled = True
    gui.frames(2)
    for _ in range(2):
        moments = (simulation.snapshot(), simulation.snapshot())
        trace = Trace(physics="balanced", perturbed=False, snapshots=moments, actions=(NOOP,))
        session.playback.replay(trace, LEVEL)
        assert images.picture(session) is None
        for _ in range(200):  # the drawing is prepared first, then asked for
            settle(gui)
            if images.picture(session) is not None:
                break
        assert images.picture(session) is not None
