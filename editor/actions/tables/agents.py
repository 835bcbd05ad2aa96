"""The rows of the action table that belong to agents: watch, compare, look back, measure."""

from typing import Final

from editor.actions import agents, datasets, export, look_back, measure, train, view, watch
from editor.actions.base import Action, Context, playing
from editor.agents.viewer import Compare

PLAY: Final = Context.PLAY

_COMPARISONS: Final[tuple[tuple[Compare, str, str], ...]] = (
    ("off", "Compare: Off", ""),
    ("ghost", "Compare: Ghost", "Agent B plays the same level and seed, half transparent."),
    ("side", "Compare: Side by Side", "Agent B plays the same level and seed beside A."),
)

AGENTS: Final = (
    Action(
        id="run.play_agent",
        label="Let the Agent Play",
        menu="Agent",
        keys=("f6",),
        tooltip="Agent A plays the level as it was trained; where none fits, the planner plays.",
        run=agents.play_agent,
    ),
    Action(
        id="agent.choose_a",
        label="Choose Agent A…",
        menu="Agent",
        tooltip="Ours, a training run, or one of kinetix-env; dropping its folder works too.",
        run=agents.choose("a"),
    ),
    Action(
        id="agent.choose_b",
        label="Choose Agent B…",
        menu="Agent",
        tooltip="To compare with.",
        run=agents.choose("b"),
    ),
    Action(
        id="agent.take_over",
        label="Take Over",
        menu="Agent",
        keys=("t",),
        context=PLAY,
        tooltip="Drive instead of the agent; again: hand back. Any play key takes over while held.",
        enabled=agents.agent_playing,
        refusal="Let an agent play first (F6).",
        checked=lambda session: session.viewer.by_hand,
        run=agents.take_over,
    ),
    Action(
        id="agent.next_attempt",
        label="Next Attempt",
        menu="Agent",
        keys=("n",),
        context=PLAY,
        tooltip="The same level with other draws.",
        enabled=agents.agent_playing,
        refusal="Let an agent play first (F6).",
        run=agents.change_attempt(1),
    ),
    Action(
        id="agent.previous_attempt",
        label="Previous Attempt",
        menu="Agent",
        keys=("b",),
        context=PLAY,
        enabled=lambda session: agents.agent_playing(session) and session.viewer.attempt > 0,
        refusal="This is an agent's first attempt, or no agent plays.",
        run=agents.change_attempt(-1),
    ),
    Action(
        id="agent.deterministic",
        label="Likeliest Actions",
        menu="Agent",
        tooltip="Take the likeliest action instead of drawing one.",
        checked=lambda session: session.viewer.deterministic,
        run=agents.switch_deterministic,
    ),
    *(
        Action(
            id=f"agent.compare_{kind}",
            label=label,
            menu="Agent",
            tooltip=tooltip,
            checked=lambda session, kind=kind: session.viewer.compare == kind,
            run=agents.compare(kind),
        )
        for kind, label, tooltip in _COMPARISONS
    ),
    Action(
        id="run.start_here",
        label="Start Here",
        menu="Run",
        keys=("return",),
        context=PLAY,
        tooltip="Play on from the moment that the timeline shows.",
        enabled=look_back.can_start_here,
        refusal="Go to a moment of a replay first.",
        run=look_back.start_here,
    ),
    Action(
        id="run.loop_from",
        label="Loop from Here",
        menu="Run",
        keys=("i",),
        context=PLAY,
        enabled=playing,
        run=look_back.loop_from,
    ),
    Action(
        id="run.loop_to",
        label="Loop to Here",
        menu="Run",
        keys=("o",),
        context=PLAY,
        enabled=playing,
        run=look_back.loop_to,
    ),
    Action(
        id="run.loop_clear",
        label="No Loop",
        menu="Run",
        context=PLAY,
        enabled=lambda session: session.playback.loop is not None,
        refusal="No part of the replay is looped.",
        run=look_back.clear_loop,
    ),
    Action(
        id="file.export_clip",
        label="Export Clip…",
        menu="Run",
        context=PLAY,
        tooltip="The looped part of the episode, or all of it, as GIF or MP4.",
        enabled=export.has_clip,
        refusal="Play the level first.",
        run=export.ask_clip,
    ),
    Action(
        id="file.share",
        label="Share Episode…",
        menu="Run",
        context=PLAY,
        tooltip="The looped part of the episode, or all of it, as one page that any browser plays.",
        enabled=export.has_clip,
        refusal="Play the level first.",
        run=export.ask_page,
    ),
    Action(
        id="file.add_to_dataset",
        label="Add to a Data Set…",
        menu="Run",
        context=PLAY,
        tooltip="The whole episode, for kinetix train bc.",
        enabled=datasets.can_add,
        refusal="Play an episode to its end first.",
        run=datasets.ask_dataset,
    ),
    Action(
        id="level.evaluate",
        label="Evaluate…",
        menu="Agent",
        keys=("ctrl+shift+e",),
        tooltip="How often agents solve levels, as kinetix eval measures it.",
        run=measure.evaluate,
    ),
    Action(
        id="agent.cancel_evaluation",
        label="Cancel the Evaluation",
        menu="Agent",
        enabled=lambda session: session.viewer.evaluation.running,
        refusal="No evaluation is running.",
        run=lambda session: session.viewer.evaluation.cancel(),
    ),
    Action(
        id="agent.train_here",
        label="Train on This Level",
        menu="Agent",
        tooltip="Learns the level in the background, from its solution or a win that is found.",
        enabled=lambda session: not session.training.running,
        refusal="An agent is being trained already: stop it in the Training panel.",
        run=train.train_here,
    ),
    Action(
        id="agent.stop_training",
        label="Stop Training",
        menu="Agent",
        tooltip="What was learnt is kept, and can go on.",
        enabled=lambda session: session.training.running,
        refusal="Nothing is being trained.",
        run=train.stop_training,
    ),
    Action(
        id="agent.watch_run",
        label="Watch a Training Run…",
        menu="Agent",
        tooltip="Its metrics live, its newest agent on the level in front.",
        run=watch.ask_run,
    ),
    *(
        Action(
            id=f"view.{name}",
            label=label,
            menu="View",
            keys=keys,
            tooltip=tooltip,
            run=view.bring(name),
        )
        for name, label, keys, tooltip in (
            ("agents", "Agents", ("f7",), "Choose agents, their draws and what is shown of them."),
            ("timeline", "Timeline", ("f8",), "Look back: scrub, loop, start from any moment."),
            ("eye", "What the Agent Sees", (), "The picture and the numbers of its observation."),
            ("training", "Training", (), "Metrics of a training run while it trains."),
            ("curriculum", "Curriculum", (), "The levels that SFL, PLR or ACCEL keep, over time."),
        )
    ),
)
