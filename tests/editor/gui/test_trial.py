"""Trying a level out: what happens without a plan, which size and agents it fits."""

from editor.actions.watching.compatible import compatible_agents
from editor.agents.random_play import Trial, fitting
from editor.base.settings import Settings
from editor.session import Session
from editor.worker.jobs import Worker
from editor.worker.requests import CheckDynamics, DynamicsReport
from kinetix.errors import KinetixError
from kinetix.level.model import Level
from tests.editor.core.helpers import a_level
from tests.editor.days import refuse


def test_a_level_is_tried_out_and_its_findings_go_with_a_change(make_gui):
    report = DynamicsReport(noop_outcome="lost", noop_steps=40, random_solved=0.125, attempts=64)
    evaluator = Worker(perform=lambda request, progress: report)
    worker = Worker(perform=refuse)
    session = Session(settings=Settings(), worker=worker, evaluator=evaluator, level=a_level())
    gui = make_gui(session=session)
    gui.bring("problems")
    assert gui.shows("problems.I303")
    assert not gui.shows("problems.I301")
    gui.click("problems.try_out")
    evaluator.wait(5)
    gui.frames(3)
    assert [issue.message for issue in session.trial.findings(gui.level)] == [
        "A no-op agent loses in 40 steps.",
        "A random agent solves 12% of 64.",
    ]
    assert gui.shows("problems.I301")
    assert gui.shows("problems.I302")
    gui.key("ctrl+a")
    gui.key("right")
    assert not gui.shows("problems.I301")
    gui.key("ctrl+z")
    assert gui.shows("problems.I301")
    evaluator.stop()


def test_the_agents_that_fit_are_named(make_gui):
    gui = make_gui(level=a_level())
    named = compatible_agents(gui.session, gui.level)
    assert "Goalkeeper" not in named  # it knows size s alone, and this level has a circle more
    small = Level(name="small", bodies=gui.level.bodies[2:])
    assert "Goalkeeper" in compatible_agents(gui.session, small)
    assert "size s" in fitting(small, ("Goalkeeper",)).message


def test_a_level_that_cannot_be_played_says_why():
    def fail(request: CheckDynamics, progress: object) -> None:
        raise KinetixError(f"{request.level.name} does not fit.")

    worker = Worker(perform=fail)
    trial = Trial(worker)
    trial.start(a_level(), "balanced")
    assert trial.running
    worker.wait(5)
    worker.poll()
    assert trial.error == "Test does not fit."
    assert not trial.running
    assert trial.findings(a_level()) == ()
    worker.stop()
