"""An evaluation as the window sees it: what is asked for, how far it is, the table."""

import csv
import dataclasses
import io
import json
from collections.abc import Callable, Sequence
from typing import Any, Final, Literal, TypeAlias

from editor.worker.jobs import Job, JobState, Worker
from editor.worker.requests import (
    BUILT_IN,
    AgentRef,
    AgentSummary,
    Evaluate,
    EvaluatedLevel,
    Score,
    Standing,
)
from kinetix.agents.card import EnvironmentCard
from kinetix.agents.compare import Contender, Difference, labels_of, leaderboard, paired
from kinetix.agents.comparison_files import text_of
from kinetix.agents.results import LevelFailure, LevelResult, Provenance, report
from kinetix.version import __version__

Column: TypeAlias = Literal["level", "solve_rate", "mean_return", "mean_length"]
COLUMNS: Final[tuple[Column, ...]] = ("level", "solve_rate", "mean_return", "mean_length")


@dataclasses.dataclass(frozen=True, kw_only=True)
class Plan:
    """Agents, levels and settings of an evaluation."""

    agents: tuple[AgentSummary, ...]
    levels: tuple[EvaluatedLevel, ...]
    hashes: tuple[str, ...]
    """`level_hash` of each level, for the records."""
    attempts: int = 20
    seed: int = 0
    physics: str = ""
    """Empty: each agent's own."""
    deterministic: bool = False
    sources: tuple[Provenance, ...] = ()
    """Of a stored comparison: what each agent's results depend on."""

    def physics_of(self, agent: int) -> str:
        """Return the physics under which an agent is measured."""
        if self.sources:
            return self.sources[agent].physics
        return self.physics or self.agents[agent].physics

    def provenance(self, agent: int) -> Provenance:
        """Return what an agent's results depend on, levels aside."""
        if self.sources:
            return self.sources[agent]
        who = self.agents[agent]
        return Provenance(
            agent=who.name,
            digest=who.digest,
            physics=self.physics_of(agent),
            seed=self.seed,
            attempts=self.attempts,
            deterministic=self.deterministic,
            frame_skip=who.frame_skip,
            dense_reward_scale=who.dense_reward_scale,
            card_digest=who.card_digest,
        )


@dataclasses.dataclass(frozen=True, kw_only=True)
class Row:
    """One level of the table: a result per agent, None before it is measured."""

    level: int
    """Index into the plan's levels."""
    name: str
    results: tuple[LevelResult | None, ...]
    errors: tuple[str, ...]
    """Reasons why an agent could not play it; empty where it could, or where nothing is known
    yet."""


def bare_summary(name: str, provenance: Provenance | None = None) -> AgentSummary:
    """Return the summary of an agent that is not loaded: scripted, or of a stored comparison.

    Args:
        name: Of a scripted player, or the name in the comparison.
        provenance: Of an agent of a stored comparison, whose folder is not known.
    """
    usual = EnvironmentCard()
    scripted = AgentSummary(
        ref=AgentRef(path=name if name in BUILT_IN else ""),
        name=name,
        description="",
        observation="blind",
        action="multi_discrete",
        network="no network",
        parameters=0,
        recurrent=False,
        capacity=None,
        any_size=True,
        physics=usual.physics,
        frame_skip=usual.frame_skip,
        steps=None,
        training="",
        folder="",
        dense_reward_scale=usual.dense_reward_scale,
    )
    if provenance is None:
        return scripted
    return dataclasses.replace(
        scripted,
        physics=provenance.physics,
        frame_skip=provenance.frame_skip or usual.frame_skip,
        digest=provenance.digest,
        dense_reward_scale=provenance.dense_reward_scale,
        card_digest=provenance.card_digest,
    )


