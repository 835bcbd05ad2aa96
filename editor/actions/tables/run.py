"""Rows of the Run menu."""

from typing import Final

from editor.actions import physics, play
from editor.actions.base import Action, Context, editing, playing
from editor.play.playback import SPEEDS, Mode

EDIT, PLAY = Context.EDIT, Context.PLAY

RUN: Final = (
    Action(
        id="run.play_human",
        label="Play",
        menu="Run",
        keys=("space", "f5"),
        context=EDIT,
        tooltip="Arrows, W/S, A/D turn motors, 1 and 2 fire thrusters.",
        enabled=editing,
        run=play.play,
    ),
    Action(
        id="run.pause",
        label="Pause",
        menu="Run",
        keys=("space",),
        context=PLAY,
        enabled=playing,
        checked=lambda session: session.mode is Mode.PAUSED,
        run=play.pause,
    ),
    Action(
        id="run.step",
        label="Step",
        menu="Run",
        keys=(".",),
        context=PLAY,
        tooltip="One environment step: two engine steps, 1/30 s.",
        enabled=playing,
        run=play.step,
    ),
    Action(
        id="run.step_back",
        label="Step Back",
        menu="Run",
        keys=(",",),
        context=PLAY,
        enabled=playing,
        run=play.step_back,
    ),
    Action(
        id="run.slower",
        label="Slower",
        menu="Run",
        keys=("-",),
        context=PLAY,
        enabled=lambda session: session.playback.speed > SPEEDS[0],
        refusal="It plays as slowly as it can already.",
        run=play.slower,
    ),
    Action(
        id="run.faster",
        label="Faster",
        menu="Run",
        keys=("=",),
        context=PLAY,
        enabled=lambda session: session.playback.speed < SPEEDS[-1],
        refusal="It plays as fast as it can already.",
        run=play.faster,
    ),
    Action(
        id="run.reset",
        label="Reset",
        menu="Run",
        keys=("backspace",),
        context=PLAY,
        enabled=playing,
        run=play.reset,
    ),
    Action(
        id="run.stop",
        label="Stop",
        menu="Run",
        keys=("escape",),
        context=PLAY,
        tooltip="Back to editing; the level is as it was.",
        enabled=playing,
        run=play.stop,
    ),
    Action(
        id="run.compare_physics",
        label="Compare Physics…",
        menu="Run",
        context=Context.LEVEL,
        tooltip="The same level and the same keys under two presets or solvers, side by side.",
        checked=physics.comparing,
        run=physics.ask_other,
    ),
    Action(
        id="run.edit_from_here",
        label="Edit from Here",
        menu="Run",
        context=PLAY,
        tooltip="A new level that starts with everything where it is now.",
        enabled=play.has_state,
        refusal="Play the level first.",
        run=play.edit_from_here,
    ),
)
