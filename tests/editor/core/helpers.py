"""A session without a window: synthetic pointer and keys, a simulator that needs no physics."""

import dataclasses
import math

import numpy as np

from editor import actions
from editor.base.events import (
    LEFT,
    NO_MODIFIERS,
    KeyEvent,
    Modifiers,
    Pointer,
    PointerEvent,
    TextEvent,
)
from editor.base.settings import Settings
from editor.session import Session
from editor.worker.snapshots import Snapshot
from kinetix.errors import KinetixError
from kinetix.level.geometry import referenced_body, to_world
from kinetix.level.model import Body, Circle, Joint, Level, Motor, Polygon, Thruster

SQUARE = Polygon(vertices=((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2)))


def a_level():
    """A box on an axle with a wheel, a thruster on the box, a green and a blue circle."""
    return Level(
        name="Test",
        bodies=(
            Body(id=1, shape=SQUARE, position=(2.0, 2.0)),
            Body(id=2, shape=Circle(radius=0.15), position=(2.2, 2.0)),
            Body(id=3, shape=Circle(radius=0.2), position=(4.0, 3.0), role="green"),
            Body(id=4, shape=Circle(radius=0.2), position=(1.0, 4.0), role="blue", fixed=True),
        ),
        joints=(
            Joint(
                id=5,
                kind="revolute",
                a=1,
                b=2,
                anchor_a=(0.2, 0.0),
                anchor_b=(0.0, 0.0),
                motor=Motor(speed=2.0),
            ),
        ),
        thrusters=(Thruster(id=6, body=1, position=(-0.15, 0.1), angle=0.5, power=0.7),),
    )


def gap(level, joint):
    """Distance of a joint's two anchors in the world."""
    a, b = referenced_body(level, joint.a), referenced_body(level, joint.b)
    return math.dist(to_world(a, joint.anchor_a), to_world(b, joint.anchor_b))


class FakeSimulator:
    """Bodies drift by what is driven; answers come at once, or when `release` lets them."""

    def __init__(self):
        self.level = None
        self.state = None
        self.waiting = []
        self.delayed = False
        self.ends_at = 256
        self.ends = "timeout"
        self.error = ""
        self.agent_action = (2, 0, 0, 0, 0, 0)
        self.outstanding = 0
        self.keep_contacts = False

    def start(self, level, physics, casting=None, since=None):
        self.level, self.physics, self.casting = level, physics, casting
        count = len(level.bodies)
        position = np.array([body.position for body in level.bodies], np.float32).reshape(count, 2)
        self.state = Snapshot(
            step=0 if since is None else since.step,
            total_reward=0.0 if since is None else since.total_reward,
            position=position,
            angle=np.zeros(count, np.float32),
            velocity=np.zeros((count, 2), np.float32),
            angular_velocity=np.zeros(count, np.float32),
            motor=np.zeros(len(level.joints), np.float32),
            thruster=np.zeros(len(level.thrusters), np.float32),
        )
        self.waiting = [self.state]
        self.outstanding = 0

    def advance(self, actions, pull=None):
        for asked in actions:
            if self.state.outcome is not None:
                break
            step = self.state.step + 1
            action = self.agent_action if asked is None else asked
            drift = np.array([0.01 * action[0], -0.003 * step], np.float32)
            self.state = dataclasses.replace(
                self.state,
                step=step,
                position=self.state.position + drift,
                action=(float(action[0] == 1) - float(action[0] == 2), 0.0, 0.0, 0.0, 0.0, 0.0),
                outcome=self.ends if step >= self.ends_at else None,
            )
            self.waiting.append(self.state)
            self.outstanding += self.delayed

    def restore(self, snapshot):
        self.state = snapshot

    def stop(self):
        self.waiting, self.outstanding = [], 0

    def drop(self):
        self.waiting, self.outstanding = [], 0

    def take(self):
        if self.error:
            error, self.error = self.error, ""
            raise KinetixError(error)
        if self.delayed:
            return []
        waiting, self.waiting = self.waiting, []
        self.outstanding = 0
        return waiting


class Hand:
    """Does what a person does, in level metres."""

    def __init__(self, session):
        self.session = session

    def _event(self, kind, at, button=LEFT, mods=NO_MODIFIERS):
        screen = self.session.camera.to_screen(at)
        world = self.session.camera.to_world(screen)
        actions.handle(
            self.session,
            PointerEvent(
                kind=kind,
                world=world,
                screen=screen,
                button=button,
                modifiers=mods,
                time=self.session.time,
            ),
        )

    def move(self, at, **mods):
        self._event(Pointer.MOVE, at, 0, Modifiers(**mods))

    def press(self, at, button=LEFT, **mods):
        self._event(Pointer.PRESS, at, button, Modifiers(**mods))

    def hold(self, at, button=LEFT, **mods):
        """A move with the button down."""
        self._event(Pointer.MOVE, at, button, Modifiers(**mods))

    def release(self, at, button=LEFT, **mods):
        self._event(Pointer.RELEASE, at, button, Modifiers(**mods))

    def click(self, at, button=LEFT, **mods):
        self.press(at, button, **mods)
        self.release(at, button, **mods)

    def drag(self, start, end, button=LEFT, **mods):
        self.press(start, button, **mods)
        for share in (0.1, 0.5, 0.9, 1.0):
            at = tuple(a + share * (b - a) for a, b in zip(start, end, strict=True))
            self.hold(at, button, **mods)
        self.release(end, button, **mods)

    def key(self, key, **mods):
        modifiers = Modifiers(**mods)
        actions.handle(self.session, KeyEvent(key=key, pressed=True, modifiers=modifiers))
        actions.handle(self.session, KeyEvent(key=key, pressed=False, modifiers=modifiers))

    def down(self, key):
        actions.handle(self.session, KeyEvent(key=key, pressed=True))

    def up(self, key):
        actions.handle(self.session, KeyEvent(key=key, pressed=False))

    def type(self, text):
        actions.handle(self.session, TextEvent(text=text))

    def wait(self, seconds=1 / 60):
        actions.update(self.session, seconds)


def a_session(level=None, **settings):
    """A session with snapping off, unless a test wants it, and a fake simulator."""
    chosen = {"snap_smart": False, "snap_grid": False} | settings
    return Session(
        settings=Settings(**chosen),
        simulator=FakeSimulator(),
        level=a_level() if level is None else level,
    )


def pause_episode(session, hand):
    """Play the level for some frames, and pause."""
    assert actions.run(session, "run.play_human")
    for _ in range(20):
        hand.wait()
    assert actions.run(session, "run.pause")
    hand.wait()


def texts(session):
    return [toast.text for toast in session.toasts]


class Unheard:
    """Progress that nobody follows."""

    def report(self, fraction, message):
        """Nothing happens."""