class Evaluation:
    """The last evaluation; it goes on whether or not its panel is on the screen."""

    def __init__(self, worker: Worker) -> None:
        self._worker = worker
        self.plan: Plan | None = None
        self.job: Job | None = None
        self.standing: Standing | None = None
        self.error = ""
        self.cancelled = False
        self._of: tuple[Plan | None, Standing | None] = (None, None)
        """The plan and the standing that `_computed` is about."""
        self._computed: dict[str, Any] = {}
        self.ended: list[tuple[Plan, Standing]] = []
        """Evaluations that are over or cancelled, until the gallery has kept their results."""

    @property
    def running(self) -> bool:
        """True if it is under way; a cancelled one is not, even if its thread still is."""
        return self.job is not None and not self.job.finished and not self.cancelled

    @property
    def stage(self) -> str:
        """The current stage, as the progress bar shows it."""
        if self.job is not None and self.job.message:
            return self.job.message
        before = next(iter(self._worker.jobs), None)
        if before is not None and before is not self.job and before.cancelled:
            return "Waiting: what was cancelled compiles to its end …"
        return "Starting …"

    @property
    def complete(self) -> bool:
        """True if every episode was played."""
        return self.job is not None and self.job.state is JobState.DONE

    def start(self, plan: Plan) -> None:
        """Begin; one that is under way is cancelled."""
        self.cancel()
        self.plan, self.standing, self.error, self.cancelled = plan, None, "", False
        request = Evaluate(
            agents=tuple(agent.ref for agent in plan.agents),
            levels=plan.levels,
            attempts=plan.attempts,
            seed=plan.seed,
            physics=plan.physics,
            deterministic=plan.deterministic,
        )
        self.job = self._worker.submit(request, title="Evaluating", done=self._done)

    def restore(self, plan: Plan, contenders: Sequence[Contender]) -> None:
        """Show a comparison that was stored; one that is under way is cancelled.

        Args:
            plan: Its agents and levels.
            contenders: What is known of each agent, in the plan's order.
        """
        self.cancel()
        self.plan, self.error, self.cancelled, self.job = plan, "", False, None
        scores, failures = [], []
        for agent, contender in enumerate(contenders):
            for one in contender.results:
                if isinstance(one, LevelResult):
                    scores.append(Score(agent=agent, result=one))
                else:
                    failures.append((agent, one))
        episodes = sum(score.result.attempts for score in scores)
        self.standing = Standing(
            done=episodes, total=episodes, scores=tuple(scores), failures=tuple(failures)
        )

    def cancel(self) -> None:
        """Stop; what is known so far stays in the table."""
        if self.running and self.job is not None:
            self.tick()
            self.job.cancel()
            self.cancelled = True
            self._end()

    def tick(self) -> None:
        """Take what the worker knows so far; call it once a frame."""
        if self.running and self.job is not None and self.job.partial is not None:
            self.standing = self.job.partial

    def _done(self, job: Job) -> None:
        if job is not self.job:
            return
        if job.state is JobState.DONE:
            self.standing = job.result
            self._end()
        elif job.state is JobState.FAILED:
            self.standing, self.error = job.partial or self.standing, job.error
            self._end()

    def _end(self) -> None:
        """Hand on what is known; a level has a result only when all of its attempts are over."""
        if self.plan is not None and self.standing is not None:
            self.ended.append((self.plan, self.standing))

    def rows(
        self,
        *,
        sort: Column = "level",
        agent: int = 0,
        descending: bool = False,
        wanted: str = "",
    ) -> list[Row]:
        """Return the rows of the table.

        Args:
            sort: By what; results that are not there yet come last.
            agent: Whose results are sorted by.
            descending: The largest first.
            wanted: Only levels whose name contains this.
        """
        name = f"rows {sort} {agent} {descending} {wanted}"
        return self._once(name, lambda: self._rows(sort, agent, descending, wanted))

    def _rows(self, sort: Column, agent: int, descending: bool, wanted: str) -> list[Row]:
        if self.plan is None:
            return []
        known = self._known()
        failed = {
            (agent, failure.level): failure.error
            for agent, failure in (self.standing.failures if self.standing else ())
        }
        agents = range(len(self.plan.agents))
        rows = [
            Row(
                level=index,
                name=level.name,
                results=tuple(known.get((k, level.name)) for k in agents),
                errors=tuple(failed.get((k, level.name), "") for k in agents),
            )
            for index, level in enumerate(self.plan.levels)
            if wanted.lower() in level.name.lower()
        ]
        if sort == "level":
            return sorted(rows, key=lambda row: row.name, reverse=descending)
        with_result = [row for row in rows if row.results[agent] is not None]
        without = [row for row in rows if row.results[agent] is None]
        key = sort
        with_result.sort(key=lambda row: getattr(row.results[agent], key), reverse=descending)
        return with_result + without

    def lines(self, agent: int) -> list[dict[str, Any]]:
        """Return the lines of `kinetix eval --json`; the summary once all levels are done."""
        if self.plan is None or self.standing is None:
            return []
        told = self._told(agent)
        lines = report(told, self.plan.provenance(agent))
        return lines if len(told) == len(self.plan.levels) else lines[:-1]

    def _told(self, agent: int) -> list[LevelResult | LevelFailure]:
        """Return the results of an agent, in the order of the levels."""
        assert self.plan is not None and self.standing is not None
        known: dict[str, LevelResult | LevelFailure] = {
            failure.level: failure for k, failure in self.standing.failures if k == agent
        }
        known |= {result.level: result for result in self.results(agent)}
        return [known[level.name] for level in self.plan.levels if level.name in known]

    def _once(self, name: str, compute: Callable[[], Any]) -> Any:
        """Return what was computed for this plan and standing; a frame must not do it again."""
        if self._of[0] is not self.plan or self._of[1] is not self.standing:
            self._of, self._computed = (self.plan, self.standing), {}
        if name not in self._computed:
            self._computed[name] = compute()
        return self._computed[name]

    def differences(self) -> tuple[str, tuple[Difference, ...]]:
        """Return the label of the best agent, and how far it is ahead of each other one."""
        return self._once("differences", self._differences)

    def _differences(self) -> tuple[str, tuple[Difference, ...]]:
        contenders = self.contenders()
        first, *others = leaderboard(contenders)
        by_label = {contender.label: contender for contender in contenders}
        pairs = (paired(by_label[first["label"]], by_label[row["label"]]) for row in others)
        return first["label"], tuple(pairs)

    def summary(self, agent: int) -> dict[str, Any] | None:
        """The summary that `kinetix eval` prints last, once all levels of an agent are done."""
        return self._once(f"summary {agent}", lambda: self._summary(agent))

    def _summary(self, agent: int) -> dict[str, Any] | None:
        lines = self.lines(agent)
        return lines[-1] if lines and "mean_solve_rate" in lines[-1] else None

    def results(self, agent: int) -> list[LevelResult]:
        """Return an agent's results in the order in which the levels were asked for."""
        if self.plan is None or self.standing is None:
            return []
        found = (self.result(agent, level.name) for level in self.plan.levels)
        return [result for result in found if result is not None]

    def result(self, agent: int, level: str) -> LevelResult | None:
        """Return what an agent reached in a level; None as long as that is not known."""
        return self._known().get((agent, level))

    def _known(self) -> dict[tuple[int, str], LevelResult]:
        """Return all results by agent and level."""
        scores = self.standing.scores if self.standing else ()
        return self._once("known", lambda: {(s.agent, s.result.level): s.result for s in scores})

    def contenders(self) -> list[Contender]:
        """Return the agents of which all levels are done, with what is known of each."""
        if self.plan is None or self.standing is None:
            return []
        labels = labels_of([self.plan.provenance(k) for k in range(len(self.plan.agents))])
        found = []
        for agent, label in enumerate(labels):
            results = self._told(agent)
            if len(results) == len(self.plan.levels):
                whence = self.plan.provenance(agent)
                found.append(Contender(label=label, provenance=whence, results=tuple(results)))
        return found

    def comparison_text(self, suffix: str) -> str:
        """Return the comparison as `kinetix compare --out` writes it.

        Args:
            suffix: `.json` or `.html`.
        """
        assert self.plan is not None
        names = (level.name for level in self.plan.levels)
        hashes = dict(zip(names, self.plan.hashes, strict=True))
        return text_of(suffix, self.contenders(), hashes, __version__)

    def json_lines(self) -> str:
        """Return the lines that `kinetix eval --json` prints, an agent after the other."""
        if self.plan is None:
            return ""
        lines = [line for k in range(len(self.plan.agents)) for line in self.lines(k)]
        return "".join(json.dumps(line) + "\n" for line in lines)

    def csv_text(self) -> str:
        """Return a line per agent and level: the result, why attempts failed, its provenance."""
        if self.plan is None:
            return ""
        rows: list[dict[str, Any]] = []
        names = (level.name for level in self.plan.levels)
        hashes = dict(zip(names, self.plan.hashes, strict=True))
        for agent in range(len(self.plan.agents)):
            whence = self.plan.provenance(agent).as_dict()
            failures = {result.level: result.failures for result in self.results(agent)}
            rows += [
                {"agent": whence["agent"]}
                | line
                | {"failures": failures.get(line["level"], "")}
                | {"level_hash": hashes[line["level"]]}
                | whence
                for line in self.lines(agent)
                if "level" in line
            ]
        heads = list(dict.fromkeys(name for row in rows for name in row))
        out = io.StringIO()
        writer = csv.DictWriter(out, heads, lineterminator="\n")
        if rows:
            writer.writeheader()
            writer.writerows(rows)
        return out.getvalue()


def best(results: Sequence[LevelResult | None]) -> int | None:
    """Return the result whose interval lies above those of all others, or None.

    Where intervals overlap, or a result is missing, nothing can be said.
    """
    known = [result.bounds for result in results if result is not None]
    if len(known) != len(results) or not known:
        return None
    low, top = max((bounds[0], k) for k, bounds in enumerate(known))
    others = [bounds[1] for k, bounds in enumerate(known) if k != top]
    return top if all(high < low for high in others) else None
