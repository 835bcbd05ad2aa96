"""Episodes of the window as data."""

from editor.worker.requests import AddEpisode, Progress
from kinetix.datasets.folder import add_episodes, read_manifest
from kinetix.datasets.replays import checked
from kinetix.datasets.traces import episode_of_arrays
from kinetix.errors import KinetixError
from kinetix.wording import plural


def add_episode(request: AddEpisode, progress: Progress) -> str:
    """Play an episode again and add it to its data set.

    Returns:
        A sentence: what the data set holds now.

    Raises:
        KinetixError: The controls do not reproduce the episode, or the folder or a data set cannot
            take it.
    """
    progress.report(None, "Playing the episode again")
    trace, level = request.trace, request.level
    episode = checked(episode_of_arrays(trace.arrays(), level, f"The episode of {level.name!r}"))
    if not episode.replays:
        raise KinetixError(
            "This episode cannot be reproduced from its controls: a body was pulled at, or it was "
            "played in a step that rounds differently."
        )
    told = add_episodes(request.folder, [episode])
    if told.unfit:
        raise KinetixError(told.unfit[0])
    manifest = read_manifest(request.folder)
    many = plural(manifest.episodes, "episode")
    holds = f"{request.folder} holds {many}, {plural(manifest.steps, 'step')}."
    return f"Added. {holds}" if told.added else f"It is there already. {holds}"
