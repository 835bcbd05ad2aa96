"""The history of a run's level buffer, read from its folder."""

from pathlib import Path

from editor.worker.requests import CurriculumNews, ReadCurriculum
from kinetix.training.curricula.pages import page_updates, read_page


def read_curriculum(request: ReadCurriculum) -> CurriculumNews:
    """Read a page of the history; see `ReadCurriculum`.

    Raises:
        KinetixError: The page is damaged; one sentence.
    """
    run = Path(request.path)
    updates = tuple(page_updates(run))
    wanted = request.update if request.update is not None else (updates or (None,))[-1]
    if wanted is None or wanted == request.known or wanted not in updates:
        return CurriculumNews(updates=updates, page=None)
    return CurriculumNews(updates=updates, page=read_page(run, wanted))
